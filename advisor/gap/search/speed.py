"""Variation of the air speed: the cost of ignoring it, and when it is the cause of a gap.

The air speed varies in every flight, because a manoeuvre exchanges it for height. A simulator with the
measured speed knows that. The variation is a cause only where thrust did uncommanded work: it varies while
the throttle rests, as accelerations along the path show. Without these or the throttle in the log, the energy
V²/2 + g h must have varied.
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
from advisor.gap.result import VISIBLE, Cause, Value
from advisor.gap.search.air import MovingAir
from advisor.gap.search.path_energy import (
    energy_speed,
    mean_speed,
    measures_path_acceleration,
    uncommanded_thrust,
)

_COSTS = 0.3
"""Least gap of a simulator at constant speed for which a varying speed is the cause."""
_WORK = 0.02
"""Least standard deviation of the speed from energy alone, relative to the mean speed, that shows work."""
_UNCOMMANDED = 0.002 * GRAVITY_M_S2
"""Least uncommanded thrust that is a cause, m/s². Drag and engines beyond simple laws stay below it: 0.012
m/s² in 270 flights of nine simulators without an effect."""
_GUSTS = 4.0
"""Least ratio of the variation of energy to the gust angle. An air speed indicator reads gusts, which are no
work."""


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
    if constant is None or speed_costs(constant, last, floor) < VISIBLE:
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
        return speed_costs(constant, last, floor) > VISIBLE
    if constant is None or "height" not in problem.flights.has or (air is not None and air.gust):
        return False
    if "throttle" in problem.flights.has and measures_path_acceleration(problem.flights):
        return thrust_is_uncommanded(problem, constant, last, floor, air)
    gusts = 0.0 if air is None else air.angle_std
    worked = energy_swing(problem.flights) > max(_WORK, _GUSTS * gusts)
    return worked and speed_costs(constant, last, floor) > _COSTS


def thrust_is_uncommanded(
    problem: EffectProblem, constant: HeldOut | None, last: HeldOut, floor: FloatArray, air: MovingAir | None
) -> bool:
    """Return whether a thrust that neither throttle nor drag explains varies the speed, and whether it
    matters."""
    flights = problem.flights
    if constant is None or not flights.speed_measured or (air is not None and air.gust):
        return False
    if "throttle" not in flights.has or speed_costs(constant, last, floor) < _COSTS:
        return False
    thrust = uncommanded_thrust(flights)
    return thrust is not None and thrust >= _UNCOMMANDED


def energy_swing(flights: PreparedManeuvers) -> float:
    """Return the standard deviation of √(V² + 2 g h) in a manoeuvre, relative to the mean speed.

    It is the median over the manoeuvres: a manoeuvre with a steady climb or descent does not count.
    """
    swings = [np.std(energy_speed(flight)) for flight in flights.flights]
    return float(np.median(swings)) / mean_speed(flights)
