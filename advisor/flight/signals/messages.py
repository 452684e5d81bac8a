"""Decoded MAVLink messages as columns, the input of all analysis, and whole texts of their chunks."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from advisor.process.arrays import FloatArray, IntArray
from advisor.words.mends import Carrier


@dataclass(frozen=True, slots=True)
class Columns:
    """Messages of one type from one system, in their order of arrival.

    A log and a live link both become columns, so that replay and live are processed equally.
    """

    name: str
    """Message name of the MAVLink definition, e.g. ``ATTITUDE``."""
    system: int
    """System id of the sender."""
    component: int
    """Component id of the sender."""
    order: IntArray
    """Shape (n,): arrival index in the whole stream, strictly increasing over all types."""
    arrival_s: FloatArray
    """Shape (n,): host time of arrival, seconds since 1970. The arrival time gives an order and is not used
    in dynamics."""
    fields: Mapping[str, NDArray[Any]]
    """Raw values of each field, shape (n,) or (n, k), in the units of the message definition. Text fields are
    arrays of ``bytes`` (NumPy kind ``S``)."""
    carrier: Carrier = "telemetry"
    """Kind of source from which the messages come. Only the sentences about the vehicle depend on the
    source."""
    flight: int = 0
    """Number of the campaign's log or link, 0 for the first. The arrival index ``order`` rises within one
    flight."""

    def __len__(self) -> int:
        return len(self.order)


def arrivals(columns: Columns, order: IntArray) -> FloatArray:
    """Return the host times of arrival of messages, in the shape of their indices ``order``."""
    times: FloatArray = columns.arrival_s[np.searchsorted(columns.order, order)]
    return times


def joined(several: Sequence[Columns]) -> Columns:
    """Return column sets of one message and sender, one after the other, with the fields that all have."""
    return replace(
        several[-1],
        order=np.concatenate([c.order for c in several]),
        arrival_s=np.concatenate([c.arrival_s for c in several]),
        fields={
            name: np.concatenate([c.fields[name] for c in several])
            for name in several[-1].fields
            if all(name in c.fields for c in several)
        },
    )


def cut(columns: Columns, rows: NDArray[Any] | slice) -> Columns:
    """Return the given rows of a column set, in their order of arrival."""
    return replace(
        columns,
        order=columns.order[rows],
        arrival_s=columns.arrival_s[rows],
        fields={name: values[rows] for name, values in columns.fields.items()},
    )


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
