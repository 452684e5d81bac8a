"""Decoded MAVLink messages as columns, the input of all analysis."""

from collections.abc import Mapping, Sequence
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
