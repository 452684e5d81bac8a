"""Moving air in a fit's residuals, distinguished from instrument noise by a Kalman filter's likelihood.

A gust enters vane, lift and moment together; instrument noise enters its own channel only. The likelihoods of
gusts and of instrument noise distinguish both (the filter is in ``innovations``).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.model.outputs import OUTPUTS
from advisor.oem import innovations
from advisor.oem.coordinate_search import coordinate_search
from advisor.oem.innovations import A_Z, ALPHA, AirModel
from advisor.oem.kalman import DIFFUSE
from advisor.process.arrays import FloatArray


@dataclass(frozen=True)
class Rows:
    """Residuals of one manoeuvre in order of time."""

    t: FloatArray
    channel: np.ndarray
    """Shape (n,), int64: index of each row's output in ``model.response.OUTPUTS``."""
    residual: FloatArray
    speed: float


def cost_of(
    rows: Sequence[Rows], system: FloatArray, air: AirModel, start_variance: float = DIFFUSE
) -> float:
    """Return -2 log likelihood of residuals under an air model, summed over the manoeuvres."""
    return sum(
        innovations.cost_of(r.t, r.channel, r.residual, np.append(system, r.speed), air, start_variance)
        for r in rows
    )


KNOTS_S = 0.1
"""Numerical: distance between the knots of a disturbance, s."""
LARGEST_GUST_RAD = 0.26
"""Largest standard deviation of the gust angle, rad. Beyond 15 deg lift is not linear in α."""
_STEPS = (0.7, 0.35, 0.15)
"""Steps of the search in the logarithms of the noise parameters, from a factor of two to 1.16."""
_RANGE = (1e-12, 1e3)
"""Range of every noise parameter, SI. Without a lower bound the likelihood of data without noise has no
maximum."""
_MEMORY_GAIN = 5.0
"""Least log likelihood gain of coloured over white noise that starts a search for moving air."""


@dataclass(frozen=True)
class Turbulence:
    """Result of the search for moving air in residuals."""

    gain: float
    """Log likelihood gain of moving air over coloured instruments, nats."""
    gust_angle: float
    """Standard deviation of the gust angle w/V, rad."""
    air: AirModel
    """Likelier model of air and instruments."""

    @property
    def present(self) -> bool:
        """Whether moving air explains more than instrument noise, and exceeds 0.1 deg."""
        return self.gain > 20.0 and self.gust_angle > 0.0017 and self.is_air

    @property
    def is_air(self) -> bool:
        """Whether the gusts are small enough for a linear aircraft model; larger gusts are model errors."""
        return self.gust_angle < LARGEST_GUST_RAD


def find_turbulence(
    rows: Sequence[Rows],
    system: FloatArray,
    white: FloatArray,
    seen_by_alpha: bool,
    start_variance: float = DIFFUSE,
) -> Turbulence:
    """Return the comparison of noise models with and without moving air, fitted to residuals.

    Parameters
    ----------
    rows
        Residuals of the manoeuvres without their offsets.
    system
        Derivatives Z_α, Z_q, M_α, M_q.
    white
        Shape (4,): starting values of the white noise, SI.
    start_variance
        Variance of the initial α, q and θ of a record; 0 for residuals of a fit with estimated initial
        states.
    """

    def descend(start: AirModel, moving: bool, steps: Sequence[float] = _STEPS) -> tuple[AirModel, float]:
        return _descend(rows, system, start, moving, steps, start_variance)

    rms = spread_of(rows)
    white = np.clip(white, 1e-3 * rms + 1e-9, rms + 1e-9)
    colour = np.sqrt(np.maximum(rms**2 - white**2, (0.1 * rms) ** 2))
    still = descend(AirModel(white, colour, 0.3, 0.0, 1.0, float(seen_by_alpha)), False)
    plain = AirModel.still(rms, float(seen_by_alpha))
    if 0.5 * (cost_of(rows, system, plain, start_variance) - still[1]) < _MEMORY_GAIN:
        # Moving air is coloured: where no channel is, there is no moving air.
        return Turbulence(0.0, 0.0, still[0])
    quieter = replace(still[0], coloured=0.3 * still[0].coloured, gust_memory_s=1.0)
    angle = _residual_angle(rows, system, rms)
    begun = [
        descend(replace(quieter, gust=max(share * angle, 1e-4)), True, _STEPS[:1]) for share in (0.7, 0.2)
    ]
    nearest = min(begun, key=lambda found: found[1])[0]
    moving = descend(nearest, True, _STEPS[1:])
    gain = 0.5 * (still[1] - moving[1])
    return Turbulence(gain, moving[0].gust if gain > 0.0 else 0.0, moving[0] if gain > 0.0 else still[0])


def _residual_angle(rows: Sequence[Rows], system: FloatArray, rms: FloatArray) -> float:
    """Return the root mean square residual of the angle of attack, rad, or of the lift without α."""
    if any(np.any(r.channel == ALPHA) for r in rows):
        return float(rms[ALPHA])
    speed = float(np.mean([r.speed for r in rows]))
    return float(rms[A_Z] / max(speed * abs(system[0]), 1e-6))


def spread_of(rows: Sequence[Rows]) -> FloatArray:
    """Return the root mean square residual of each output, shape (4,); 1 for a missing output."""
    picked = [np.concatenate([r.residual[r.channel == c] for r in rows]) for c in range(len(OUTPUTS))]
    return np.array([max(float(np.sqrt(np.mean(one**2))), 1e-12) if len(one) else 1.0 for one in picked])


def _descend(
    rows: Sequence[Rows],
    system: FloatArray,
    start: AirModel,
    moving: bool,
    steps: Sequence[float],
    start_variance: float,
) -> tuple[AirModel, float]:
    """Return the minimum by a coordinate search in the logarithms of the noise parameters, with decreasing
    steps."""
    figures = [*start.white, *start.coloured, start.memory_s, start.gust, start.gust_memory_s]
    x = np.log(np.clip(figures, *_RANGE))
    free = [*range(9), 9, 10] if moving else [*range(9)]
    present = {int(c) for r in rows for c in np.unique(r.channel)}
    free = [i for i in free if i >= 8 or i % 4 in present]

    def model(y: FloatArray) -> AirModel:
        v = np.clip(np.exp(y), *_RANGE)
        return AirModel(v[:4], v[4:8], float(np.clip(v[8], 0.02, 5.0)), float(v[9]) if moving else 0.0,
                        float(np.clip(v[10], 0.05, 20.0)), start.seen_by_alpha)  # fmt: skip

    x, best = coordinate_search(lambda y: cost_of(rows, system, model(y), start_variance), x, free, steps)
    return model(x), best
