"""Text from outside, made safe for a terminal."""


def printable(text: str) -> str:
    """Return the text on one line, without control characters and escape sequences.

    Letters of every script stay. A line break and a tab become a space. Half of a surrogate pair, as in the
    name of a file in another encoding, becomes U+FFFD. Every other character without a shape is dropped.
    """
    return text if text.isprintable() else "".join(map(_shown, text))


def _shown(character: str) -> str:
    if character.isprintable():
        return character
    if character.isspace():
        return " "
    return "\N{REPLACEMENT CHARACTER}" if "\ud800" <= character <= "\udfff" else ""
