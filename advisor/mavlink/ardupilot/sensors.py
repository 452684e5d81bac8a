"""Choice among several instances of one record in an ArduPilot log: healthy, in use, and primary."""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from advisor.mavlink.records.equivalent import latest
from advisor.mavlink.records.stretches import RecordTable
from advisor.process.arrays import FloatArray, IntArray
from advisor.words.quantities import clock, stretch

BoolArray = NDArray[np.bool_]
_MOST_CHANGES = 5
"""Largest number of sentences about changes of one sensor."""

_HEALTH = {"H": 1.0, "Health": 1.0, "GH": 1.0, "AH": 1.0, "Status": 3.0}
"""Least value of a healthy sensor in each field of health. Status 3 of GPS is a fix in three dimensions."""
HEALTH_FIELDS = frozenset(_HEALTH)
"""Names of the fields of health."""
_IN_USE = "U"
"""Name of the field that is 1 if the autopilot uses the sensor."""
_MOVING = ("GyrX", "GyrY", "GyrZ", "AccX", "AccY", "AccZ")
"""Fields of IMU in which a live sensor always shows noise. Noise moves at least one of a live sensor's axes
from sample to sample."""
_FROZEN_S = 0.5
"""Time of constant values, s, after which an inertial sensor counts as dead, whatever its health field
states. A sound sensor repeats a value at most once, if records are faster than samples."""


def stated_health(table: RecordTable) -> set[str]:
    """Return the health fields that state a healthy sensor at least once. A field that never states a healthy
    sensor is not informative."""
    return {name for name in _stated(table) if np.any(table.fields[name] >= _HEALTH[name])}


def flown(
    table: RecordTable,
    health: Collection[str],
    primary: FloatArray | None = None,
    unused: Collection[int] = (),
) -> RecordTable:
    """Return the records of the sensor in use at each time; none while no sensor was healthy.

    If the primary sensor is not healthy or not in use, the lowest-numbered usable sensor is taken. Without a
    stated primary sensor, the healthy sensor with the lowest number is taken. ArduPilot selects
    its sensors by these rules.

    Parameters
    ----------
    health
        Fields that state a sensor's health (:func:`stated_health`).
    primary
        Shape (n,): number of the primary sensor at each record, NaN where unknown.
    unused
        Numbers of sensors that the parameters exclude.
    """
    if len(table) == 0:
        return table
    instance = _numbers(table)
    numbers = np.unique(instance)
    used = np.asarray(table.fields.get(_IN_USE, np.ones(len(table))) != 0) & ~np.isin(instance, list(unused))
    worth = _healthy(table, instance, health).astype(np.int64) * (1 + used)
    state = np.zeros((len(numbers), len(table)), dtype=np.int64)
    for row, number in enumerate(numbers):
        own = instance == number
        newest = latest(table.order, table.order[own], worth[own])
        state[row] = np.where(np.isnan(newest), worth[own][0], newest)
    place = np.argmax(state, axis=0)
    if primary is not None:
        at = np.searchsorted(numbers, np.nan_to_num(primary, nan=-1.0)).clip(0, len(numbers) - 1)
        named = numbers[at] == primary
        place = np.where(named & (state[at, np.arange(len(table))] == 2), at, place)
    mine = (instance == numbers[place]) & (worth > 0)
    return table if np.all(mine) else table[mine]


@dataclass(frozen=True, slots=True)
class Said:
    """One sentence about the sensor in use, with the position of its record."""

    order: int
    """Position of the record in the file, bytes."""
    time_us: int
    """Time of the record, microseconds since boot."""
    text: str


@dataclass(frozen=True, slots=True)
class Silence:
    """A time with records but without a healthy sensor."""

    begin_us: int
    """Begin of the time without a healthy sensor, microseconds since boot."""
    end_us: int
    order: int
    """Position in the file of the last record in this time, bytes."""


def said(
    every: RecordTable,
    table: RecordTable,
    quantity: str,
    health: Collection[str],
    silences: Iterable[Silence],
    noun: str = "sensor",
) -> list[Said]:
    """Return sentences about the first sensor in use, changes of sensor, and times without a healthy one.

    If sensor 0 is always in use, there is no sentence.
    """
    return [
        *_doubts(every, quantity, health),
        *changes(table, quantity, noun),
        *(_silence(silence, quantity) for silence in silences),
    ]


