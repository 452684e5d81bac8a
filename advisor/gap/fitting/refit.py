"""A model with given shared parameters, in which only the nuisance parameters of each manoeuvre are refitted.

Even a model that fits badly gets initial states that an aircraft can have. Each nuisance parameter keeps
within the range of real flights and instruments.
"""

from dataclasses import dataclass, replace

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.gap.fitting.holdout import HeldOut, held_out
from advisor.gap.fitting.linear import Linear, linearise
from advisor.gap.fitting.problem import EffectProblem, SearchPoint
from advisor.gap.records.flights import PreparedManeuver
from advisor.gap.simulator.layout import DERIVATIVES, NUISANCES, SPEED
from advisor.oem.arrow import solved_within
from advisor.process.arrays import FloatArray

_ROUNDS = 4
"""Numerical: number of Gauss-Newton steps from each starting value. The outputs are nearly linear in the
nuisance parameters."""
_ALPHA_RAD, _Q_RAD_S = 0.1, 0.2
"""Prior: largest departure of α (rad) and q (rad/s) from steady flight at a record's start. A test input
begins from trim, and most responses to a whole input are no larger than 6 deg and 11 deg/s."""
_LOAD = 0.3
"""Prior: largest departure of the load factor from 1 at the start, as in a turn with 40 deg of bank."""
_ELEVATOR_RAD = 0.1
"""Prior: largest trim moment, as the deflection that balances it, rad: a quarter of 25 deg of travel."""
_OFFSETS = {"a_z": 1.0, "theta": 0.05}
"""Prior: largest offset of an accelerometer, m/s² (a tenth of the weight), and of an attitude, rad (3 deg). A
calibrated and levelled autopilot has smaller offsets."""


@dataclass(frozen=True)
class _Refitted:
    """Best nuisance parameters of one manoeuvre so far."""

    cost: float
    own: FloatArray
    residual: FloatArray


def own_refitted(problem: EffectProblem, point: SearchPoint, noise: FloatArray) -> HeldOut:
    """Return the residuals of a model with given shared parameters, with only nuisance parameters refitted.

    The search starts at the point's nuisance parameters and at steady flight, and keeps the better result.
    ``noise``, shape (channels,), weighs the channels.
    """
    flights = problem.flights.flights
    ranges = [_range_of(flight, point.derivatives) for flight in flights]
    best: list[_Refitted | None] = [None] * len(flights)
    for start in (point.own, np.array([_steady(flight) for flight in flights])):
        own = np.array([np.clip(x, *ends) for x, ends in zip(start, ranges, strict=True)])
        for _ in range(_ROUNDS):
            linear = linearise(problem, replace(point, own=own, edges=None), shared=False)
            for i, block in enumerate(linear):
                here, step = _refitted(problem, block, own[i], ranges[i], 1.0 / noise)
                earlier = best[i]
                if earlier is None or here.cost < earlier.cost:
                    best[i], own[i] = here, own[i] + step
                else:
                    own[i] = 0.5 * (own[i] + earlier.own)
    return held_out(problem, [refit.residual for refit in best if refit is not None])


def _refitted(
    problem: EffectProblem,
    block: Linear,
    own: FloatArray,
    ends: tuple[FloatArray, FloatArray],
    weights: FloatArray,
) -> tuple[_Refitted, FloatArray]:
    """Return the residual at a manoeuvre's initial state and trim, and their next step, shape (4,)."""
    m, k = block.m, len(own)
    normal = np.tensordot(weights**2, block.products, 1)
    H, g = normal[:m, :m] + np.diag(block.prior), normal[:m, -1] + block.prior * block.departure
    # A prior of a manoeuvre's own is the variance of a range, as of an edge anywhere between two stamps.
    reach = np.sqrt(3.0 / np.maximum(block.prior, 1e-300))
    offsets = [_OFFSETS[name] for name in _OFFSETS if name in problem.channels]
    reach[k : k + len(offsets)] = offsets
    held = np.concatenate([np.zeros(k), reach[k:]])
    still = solved_within(H, g, -held, held)
    moved = solved_within(
        H, g, np.concatenate([ends[0] - own, -reach[k:]]), np.concatenate([ends[1] - own, reach[k:]])
    )
    unlikely = float(block.prior @ block.departure**2)
    cost = float(normal[-1, -1] - 2.0 * g @ still + still @ H @ still) + unlikely
    unmoved = np.zeros(block.columns.shape[1] - m - 1)
    return _Refitted(cost, own.copy(), block.measured.after(unmoved, still)), moved[:k]


def _steady(flight: PreparedManeuver) -> FloatArray:
    """Return the initial state and the trim of steady flight, shape (4,)."""
    own = np.zeros(len(NUISANCES))
    own[NUISANCES.index("Z_trim")] = flight.level_lift
    return own


def _range_of(flight: PreparedManeuver, derivatives: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the lower and upper ends of a manoeuvre's initial state and trim, each of shape (4,)."""
    turning = _LOAD * GRAVITY_M_S2 / float(np.mean(flight.slow[SPEED]))
    moment = _ELEVATOR_RAD * abs(float(derivatives[DERIVATIVES.index("M_delta_e")]))
    width = np.array([_ALPHA_RAD, _Q_RAD_S, turning, moment])
    middle = _steady(flight)
    return middle - width, middle + width
