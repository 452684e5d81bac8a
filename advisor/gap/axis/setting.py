"""Parameters of servos, instruments and propeller in a simulation along an axis.

Surfaces are those of the pitch axis: delay, lag, rate limit, play and dead band between command and
deflection (``gap.simulator.surface``). Instruments act on the outputs: skew of stamps, a scale error, an arm.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.gap.simulator.layout import ENTRIES, INDEX
from advisor.gap.simulator.surface import surface
from advisor.model.axis import Axis, Place
from advisor.oem.axis.problem import AxisAssembly, AxisProblem, lay_out
from advisor.oem.rows import Signal
from advisor.oem.surface import LONGEST_STEP_S
from advisor.process.arrays import FloatArray

THROTTLE = "throttle"
"""First part of the place of the propeller's moment, which is stated as the deflection of a control."""


@dataclass(frozen=True, slots=True)
class Flown:
    """Records of a flight, prepared for the comparison with the simulator."""

    problem: AxisProblem
    """Records, whose servos and instruments are those of a ``Setting``."""
    throttle: tuple[Signal | None, ...]
    """Throttle of each record, 0..1; None where it was not recorded."""
    arm_is_stated: bool = False
    """Whether the aircraft file states the place of the sideslip vane."""

    @property
    def axis(self) -> Axis:
        """Axis of the records."""
        return self.problem.axis

    def __len__(self) -> int:
        return len(self.problem.records)

    @property
    def foretold(self) -> np.ndarray:
        """Shape (m,): whether other manoeuvres move every control of the flight, so that they predict the
        manoeuvre."""
        base = self.problem
        each = (tuple(r for r in base.records if r is not left) for left in base.records)
        others = (replace(base, records=records) for records in each)
        return np.array([all(map(r.flies, filter(base.flies, base.axis.inputs))) for r in others])


Setting = Mapping[Place, FloatArray]
"""Parameter values by their place, shape (manoeuvres,) each; an absent value is zero, as in an ideal
aircraft."""


def moved_to(setting: Setting, places: Sequence[Place], values: FloatArray) -> Setting:
    """Return the setting with k values set at k places, equal in all manoeuvres."""
    count = len(next(iter(setting.values())))
    return {**setting, **{place: np.full(count, v) for place, v in zip(places, values, strict=True)}}


def laid_out(flown: Flown, setting: Setting) -> AxisAssembly:
    """Return the records in the memory layout of the simulation kernel, under a setting.

    A servo with lag and delay alone moves exactly, and its derivative by the lag is laid out. Any other servo
    is simulated in small steps, and its deflection is the input.
    """
    axis, values = flown.axis, {place: float(each[0]) for place, each in setting.items()}
    bent = {name for name in axis.inputs if _is_bent(name, setting)}
    records = flown.problem.records
    if bent:
        records = tuple(
            replace(
                r,
                inputs={n: deflection(flown, m, n, setting) if n in bent else s for n, s in r.inputs.items()},
                before={n: s for n, s in r.before.items() if n not in bent},
            )
            for m, r in enumerate(records)
        )
        values |= {(name, entry): 0.0 for name in bent for entry in ("lag_s", "delay_s")}
    # The slope by a delay jumps where a sample lies near a command's corner: a difference passes the corner.
    causes = [(name, "lag_s") for name in axis.inputs if name not in bent]
    return lay_out(replace(flown.problem, records=records, values=values), causes)


def _is_bent(name: str, setting: Setting) -> bool:
    """Return whether a servo does more than lag behind its command, or the propeller turns the aircraft."""
    entries = {entry for (of, entry), each in setting.items() if of == name and np.any(each)}
    turned = np.any(setting.get((THROTTLE, f"{name}_rad"), 0.0))
    return bool(entries - {"lag_s", "delay_s"}) or bool(turned)


def deflection(flown: Flown, m: int, control: str, setting: Setting) -> Signal:
    """Return the deflection of a surface in record ``m``, without the delay that all commands share."""
    p = np.zeros(len(ENTRIES))
    for (of, entry), values in setting.items():
        if of == control:
            p[INDEX[entry]] = values[m]
    record = flown.problem.records[m]
    moved = _deflected(record.command(control), float(record.inputs[control].y[0]), p)
    throttle, share = flown.throttle[m], setting.get((THROTTLE, f"{control}_rad"))
    if throttle is None or share is None or share[m] == 0.0:
        return moved
    t = np.union1d(moved.t, throttle.t)
    return Signal(t, moved.at(t) + share[m] * (throttle.at(t) - throttle.y[0]))


def _deflected(command: Signal, trim: float, p: FloatArray) -> Signal:
    """Return the deflection that follows from a command; ``p`` (entries,) holds the servo's parameters."""
    late = float(p[INDEX["delay_s"]])
    if np.ptp(command.y) == 0.0:
        return Signal(command.t[[0, -1]], command.y[[0, -1]])
    if np.count_nonzero(p) == (late != 0.0):
        return Signal(command.t + late, command.y)
    begin = float(command.t[0])
    n = int(np.ceil((command.t[-1] - begin) / LONGEST_STEP_S)) + 1
    mean = surface(LONGEST_STEP_S, n, command.t - begin, command.y, False, trim, p)
    t = begin + LONGEST_STEP_S * (np.arange(n, dtype=np.float64) + 0.5)
    return Signal(t, trim + mean)