def silences_in(every: RecordTable, table: RecordTable, before: Sequence[Silence] = ()) -> list[Silence]:
    """Return the times without a healthy sensor.

    Parameters
    ----------
    before
        Times without a healthy sensor in the stretch before, of which the last may continue.
    """
    silences = []
    for first, last in _silent(every, table):
        here_us, end_us = every.time_us[[first, last]].tolist()
        begin_us = next((s.begin_us for s in before if s.begin_us <= here_us <= s.end_us), here_us)
        silences.append(Silence(begin_us, end_us, int(every.order[last])))
    return silences


def _doubts(every: RecordTable, quantity: str, health: Collection[str]) -> list[Said]:
    """Return a sentence if no record states any sensor as healthy. All sensors are then taken as healthy."""
    if len(every) == 0 or set(_stated(every)) <= set(health):
        return []
    text = f"{quantity}: the log states no sensor as healthy, and all sensors are used"
    return [Said(int(every.order[0]), int(every.time_us[0]), text)]


def changes(table: RecordTable, quantity: str, noun: str = "sensor") -> list[Said]:
    """Return sentences about the first instance in use and its changes; none if only instance 0
    was in use.
    """
    instance = _numbers(table)
    rows = np.flatnonzero(np.diff(instance, prepend=-1))
    if instance[rows].tolist() in ([], [0]):
        return []
    sentences = []
    for number, row in enumerate(rows[:_MOST_CHANGES].tolist(), start=1):
        since = f" since {clock(table.time_us[row] / 1e6)}" if row else ""
        text = f"{quantity}: {noun} {instance[row]} flew{since}"
        if number == _MOST_CHANGES < len(rows):
            text += f", and {len(rows) - _MOST_CHANGES} more changes follow"
        sentences.append(Said(int(table.order[row]), int(table.time_us[row]), text))
    return sentences


def _silence(silence: Silence, quantity: str) -> Said:
    when = stretch(silence.begin_us / 1e6, silence.end_us / 1e6)
    return Said(
        silence.order, silence.end_us, f"{quantity}: no sensor was healthy from {when} and none is used there"
    )


def _silent(every: RecordTable, table: RecordTable) -> list[tuple[int, int]]:
    """Return the first and last row of each stretch of ``every`` without a healthy sensor."""
    if len(table) == len(every):
        return []
    # A stretch without a healthy sensor is longer than the interval of the records of the sensor in use.
    usual_us = max(float(np.median(np.diff(table.time_us))), 1.0) if len(table) > 1 else 1.0
    edges = np.concatenate(([every.time_us[0] - usual_us], table.time_us, [every.time_us[-1] + usual_us]))
    stretches = []
    for gap in np.flatnonzero(np.diff(edges) > 3.0 * usual_us).tolist():
        within = np.flatnonzero((every.time_us > edges[gap]) & (every.time_us < edges[gap + 1]))
        if len(within):
            stretches.append((int(within[0]), int(within[-1])))
    return stretches


def _numbers(table: RecordTable) -> IntArray:
    """Return the sensor number of each record, shape (n,)."""
    for name in ("I", "C"):
        if name in table.fields:
            return table.fields[name].astype(np.int64)
    return np.zeros(len(table), dtype=np.int64)


def _healthy(table: RecordTable, instance: IntArray, health: Collection[str]) -> BoolArray:
    good = np.ones(len(table), dtype=np.bool_)
    for name in set(_stated(table)) & set(health):
        good &= table.fields[name] >= _HEALTH[name]
    if set(_MOVING) <= table.fields.keys():
        for number in np.unique(instance):
            own = np.flatnonzero(instance == number)
            good[own] &= ~_frozen(table[own])
    return good


def _stated(table: RecordTable) -> list[str]:
    """Return the names of the health fields in the records."""
    return [name for name in _HEALTH if name in table.fields]


def _frozen(table: RecordTable) -> BoolArray:
    """Return whether each record of an inertial sensor lies in a constant stretch of ``_FROZEN_S``."""
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
