"""Comparison of a flight with a replay of its inputs."""

import math
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .airframe import GRAVITY_M_S2
from .arrays import FloatArray
from .autopilot import MANUAL
from .loading import ScenarioError
from .tlog import read_tlog

Stream = tuple[FloatArray, FloatArray]
"""Stamps, s since boot, and values of a channel."""

SETTLING_S = 1.5
"""Time after the change to MANUAL that the comparison leaves out, s. The two flights come from different
attitude holds.
"""

SHORTEST_S = 1.0


@dataclass(frozen=True)
class Distance:
    """Difference of one channel between flight and replay during manoeuvres."""

    channel: str
    unit: str
    difference: float
    """Root mean square of the difference, without each manoeuvre's own offset."""
    signal: float
    """Root mean square of the flight's signal about each manoeuvre's mean."""


def distances(flight: Path, replay: Path) -> list[Distance]:
    """Return the distance of each channel, at the flight's own stamps.

    Raises
    ------
    ScenarioError
        A log cannot be read, or the flight has no stretch in MANUAL.
    """
    flown, again = _streams(flight), _streams(replay)
    found = []
    for name, unit in (("alpha", "rad"), ("q", "rad/s"), ("theta", "rad"), ("a_z", "m/s2")):
        if name not in flown or name not in again:
            continue
        stamps, values = flown[name]
        others = np.interp(stamps, *again[name])
        apart, signal, count = 0.0, 0.0, 0
        for begin, end in _maneuvers(flown["mode"]):
            part = (stamps >= begin) & (stamps <= end)
            if not part.any():
                continue
            apart += float(np.var(values[part] - others[part])) * int(part.sum())
            signal += float(np.var(values[part])) * int(part.sum())
            count += int(part.sum())
        if count:
            found.append(Distance(name, unit, math.sqrt(apart / count), math.sqrt(signal / count)))
    if not found:
        raise ScenarioError([f"{flight}: nothing flown in MANUAL, no manoeuvre to compare"])
    return found


def _maneuvers(mode: Stream) -> list[tuple[float, float]]:
    """Return stretches of MANUAL without their first ``SETTLING_S``."""
    stamps, modes = mode
    manual = np.concatenate([[False], modes == MANUAL, [False]])
    edges = np.flatnonzero(np.diff(manual.astype(int)))
    spans = [
        (float(stamps[begin]) + SETTLING_S, float(stamps[end - 1]))
        for begin, end in zip(edges[::2], edges[1::2], strict=True)
    ]
    return [(begin, end) for begin, end in spans if end - begin >= SHORTEST_S]


def _streams(path: Path) -> dict[str, Stream]:
    """Return the channels of a log on vehicle time. Heartbeats get the stamp of the latest attitude."""
    rows: dict[str, list[tuple[float, float]]] = defaultdict(list)
    now = 0.0
    try:
        for _, message in read_tlog(path, ("ATTITUDE", "AOA_SSA", "RAW_IMU", "HEARTBEAT")):
            kind = message.get_type()
            if kind == "ATTITUDE":
                now = message.time_boot_ms / 1e3
                rows["q"].append((now, message.pitchspeed))
                rows["theta"].append((now, message.pitch))
            elif kind == "AOA_SSA":
                rows["alpha"].append((message.time_usec / 1e6, math.radians(message.AOA)))
            elif kind == "RAW_IMU":
                rows["a_z"].append((message.time_usec / 1e6, message.zacc * GRAVITY_M_S2 / 1e3))
            elif message.type == 1:
                rows["mode"].append((now, message.custom_mode))
    except OSError as error:
        raise ScenarioError([f"{path}: cannot be read ({error.strerror})"]) from error
    if "mode" not in rows or "q" not in rows:
        raise ScenarioError([f"{path}: holds no flight (HEARTBEAT of an aeroplane and ATTITUDE are needed)"])
    columns = {name: np.array(pairs, dtype=float).T for name, pairs in rows.items()}
    return {name: (stamps, values) for name, (stamps, values) in columns.items()}
