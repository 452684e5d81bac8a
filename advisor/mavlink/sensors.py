"""Which of several like sensors of an ArduPilot log flew: healthy, in use, and primary."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from advisor.flight.messages import IntArray
from advisor.mavlink.dataflash import Table
from advisor.mavlink.equivalent import latest

BoolArray = NDArray[np.bool_]

_GOOD = ("H", "U", "GH", "AH")
"""ARSP.H (healthy), ARSP.U (in use), IMU.GH and IMU.AH (gyro and accelerometer healthy): 1 is good."""


def flown(table: Table) -> Table:
    """The records of the sensor that flew, at each time.

    ARSP.Pri names the primary sensor. Where no record names one that is good, the lowest-numbered
    good sensor flew; where none is good, the lowest-numbered one.
    (ArduPilot log messages ARSP and IMU.)
    """
    if "I" not in table.fields or len(table) == 0:
        return table
    instance = table.fields["I"].astype(np.int64)
    numbers = np.unique(instance)
    if len(numbers) == 1:
        return table
    good = _good(table)
    state = np.zeros((len(numbers), len(table)), dtype=np.bool_)
    for row, number in enumerate(numbers):
        own = instance == number
        known = latest(table.order, table.order[own], good[own].astype(np.float64))
        state[row] = np.where(np.isnan(known), good[own][0], known != 0.0)
    chosen = numbers[np.argmax(state, axis=0)]
    if "Pri" in table.fields:
        primary = table.fields["Pri"].astype(np.int64)
        chosen = np.where(_state_of(primary, numbers, state), primary, chosen)
    return table[instance == chosen]


@dataclass(frozen=True, slots=True)
class Said:
    """One sentence about the sensor that flew, and the record it belongs to."""

    order: int
    """Where the record begins in the file, bytes."""
    time_us: int
    """Microseconds since boot."""
    text: str


def said(table: Table, quantity: str) -> list[Said]:
    """The sensor that flew first and each change of sensor; none where sensor 0 flew throughout.

    Parameters
    ----------
    table
        Records as :func:`flown` gives them.
    quantity
        Name of what the sensor measures.
    """
    if "I" not in table.fields:
        return []
    instance = table.fields["I"].astype(np.int64)
    rows = np.flatnonzero(np.diff(instance, prepend=-1))
    if instance[rows].tolist() == [0]:
        return []
    sentences = []
    for row in rows.tolist():
        since = f" from {table.time_us[row] / 1e6:.1f} s on" if row else ""
        text = f"{quantity}: sensor {instance[row]} flew{since}"
        sentences.append(Said(int(table.order[row]), int(table.time_us[row]), text))
    return sentences


def _good(table: Table) -> BoolArray:
    good = np.ones(len(table), dtype=np.bool_)
    for name in _GOOD:
        if name in table.fields:
            good &= table.fields[name] != 0
    return good


def _state_of(number: IntArray, numbers: IntArray, state: BoolArray) -> BoolArray:
    """Whether each row's sensor is good; shape (n,). A number that no record bears is not."""
    row = np.searchsorted(numbers, number).clip(0, len(numbers) - 1)
    known: BoolArray = (numbers[row] == number) & state[row, np.arange(len(number))]
    return known
