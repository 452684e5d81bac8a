"""Text from a vehicle, a file or a user, made safe for a terminal."""


def printable(text: str) -> str:
    """Return the text on one line, without control characters and escape sequences.

    Letters of every script stay. A line break and a tab become a space. Half of a surrogate pair becomes
    U+FFFD; the name of a file in another encoding has such halves. Every other unprintable character is
    removed.
    """
    return text if text.isprintable() else "".join(map(_shown, text))


def _shown(character: str) -> str:
    if character.isprintable():
        return character
    if character.isspace():
        return " "
    return "\N{REPLACEMENT CHARACTER}" if "\ud800" <= character <= "\udfff" else ""
