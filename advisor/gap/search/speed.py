"""The change of air speed: what ignoring it costs, and when it is the cause of a gap.

The air speed swings in every flight, for a manoeuvre exchanges it for height. A simulator that is given the
measured speed knows that; so it is a cause only where work was done on the aircraft that nobody asked for,
by a thrust that swings while the throttle rests: accelerations along the path show it. Where these or the
throttle were not logged, the energy V²/2 + g h must have moved as much as the speed, and accelerations that
were measured must show that work, too, beyond what drag takes. Where it moved by little, they must have been
measured, and the air must be still.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.fitting.fit import Fitted, fit
from advisor.gap.fitting.holdout import HeldOut, hold_out
from advisor.gap.fitting.measure import whole_gap
from advisor.gap.fitting.problem import Problem
from advisor.gap.records.flights import SPEED_CHANGE, Flights
from advisor.gap.result import Cause, Value
from advisor.gap.search.air import Air
from advisor.gap.search.path_energy import (
    energy_speed,
    energy_swing,
    mean_speed,
    measures_path_acceleration,
    uncommanded_thrust,
)
from advisor.gap.simulator.layout import SPEED
from advisor.standard_gravity import GRAVITY_M_S2

_COSTS = 0.05
"""Gap of a simulator at constant speed from which on it is worth a step of the waterfall ..."""
_IS_CAUSE = 1.0
"""... and from which on it may be the cause."""
_WORK = 0.02
"""Standard deviation of the speed that the energy alone would make, relative, that is work ..."""
_LITTLE_WORK = 0.009
"""... or this, if accelerations were measured and the air is still ..."""
_CLEAR_WORK = 0.03
"""What the accelerations must show of it at most: thrust that swings for long passes for drag in part."""
_EXCHANGED = 0.9
"""... and if it is at least this share of the speed's own: else most was exchanged for height ..."""
_UNCOMMANDED = 0.002 * GRAVITY_M_S2
"""Thrust that nobody asked for, m/s²: what drag and engines do beyond simple laws stays below it (0.012 in
270 flights of nine simulators without an effect) ..."""
_UNCOMMANDED_SWING = 0.006
"""... if the speed swings by more than this, relative ..."""
_UNCOMMANDED_GUSTS = 1.5
"""... and than this many times the air's own motion ..."""
_UNCOMMANDED_COSTS = 0.3
"""... and a simulator at constant speed leaves this much: the cause is plain."""
_GUSTS = 4.0
"""... and both, or energy and what the accelerations show, exceed this many times the air's own motion: an
air speed indicator reads that, too."""


def at_constant_speed(
    problem: Problem, fitted: Fitted, folds: Sequence[Sequence[int]] | None = None
) -> HeldOut | None:
    """What the model leaves when derivatives do not move with the air speed, everything refitted.

    None where the speed hardly moves, or nothing shows it. ``folds`` as ``hold_out`` has them.
    """
    flights = problem.flights
    if flights.speed_moves < SPEED_CHANGE:
        return None
    constant = tuple(f.at_constant_speed() for f in flights.flights)
    frozen = replace(problem, flights=replace(flights, flights=constant))
    return hold_out(frozen, fit(frozen, fitted.point, fitted.noise, iterations=4), folds)


def airspeed_cause(
    problem: Problem, constant: HeldOut | None, last: HeldOut, floor: FloatArray
) -> Cause | None:
    """The change of air speed, when ignoring it would cost; its probability is decided beside the others."""
    if constant is None or speed_costs(constant, last, floor) < _COSTS:
        return None
    return Cause(
        "airspeed_variation", "force_equation", 0.0,
        {"change": Value(problem.flights.speed_moves, 0.01)}, (), "",
        whole_gap(last.mean_square, floor), True,
    )  # fmt: skip


def speed_costs(constant: HeldOut, last: HeldOut, floor: FloatArray) -> float:
    """What a simulator leaves at constant speed beyond one that knows it, mean square over the floor's."""
    return float(np.mean((constant.mean_square - last.mean_square) / floor**2))


def speed_is_a_cause(
    problem: Problem, constant: HeldOut | None, last: HeldOut, floor: FloatArray, air: Air | None
) -> bool:
    """Whether work was done on the aircraft, beyond what gusts may feign, and it matters.

    A speed that was not logged is the cause wherever it matters: no simulator was given it.
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
    problem: Problem, constant: HeldOut | None, last: HeldOut, floor: FloatArray, air: Air | None
) -> bool:
    """Whether a thrust that neither throttle nor drag accounts for swings the speed, and it matters."""
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


def swings(flights: Flights) -> tuple[float, float]:
    """How much the speed swings within a manoeuvre, and √(V² + 2 g h), both relative to the mean speed.

    Medians over the manoeuvres: one that climbs or sinks all the while is no change of speed.
    """
    speeds, energies = [], []
    for flight in flights.flights:
        speeds.append(float(np.std(flight.slow[SPEED])))
        energies.append(float(np.std(energy_speed(flight))))
    mean = mean_speed(flights)
    return float(np.median(speeds)) / mean, float(np.median(energies)) / mean
