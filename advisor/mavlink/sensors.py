"""Which of several like sensors of an ArduPilot log flew: healthy, in use, and primary."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from advisor.flight.messages import IntArray
from advisor.mavlink.dataflash import Table
from advisor.mavlink.equivalent import latest
from advisor.vehicle_time import between, clock

BoolArray = NDArray[np.bool_]

_HEALTH = ("H", "GH", "AH")
"""ARSP.H, IMU.GH and IMU.AH (air speed, gyro and accelerometer healthy): 1 is good."""
_IN_USE = "U"
"""ARSP.U: 1 where the autopilot uses the sensor."""
_MOVING = ("GyrX", "GyrY", "GyrZ", "AccX", "AccY", "AccZ")
"""Values of IMU, of which the noise moves at least one from sample to sample."""
_FROZEN_S = 0.5
"""An inertial sensor that repeats all its values for so long is dead, whatever its health says. A sound one
repeats them from one record to the next at most, when records come faster than samples."""


def flown(table: Table) -> Table:
    """The records of the sensor that flew, at each time; none where no sensor was healthy.

    ARSP.Pri names the primary sensor. Where it names one that is not both healthy and in use, the
    lowest-numbered such sensor flew; where there is none, the lowest-numbered healthy one.
    (ArduPilot log messages ARSP and IMU.)
    """
    if len(table) == 0:
        return table
    instance = _numbers(table)
    numbers = np.unique(instance)
    worth = _healthy(table, instance).astype(np.int64) * (1 + _used(table))
    state = np.zeros((len(numbers), len(table)), dtype=np.int64)
    for row, number in enumerate(numbers):
        own = instance == number
        known = latest(table.order, table.order[own], worth[own])
        state[row] = np.where(np.isnan(known), worth[own][0], known)
    place = np.argmax(state, axis=0)
    if "Pri" in table.fields:
        primary = np.searchsorted(numbers, table.fields["Pri"].astype(np.int64)).clip(0, len(numbers) - 1)
        named = numbers[primary] == table.fields["Pri"]
        place = np.where(named & (state[primary, np.arange(len(table))] == 2), primary, place)
    mine = (instance == numbers[place]) & (worth > 0)
    return table if np.all(mine) else table[mine]


@dataclass(frozen=True, slots=True)
class Said:
    """One sentence about the sensor that flew, and the record it belongs to."""

    order: int
    """Where the record begins in the file, bytes."""
    time_us: int
    """Microseconds since boot."""
    text: str


def said(every: Table, table: Table, quantity: str) -> list[Said]:
    """The sensor that flew first, each change of sensor, and the time without a healthy one.

    Nothing is said where sensor 0 flew throughout.

    Parameters
    ----------
    every
        The records of all sensors.
    table
        Those of the sensor that flew, as :func:`flown` gives them.
    quantity
        Name of what the sensor measures.
    """
    return [*_doubts(every, quantity), *_changes(table, quantity), *_silences(every, table, quantity)]


def _doubts(every: Table, quantity: str) -> list[Said]:
    """That no record calls any of the sensors healthy: they are then read as if all were."""
    if len(every) == 0 or _spoken_for(every) == _stated(every):
        return []
    text = f"{quantity}: no sensor is ever stated to be healthy, and they are used all the same"
    return [Said(int(every.order[0]), int(every.time_us[0]), text)]


def _changes(table: Table, quantity: str) -> list[Said]:
    instance = _numbers(table)
    rows = np.flatnonzero(np.diff(instance, prepend=-1))
    if instance[rows].tolist() in ([], [0]):
        return []
    sentences = []
    for row in rows.tolist():
        since = f" since {clock(table.time_us[row] / 1e6)}" if row else ""
        text = f"{quantity}: sensor {instance[row]} flew{since}"
        sentences.append(Said(int(table.order[row]), int(table.time_us[row]), text))
    return sentences


def _silences(every: Table, table: Table, quantity: str) -> list[Said]:
    sentences = []
    for first, last in silent(every, table):
        start_s, end_s = every.time_us[[first, last]] / 1e6
        text = f"{quantity}: no sensor was healthy from {between(start_s, end_s)} and none is used there"
        sentences.append(Said(int(every.order[first]), int(every.time_us[first]), text))
    return sentences


def silent(every: Table, table: Table) -> list[tuple[int, int]]:
    """Stretches in which sensors were recorded and none was healthy: rows of ``every``, first and last.

    Parameters
    ----------
    every
        The records of all sensors.
    table
        Those of the sensor that flew, as :func:`flown` gives them.
    """
    if len(table) == len(every):
        return []
    # A stretch without a healthy sensor is longer than the time between two records of the sensor that flew.
    usual_us = float(np.median(np.diff(table.time_us))) if len(table) > 1 else 0.0
    edges = np.concatenate(([every.time_us[0] - usual_us], table.time_us, [every.time_us[-1] + usual_us]))
    found = []
    for gap in np.flatnonzero(np.diff(edges) > 3.0 * max(usual_us, 1.0)).tolist():
        within = np.flatnonzero((every.time_us > edges[gap]) & (every.time_us < edges[gap + 1]))
        if len(within):
            found.append((int(within[0]), int(within[-1])))
    return found


def _numbers(table: Table) -> IntArray:
    """The sensor of each record; shape (n,)."""
    if "I" not in table.fields:
        return np.zeros(len(table), dtype=np.int64)
    return table.fields["I"].astype(np.int64)


def _used(table: Table) -> BoolArray:
    return np.asarray(table.fields.get(_IN_USE, np.ones(len(table))) != 0)


def _healthy(table: Table, instance: IntArray) -> BoolArray:
    good = np.ones(len(table), dtype=np.bool_)
    for name in _spoken_for(table):
        good &= table.fields[name] != 0
    if set(_MOVING) <= table.fields.keys():
        for number in np.unique(instance):
            own = np.flatnonzero(instance == number)
            good[own] &= ~_frozen(table[own])
    return good


def _stated(table: Table) -> list[str]:
    """The fields of health that the records have."""
    return [name for name in _HEALTH if name in table.fields]


def _spoken_for(table: Table) -> list[str]:
    """Those that ever say healthy: one that never does cannot tell one sensor or time from another."""
    return [name for name in _stated(table) if np.any(table.fields[name] != 0)]


def _frozen(table: Table) -> BoolArray:
    """Records of one inertial sensor that belong to a stretch of ``_FROZEN_S`` without any change."""
    values = np.stack([table.fields[name] for name in _MOVING], axis=1)
    moved = np.concatenate(([True], np.any(np.diff(values, axis=0) != 0.0, axis=1)))
    stretch = np.cumsum(moved) - 1
    first = np.flatnonzero(moved)
    last = np.concatenate((first[1:], [len(table)])) - 1
    lasts_us = table.time_us[last] - table.time_us[first]
    # A model without noise at rest has no rates either, but it has its weight.
    at_rest = np.all(values[:, :3] == 0.0, axis=1) & np.any(values[:, 3:] != 0.0, axis=1)
    frozen: BoolArray = (lasts_us >= 1e6 * _FROZEN_S)[stretch] & ~at_rest
    return frozen
