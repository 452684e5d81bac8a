"""Variation of the air speed: the cost of ignoring it, and when it is the cause of a gap.

The air speed varies in every flight, because a manoeuvre exchanges it for height. A simulator with the
measured speed knows that. The variation is a cause only where thrust did uncommanded work: it varies while
the throttle rests, as accelerations along the path show. Without these or the throttle in the log, the energy
V²/2 + g h must have varied as much as the speed. Measured accelerations must then show that work too, beyond
drag. For a small variation they must be measured, and the air must be still.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.signals.messages import FloatArray
from advisor.gap.fitting.fit import EffectFit, fit
from advisor.gap.fitting.holdout import HeldOut, hold_out
from advisor.gap.fitting.measure import whole_gap
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.records.flights import SPEED_CHANGE, PreparedManeuvers
from advisor.gap.result import Cause, Value
from advisor.gap.search.air import MovingAir
from advisor.gap.search.path_energy import (
    energy_speed,
    energy_swing,
    mean_speed,
    measures_path_acceleration,
    uncommanded_thrust,
)
from advisor.gap.simulator.layout import SPEED

_COSTS = 0.05
"""Least gap of a simulator at constant speed for a step of the waterfall."""
_IS_CAUSE = 1.0
"""Least gap of a simulator at constant speed for which the variation may be the cause."""
_WORK = 0.02
"""Least standard deviation of the speed from energy alone, relative to the mean speed, that shows work."""
_LITTLE_WORK = 0.009
"""Least such standard deviation where accelerations were measured and the air is still."""
_CLEAR_WORK = 0.03
"""Most work that the accelerations must show, as relative standard deviation of the speed: a thrust that
varies for long passes for drag in part."""
_EXCHANGED = 0.9
"""Least ratio of the energy's standard deviation to the speed's. Below it most speed was exchanged for
height."""
_UNCOMMANDED = 0.002 * GRAVITY_M_S2
"""Least uncommanded thrust that is a cause, m/s². Drag and engines beyond simple laws stay below it: 0.012
m/s² in 270 flights of nine simulators without an effect."""
_UNCOMMANDED_SWING = 0.006
"""Least relative standard deviation of the speed for an uncommanded thrust."""
_UNCOMMANDED_GUSTS = 1.5
"""Least ratio of the speed's standard deviation to that of the gust angle, for an uncommanded thrust."""
_UNCOMMANDED_COSTS = 0.3
"""Least gap of a simulator at constant speed for an uncommanded thrust."""
_GUSTS = 4.0
"""Least ratio of the variation of speed, or of the work felt, and of energy to the gust angle. An air speed
indicator reads gusts too."""


def at_constant_speed(
    problem: EffectProblem, fitted: EffectFit, folds: Sequence[Sequence[int]] | None = None
) -> HeldOut | None:
    """Return the hold-out of the model with derivatives that do not scale with the air speed, refitted.

    None where the speed hardly varies, or was not measured. ``folds`` are those of ``hold_out``.
    """
    flights = problem.flights
    if flights.speed_moves < SPEED_CHANGE:
        return None
    constant = tuple(f.at_constant_speed() for f in flights.flights)
    frozen = replace(problem, flights=replace(flights, flights=constant))
    return hold_out(frozen, fit(frozen, fitted.point, fitted.noise, iterations=4), folds)


def airspeed_cause(
    problem: EffectProblem, constant: HeldOut | None, last: HeldOut, floor: FloatArray
) -> Cause | None:
    """Return the variation of air speed as a cause where ignoring it costs; its probability is set later."""
    if constant is None or speed_costs(constant, last, floor) < _COSTS:
        return None
    return Cause(
        "airspeed_variation", "force_equation", 0.0,
        {"change": Value(problem.flights.speed_moves, 0.01)}, (), "",
        whole_gap(last.mean_square, floor), True,
    )  # fmt: skip


def speed_costs(constant: HeldOut, last: HeldOut, floor: FloatArray) -> float:
    """Return the gap of a simulator at constant speed beyond that at the measured speed."""
    return float(np.mean((constant.mean_square - last.mean_square) / floor**2))


def speed_is_a_cause(
    problem: EffectProblem, constant: HeldOut | None, last: HeldOut, floor: FloatArray, air: MovingAir | None
) -> bool:
    """Return whether work that gusts cannot explain varied the speed, and whether it matters.

    A speed that was not logged is a cause wherever it matters, because no simulator was given it.
    """
    if constant is not None and not problem.flights.speed_measured:
        return speed_costs(constant, last, floor) > _COSTS
    if constant is None or "height" not in problem.flights.has or (air is not None and air.gust):
        return False
    if "throttle" in problem.flights.has and measures_path_acceleration(problem.flights):
        return thrust_is_uncommanded(problem, constant, last, floor, air)
    speed, energy = swings(problem.flights)
    gusts = 0.0 if air is None else air.angle_std
    least = max(_EXCHANGED * speed, _LITTLE_WORK)
    energy_felt = energy_swing(problem.flights)
    worked = energy > least and (energy_felt is None or energy_felt > min(least, _CLEAR_WORK))
    clear = energy > _WORK or (energy_felt is not None and air is None)
    # An air speed indicator reads gusts; accelerometers along the path do not.
    felt_more = min(max(speed, energy_felt or 0.0), energy) > _GUSTS * gusts
    return worked and clear and felt_more and speed_costs(constant, last, floor) > _IS_CAUSE


def thrust_is_uncommanded(
    problem: EffectProblem, constant: HeldOut | None, last: HeldOut, floor: FloatArray, air: MovingAir | None
) -> bool:
    """Return whether a thrust that neither throttle nor drag explains varies the speed, and whether it
    matters."""
    flights = problem.flights
    if constant is None or not flights.speed_measured or (air is not None and air.gust):
        return False
    if "throttle" not in flights.has or speed_costs(constant, last, floor) < _UNCOMMANDED_COSTS:
        return False
    thrust = uncommanded_thrust(flights)
    if thrust is None or thrust < _UNCOMMANDED:
        return False
    gusts = 0.0 if air is None else air.angle_std
    return swings(flights)[0] > max(_UNCOMMANDED_SWING, _UNCOMMANDED_GUSTS * gusts)


def swings(flights: PreparedManeuvers) -> tuple[float, float]:
    """Return the standard deviations of the speed and of √(V² + 2 g h) in a manoeuvre, relative to the mean
    speed.

    Medians over the manoeuvres: a manoeuvre with a steady climb or descent does not count as a change of
    speed.
    """
    speeds, energies = [], []
    for flight in flights.flights:
        speeds.append(float(np.std(flight.slow[SPEED])))
        energies.append(float(np.std(energy_speed(flight))))
    mean = mean_speed(flights)
    return float(np.median(speeds)) / mean, float(np.median(energies)) / mean
