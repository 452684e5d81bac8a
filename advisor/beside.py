"""A number beside its limit, in words: with so many digits that the two differ where they do."""

from typing import Literal

MOST_DIGITS = 9


def beside(value: float, limit: float, digits: int = 0, style: Literal["f", "g"] = "f") -> tuple[str, str]:
    """Both numbers as text, from ``digits`` on with as many as it takes to tell them apart.

    "1.9 s (at least 1.9)" would contradict itself; "1.86 s (at least 1.90)" does not.

    Parameters
    ----------
    digits
        Fewest decimals (``f``) or significant digits (``g``).

    Returns
    -------
    tuple of str
        Value and limit with the same number of digits; the same text only if they are equal to `MOST_DIGITS`.
    """
    for more in (*range(digits, MOST_DIGITS), digits):
        texts = f"{value:.{more}{style}}", f"{limit:.{more}{style}}"
        if texts[0] != texts[1]:
            break
    return texts
