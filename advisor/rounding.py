"""Two numbers as text, with enough digits that unequal numbers read as unequal."""

from typing import Literal

MOST_DIGITS = 9
"""Numbers that agree to as many digits read as equal."""


def distinct_texts(
    value: float, limit: float, digits: int = 0, style: Literal["f", "g"] = "f"
) -> tuple[str, str]:
    """Write a number and its limit with ``digits`` digits, and with more where both would read alike.

    "1.9 s (at least 1.9)" contradicts itself; "1.86 s (at least 1.90)" does not.

    Parameters
    ----------
    value, limit
        Two numbers of one unit.
    digits
        Fewest decimals (``f``) or significant digits (``g``).

    Returns
    -------
    tuple of str
        Value and limit with as many digits each; one text twice only where both agree to `MOST_DIGITS`.
    """
    for more in (*range(digits, MOST_DIGITS), digits):
        texts = f"{value:.{more}{style}}", f"{limit:.{more}{style}}"
        if texts[0] != texts[1]:
            break
    return texts
