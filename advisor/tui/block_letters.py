"""Block letters for words that must be read at arm's length."""

HEIGHT = 5

_LETTERS = {
    "A": ("█████", "█   █", "█████", "█   █", "█   █"),
    "B": ("████ ", "█   █", "████ ", "█   █", "████ "),
    "C": ("█████", "█    ", "█    ", "█    ", "█████"),
    "D": ("████ ", "█   █", "█   █", "█   █", "████ "),
    "E": ("█████", "█    ", "████ ", "█    ", "█████"),
    "G": ("█████", "█    ", "█  ██", "█   █", "█████"),
    "H": ("█   █", "█   █", "█████", "█   █", "█   █"),
    "I": ("███", " █ ", " █ ", " █ ", "███"),
    "K": ("█   █", "█  █ ", "███  ", "█  █ ", "█   █"),
    "L": ("█    ", "█    ", "█    ", "█    ", "█████"),
    "M": ("█   █", "██ ██", "█ █ █", "█   █", "█   █"),
    "N": ("█   █", "██  █", "█ █ █", "█  ██", "█   █"),
    "O": ("█████", "█   █", "█   █", "█   █", "█████"),
    "P": ("█████", "█   █", "█████", "█    ", "█    "),
    "R": ("█████", "█   █", "█████", "█  █ ", "█   █"),
    "S": ("█████", "█    ", "█████", "    █", "█████"),
    "T": ("█████", "  █  ", "  █  ", "  █  ", "  █  "),
    "U": ("█   █", "█   █", "█   █", "█   █", "█████"),
    "V": ("█   █", "█   █", "█   █", " █ █ ", "  █  "),
    "W": ("█   █", "█   █", "█ █ █", "██ ██", "█   █"),
    "X": ("█   █", " █ █ ", "  █  ", " █ █ ", "█   █"),
    " ": ("  ", "  ", "  ", "  ", "  "),
}

_SCALES = ((4, 3), (4, 2), (3, 2), (2, 2), (2, 1), (1, 1))
"""Columns and rows of the terminal for each dot of a letter, the largest first."""


def block_letters(word: str, width: int, height: int) -> str:
    """Write a word as large as the space allows, or in plain letters if block letters do not fit.

    Raises
    ------
    KeyError
        The word contains a letter that has no block form.
    """
    for across, down in _SCALES:
        for gap in ("  ", " "):
            rows = [gap.join(_LETTERS[letter][row] for letter in word) for row in range(HEIGHT)]
            if len(rows[0]) * across <= width and HEIGHT * down <= height:
                return "\n".join("".join(dot * across for dot in row) for row in rows for _ in range(down))
    return word
