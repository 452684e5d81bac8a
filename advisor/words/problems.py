"""Problems of the input with their remedies, and texts that every terminal can print."""

import codecs
import io
import os
import sys
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass


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


_ERRORS = "advisor-plain"
_ASCII = "plain_ascii"
_SPELLED = {
    "°": " deg", "±": "+-", "²": "2", "³": "3", "·": "-", "×": "x", "µ": "u", "δ": "delta_",
    "–": "-", "—": "-", "−": "-", "⁻": "-", "•": "*", "…": "...", "→": "->", "≤": "<=", "≥": ">=", "∅": "0",
    "∙": ".",
    "▔": "-", "▁": "_", "▂": ".", "▃": ":", "▄": "-", "▅": "=", "▆": "+", "▇": "*", "█": "#",
    "▉": "#", "▊": "#", "▋": "#", "▌": "=", "▍": "=", "▎": "-", "▏": "|",
    "■": "#", "▶": ">", "►": ">", "◀": "<", "●": "*", "✓": "+", "✗": "x", "❚": "|",
}  # fmt: skip
"""ASCII spellings of the characters that the advisor writes. The Unicode names of Greek letters and lines
give their spellings. ``δ`` becomes ``delta_`` so that M_δe reads M_delta_e.
"""

BRAILLE, _UPPER = 0x2800, 0b00011011
"""First code point of Unicode's braille cells, in which curves are drawn, and the bits of a cell's four upper
dots.
"""


def plain(text: str) -> str:
    """Return the text in ASCII. A character without an ASCII spelling becomes a question mark."""
    return "".join(map(_spelled, text))


def speak_plainly() -> None:
    """Let standard output and standard error replace characters outside their encoding, instead of failing.

    An ASCII stream gets an encoding with another name. Otherwise click takes ASCII for a mistake in the
    user's settings and writes UTF-8. A terminal with the POSIX locale counts as an ASCII stream, although
    Python writes UTF-8 to it. A closed stream accepts every text and shows nothing.
    """
    codecs.register_error(_ERRORS, _stand_in)
    codecs.unregister(_ascii_by_another_name)  # a second call registers nothing twice
    codecs.register(_ascii_by_another_name)
    sys.stdout = sys.stdout or open(os.devnull, "w")  # noqa: SIM115 (open to the end)
    sys.stderr = sys.stderr or open(os.devnull, "w")  # noqa: SIM115
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            is_ascii = codecs.lookup(stream.encoding).name == "ascii" or (stream.isatty() and _posix())
            stream.reconfigure(encoding=_ASCII if is_ascii else None, errors=_ERRORS)


def _posix() -> bool:
    """Return whether the user chose the POSIX locale, and no other setting chose UTF-8 for Python."""
    stated = os.environ.get("LC_ALL") or os.environ.get("LANG")
    return stated in ("C", "POSIX") and bool(sys.flags.utf8_mode) and "PYTHONUTF8" not in os.environ


def _spelled(character: str) -> str:
    if character.isascii():
        return character
    if character in _SPELLED:
        return _SPELLED[character]
    if BRAILLE <= ord(character) < BRAILLE + 256:
        dots = ord(character) - BRAILLE
        return " '.:"[bool(dots & _UPPER) + 2 * bool(dots & ~_UPPER)]
    name = unicodedata.name(character, "")
    if name.startswith("GREEK"):
        return name.rpartition(" ")[2].lower()
    if name.startswith("BOX DRAWINGS"):
        return "+" if " AND " in name else "|" if "VERTICAL" in name else "-"
    letters = unicodedata.normalize("NFKD", character).encode("ascii", "ignore").decode()
    return letters or "?"


def _stand_in(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return plain(error.object[error.start : error.end]), error.end


def _ascii_by_another_name(name: str) -> codecs.CodecInfo | None:
    if name != _ASCII:
        return None
    ascii_ = codecs.lookup("ascii")
    return codecs.CodecInfo(
        ascii_.encode, ascii_.decode, ascii_.streamreader, ascii_.streamwriter,
        ascii_.incrementalencoder, ascii_.incrementaldecoder, name=_ASCII,
    )  # fmt: skip


@dataclass(frozen=True)
class Problem:
    """One obstacle to the use of an input, as listed in the JSON documents."""

    code: str
    """Short and stable identifier: ``no_vehicle``, ``no_elevator``, ``rate``, ``not_a_tlog``, ``empty``,
    ..."""
    text: str
    """One sentence that says what is wrong, with the numbers."""
    fix: str
    """One sentence that says how to remedy the problem."""

    def __post_init__(self) -> None:
        # These sentences hold names of files and texts from vehicles.
        object.__setattr__(self, "text", printable(self.text))
        object.__setattr__(self, "fix", printable(self.fix))

    def __str__(self) -> str:
        return f"{self.text} {self.fix}".strip()

    def about(self, name: str) -> str:
        """Return the problem with ``name`` before its text, unless the text already contains ``name``."""
        name = printable(name)
        return str(self) if name in self.text else f"{name}: {self}"


class UnusableInputError(Exception):
    """The input cannot be used for this purpose (exit code 3)."""

    def __init__(self, code: str, text: str, fix: str = "", further: Sequence[Problem] = ()) -> None:
        self.problem = Problem(code, text, fix)
        self.problems = (self.problem, *further)
        """All problems of the input."""
        super().__init__("\n".join(map(str, self.problems)))

    @classmethod
    def of(cls, problems: Sequence[Problem]) -> "UnusableInputError":
        """Return the error that lists at least one problem."""
        first, *further = problems
        return cls(first.code, first.text, first.fix, further)

    def __reduce__(self) -> tuple[type["UnusableInputError"], tuple[str, str, str, tuple[Problem, ...]]]:
        first, *further = self.problems
        return type(self), (first.code, first.text, first.fix, tuple(further))


class ConfigurationError(Exception):
    """The user's call or file is wrong (exit code 2); the message lists every mistake."""

    def __init__(self, message: str) -> None:
        super().__init__(printable(message))
