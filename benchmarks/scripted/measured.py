"""What the telemetry shows of an input that a script has flown, relative to what was asked."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.elevator.elevator_outputs import find_elevator, find_side_control
from advisor.flight.vehicle.ardupilot_wiring import ardupilot_wiring
from advisor.flight.vehicle.surfaces import Surface
from advisor.process.arrays import FloatArray
from advisor.scripts.inputs import CONTROLS, Control
from advisor.scripts.table import Entry

from .pilot import Pilot

TELEMETRY_MS = 10.0
"""Interval of the servo outputs in the telemetry of `pilot`, ms, by which two edges are known."""
_SETTLED_S = 0.03
"""Time after a step in which its two samples of telemetry lie, s."""
_CLOCK_S = 0.25
"""Largest time from the text BEGIN to the first pulse in the telemetry, s."""


@dataclass(frozen=True)
class Flown:
    """One control of one flown input."""

    input: str
    control: Control
    asked_deg: float
    late_ms: float
    """Largest distance of a step's edge from its time after the first one, ms; for sines the shift from the
    control that began first."""
    size_percent: float
    """Largest error of a level, % of the size; for sines that of the amplitude."""
    pulse_percent: float
    """Deflection of 1 us of pulse, % of the size: no script can be nearer."""


def deflections(pilot: Pilot, aircraft: Aircraft) -> tuple[FloatArray, Mapping[Control, FloatArray]]:
    """Return times, s, and deflections of each control that has outputs, deg, by the advisor's reader."""
    wiring = ardupilot_wiring(pilot.parameters)
    t, us = pilot.pulses()
    read: dict[Control, FloatArray] = {}
    for control in CONTROLS:
        surface = (
            find_elevator(aircraft.elevator, wiring)
            if control == "elevator"
            else find_side_control(control, getattr(aircraft, control), wiring)
        )
        if isinstance(surface, Surface):
            read[control] = np.degrees(surface.deflection(us[:, [n - 1 for n in surface.outputs]]))
    return t, read


def flown_of(entry: Entry, begin_s: float, t: FloatArray, read: Mapping[Control, FloatArray]) -> list[Flown]:
    """Return what was flown of each control that an input moves and the aircraft has."""
    test = entry.test
    moved = [control for control in test.moved if control in read]
    steps = {c: np.abs(np.diff(np.unique(read[c].round(6)))).min() for c in moved}
    sizes = {control: float(np.degrees(entry.sizes[control].rad)) for control in moved}
    if test.sines is None:
        (control,) = moved
        late, off = _steps(entry, sizes[control], begin_s, t, read[control])
        return [Flown(test.name, control, sizes[control], late, off, 100.0 * steps[control] / sizes[control])]
    found = {c: _sines(entry, c, sizes[c], begin_s, t, read[c]) for c in moved}
    first = min(shift for shift, _ in found.values())
    return [
        Flown(test.name, c, sizes[c], 1e3 * (shift - first), off, 100.0 * steps[c] / sizes[c])
        for c, (shift, off) in found.items()
    ]


def _steps(
    entry: Entry, size_deg: float, begin_s: float, t: FloatArray, deg: FloatArray
) -> tuple[float, float]:
    """Return the largest error of an edge, ms, and of a level, % of the size."""
    test = entry.test
    levels = np.array([0.0, *(size_deg * share for _, share in test.steps), 0.0])
    edges = test.unit_s * np.cumsum([0.0, *(units for units, _ in test.steps)])
    resting = (t > begin_s + test.length_s + _CLOCK_S) & (
        t < begin_s + test.length_s + test.rest_s - _CLOCK_S
    )
    moved = deg - float(np.median(deg[resting]))
    # The loop may be away from trim before the first step.
    levels[0] = float(np.median(moved[(t > begin_s - 0.08) & (t < begin_s - 0.02)]))
    off, late = [], []
    for k, edge in enumerate(edges):
        around = np.abs(t - begin_s - edge) < _CLOCK_S
        late.append(_crossing(t[around], moved[around], levels[k], levels[k + 1], begin_s + edge) - edge)
        if k + 1 < len(edges):
            held = (t > late[-1] + edge + _SETTLED_S) & (t < late[-1] + edges[k + 1] - _SETTLED_S)
            off.append(abs(float(np.median(moved[held])) - levels[k + 1]))
    return 1e3 * float(np.max(np.abs(np.array(late) - late[0]))), 100.0 * max(off) / size_deg


def _crossing(t: FloatArray, deg: FloatArray, old: float, new: float, near_s: float) -> float:
    """Return the time of the crossing between two levels that is nearest to a time, s; NaN without one."""
    beyond = (deg - 0.5 * (old + new)) * np.sign(new - old)
    rising = np.flatnonzero((beyond[:-1] <= 0.0) & (beyond[1:] > 0.0))
    if not len(rising):
        return float("nan")
    share = -beyond[rising] / (beyond[rising + 1] - beyond[rising])
    times = t[rising] + share * (t[rising + 1] - t[rising])
    return float(times[np.argmin(np.abs(times - near_s))])


def _sines(
    entry: Entry, control: Control, size_deg: float, begin_s: float, t: FloatArray, deg: FloatArray
) -> tuple[float, float]:
    """Return the shift of a multisine from its BEGIN, s, and the error of its amplitude, %."""
    test = entry.test
    assert test.sines is not None
    sines, length = test.sines[control], test.length_s
    inside = (t > begin_s + _CLOCK_S) & (t < begin_s + length - _CLOCK_S)

    def fitted(shift_s: float) -> tuple[float, float]:
        asked = size_deg * sines.values((t[inside] - begin_s - shift_s) / length)
        columns = np.stack([asked, np.ones(len(asked))], axis=1)
        answer, left, *_ = np.linalg.lstsq(columns, deg[inside], rcond=None)
        return float(answer[0]), float(left[0])

    best = minimize_scalar(lambda s: fitted(s)[1], bounds=(-0.1, 0.1), method="bounded")
    return float(best.x), 100.0 * abs(fitted(float(best.x))[0] - 1.0)
