"""Parameters of servos, instruments and propeller in a lateral simulation.

Surfaces are those of the pitch axis: delay, lag, rate limit, play and dead band between command and
deflection (``gap.simulator.surface``). Instruments act on the outputs: skew of stamps, a scale error, an arm.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.gap.simulator.layout import ENTRIES, INDEX
from advisor.gap.simulator.surface import surface
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axes.lateral.problem import LateralAssembly, LateralProblem, LateralRecord, assemble_lateral
from advisor.oem.rows import Signal
from advisor.oem.surface import LONGEST_STEP_S, Servo
from advisor.process.arrays import FloatArray

Place = tuple[str, str]
"""Control or output, with the entry that a parameter sets: ``("aileron", "lag_s")``, ``("p", "scale")``."""
COMMAND = ("command", "delay_s")
PROPELLER = ("throttle", "aileron_rad")
AIR_SPEED = ("air", "scale")
"""Place of the air speed's scale error: the relative excess of the true over the read air speed."""
ANGLE_OF_ATTACK = ("air", "alpha_rad")
"""Place of the excess of the true over the read angle of attack."""


@dataclass(frozen=True, slots=True)
class Flown:
    """Lateral records of a flight, prepared for the comparison with the simulator."""

    problem: LateralProblem
    """Records with the instruments of the aircraft file; the servos are part of a ``Setting``."""
    throttle: tuple[Signal | None, ...]
    """Throttle of each record, 0..1; None where it was not recorded."""
    arm_is_stated: bool = False
    """Whether the aircraft file states the place of the sideslip vane."""

    def __len__(self) -> int:
        return len(self.problem.records)

    @property
    def foretold(self) -> np.ndarray:
        """Shape (m,): whether other manoeuvres move every control of the flight, so that they predict the
        manoeuvre."""
        base = self.problem
        each = (tuple(r for r in base.records if r is not left) for left in base.records)
        others = (replace(base, records=records) for records in each)
        return np.array([all(map(r.flies, filter(base.flies, LATERAL.inputs))) for r in others])


Setting = Mapping[Place, FloatArray]
"""Parameter values by their place, shape (manoeuvres,) each; an absent value is zero, as in an ideal
aircraft."""


def moved_to(setting: Setting, places: Sequence[Place], values: FloatArray) -> Setting:
    """Return the setting with k values set at k places, equal in all manoeuvres."""
    count = len(next(iter(setting.values())))
    return {**setting, **{place: np.full(count, v) for place, v in zip(places, values, strict=True)}}


def laid_out(flown: Flown, setting: Setting) -> LateralAssembly:
    """Return the records in the memory layout of the simulation kernel, under a setting."""

    def whole(place: Place) -> float:
        return float(setting[place][0]) if place in setting else 0.0

    base = flown.problem
    problem = replace(
        base,
        airspeed_excess=whole(AIR_SPEED),
        alpha_excess_rad=whole(ANGLE_OF_ATTACK),
        records=tuple(_driven(flown, m, setting) for m in range(len(flown))),
        servos={name: Servo() for name in LATERAL.inputs},
        command_delay_s=whole(COMMAND),
        delays_s={name: whole((name, "skew_s")) for name in LATERAL.outputs},
        beta_arm_m=base.beta_arm_m + whole(("beta", "arm_m")),
        accelerometer_arm_m=base.accelerometer_arm_m + whole(("a_y", "arm_m")),
    )
    assembly = assemble_lateral(problem, causes=())
    scale = np.array([1.0 + whole((name, "scale")) for name in LATERAL.outputs])
    return replace(assembly, grid=assembly.grid._replace(scale=scale))


def _driven(flown: Flown, m: int, setting: Setting) -> LateralRecord:
    """Return record ``m`` with the deflections of its surfaces as inputs instead of the commands."""
    record = flown.problem.records[m]
    moved = {name: deflection(flown, m, name, setting) for name in record.inputs}
    return replace(record, inputs=moved, before={})


def deflection(flown: Flown, m: int, control: str, setting: Setting) -> Signal:
    """Return the deflection of a surface in record ``m``, without the delay that all commands share."""
    p = np.zeros(len(ENTRIES))
    for (of, entry), values in setting.items():
        if of == control:
            p[INDEX[entry]] = values[m]
    record = flown.problem.records[m]
    moved = _deflected(record.command(control), float(record.inputs[control].y[0]), p)
    throttle, share = flown.throttle[m], setting.get(PROPELLER)
    if throttle is None or share is None or control != "aileron" or share[m] == 0.0:
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
