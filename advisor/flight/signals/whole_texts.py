"""Texts of vehicles (STATUSTEXT), joined from their chunks, sender by sender."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from advisor.flight.signals.messages import Columns
from advisor.process.arrays import FloatArray

LONGEST = 250
"""Largest number of characters of a text: five chunks, and the longest message of an ArduPilot log."""
_CHUNK = 50
"""Length of STATUSTEXT.text in bytes; a shorter chunk ends its text (MAVLink common.xml)."""


@dataclass(frozen=True, slots=True)
class WholeText:
    """A text with all chunks that arrived."""

    order: int
    """Index of the message that completed the text, in the order of arrival."""
    at_s: float
    """Vehicle time of the first chunk, s since boot."""
    severity: int
    text: bytes


@dataclass(frozen=True, slots=True)
class _Open:
    """A text that may continue in further chunks."""

    id: int
    sequence: int
    whole: WholeText


class WholeTexts:
    """Joins chunks that share an identifier and follow one another."""

    def __init__(self) -> None:
        self._open: dict[tuple[int, int], _Open] = {}

    def heard(self, columns: Columns, t: FloatArray) -> Iterator[WholeText]:
        """Yield the texts that these messages complete.

        Parameters
        ----------
        columns
            STATUSTEXT of one sender, in order of arrival.
        t
            Shape (n,), vehicle time of each message, s since boot.
        """
        sender = (columns.system, columns.component)
        ids, sequences = columns.fields.get("id"), columns.fields.get("chunk_seq")
        for i, raw in enumerate(columns.fields["text"].tolist()):
            order, text = int(columns.order[i]), bytes(raw).partition(b"\0")[0]
            number = 0 if ids is None else int(ids[i])
            sequence = 0 if sequences is None else int(sequences[i])
            open_ = self._open.pop(sender, None)
            if open_ is not None and (number, sequence) != (open_.id, open_.sequence + 1):
                yield replace(open_.whole, order=order)
                open_ = None
            begun = open_.whole if open_ else WholeText(order, float(t[i]), _severity(columns, i), b"")
            whole = replace(begun, order=order, text=begun.text + text)
            if number and len(text) >= _CHUNK:
                short = replace(whole, text=whole.text[: 2 * LONGEST])
                self._open[sender] = _Open(number, sequence, short)
            else:
                yield whole

    def finish(self) -> Iterator[tuple[tuple[int, int], WholeText]]:
        """Yield the sender and the text of each text whose last chunk did not arrive."""
        for sender, open_ in self._open.items():
            yield sender, open_.whole
        self._open.clear()


def _severity(columns: Columns, i: int) -> int:
    return int(columns.fields["severity"][i])
