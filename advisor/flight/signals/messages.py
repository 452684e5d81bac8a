"""Decoded MAVLink messages as columns, the input of the core."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from advisor.process.arrays import FloatArray as FloatArray
from advisor.process.arrays import IntArray as IntArray
from advisor.words.mends import Carrier


@dataclass(frozen=True, slots=True)
class Columns:
    """Messages of one type from one system, in their order of arrival.

    A log and a live link both end in columns, so that no consumer can distinguish replay from live.
    """

    name: str
    """Message name of the MAVLink definition, e.g. ``ATTITUDE``."""
    system: int
    """System id of the sender."""
    component: int
    """Component id of the sender."""
    order: IntArray
    """Shape (n,). Arrival index in the whole stream: strictly increasing over all types."""
    arrival_s: FloatArray
    """Shape (n,). Host time of arrival, seconds since 1970. Arrival gives an order and never enters
    dynamics."""
    fields: Mapping[str, NDArray[Any]]
    """Field name to raw values, shape (n,) or (n, k), in the units of the message definition.
    Text fields are arrays of ``bytes`` (NumPy kind ``S``)."""
    carrier: Carrier = "telemetry"
    """Source of the messages. Only the sentences about the vehicle depend on the source."""
    flight: int = 0
    """Number of the campaign's log or link, 0 for the first. ``order`` rises within it."""

    def __len__(self) -> int:
        return len(self.order)


def arrivals(columns: Columns, order: IntArray) -> FloatArray:
    """Return the host times of arrival for these arrival indices, in the shape of ``order``."""
    times: FloatArray = columns.arrival_s[np.searchsorted(columns.order, order)]
    return times


def cut(columns: Columns, rows: NDArray[np.bool_] | slice) -> Columns:
    """Return the given rows of a column set, in their order of arrival."""
    return replace(
        columns,
        order=columns.order[rows],
        arrival_s=columns.arrival_s[rows],
        fields={name: values[rows] for name, values in columns.fields.items()},
    )
