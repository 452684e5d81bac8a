"""Two numbers as text, with enough digits that unequal numbers read as unequal."""

from typing import Literal

MOST_DIGITS = 9
"""Most decimals or significant digits of a text. Numbers that agree to so many digits read as equal."""


def distinct_texts(
    value: float, limit: float, digits: int = 0, style: Literal["f", "g"] = "f"
) -> tuple[str, str]:
    """Write a number and its limit with ``digits`` digits, and with more digits where both texts would be
    equal.

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
        Value and limit with equal numbers of digits. Texts are equal only where both agree to `MOST_DIGITS`.
    """
    for more in (*range(digits, MOST_DIGITS), digits):
        texts = f"{value:.{more}{style}}", f"{limit:.{more}{style}}"
        if texts[0] != texts[1]:
            break
    return texts
