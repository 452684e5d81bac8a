"""Moving air in a fit's residuals, distinguished from instrument noise by a Kalman filter's likelihood.

A gust enters vane, lift and moment together; instrument noise enters its own channel only. The likelihoods of
gusts and of instrument noise distinguish both (the filter is in ``driven_motion``).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from advisor.model.outputs import OUTPUTS
from advisor.oem.driven_motion.kalman_filter import filtered_by_each, steps_of
from advisor.oem.driven_motion.likeliest_noise import COARSE, FINE, likeliest
from advisor.oem.driven_motion.setting import GUST, GUST_MEMORY, MEMORY, Linear, Noise
from advisor.process.arrays import FloatArray, IntArray

ALPHA, A_Z = OUTPUTS.index("alpha"), OUTPUTS.index("a_z")
DIFFUSE = 1e3
"""Variance of an unknown initial motion, far above any motion in SI units."""


@dataclass(frozen=True)
class Rows:
    """Residuals of one manoeuvre in order of time."""

    t: FloatArray
    channel: IntArray
    """Shape (n,): index of each row's output in ``model.response.OUTPUTS``."""
    residual: FloatArray
    motion: Linear
    """Linear motion about the fitted one."""

    @cached_property
    def steps(self) -> tuple[FloatArray, IntArray]:
        """Distinct time steps, s, and the index of the step before each row."""
        return steps_of(self.t)

    def terms(self, noises: Sequence[Noise], start_variance: float) -> tuple[FloatArray, FloatArray]:
        """Return the whitened residual and the log variance of its innovations with each noise, (n, k) both.

        Both are 0 for rows that are still diffuse.
        """
        motion = self.motion
        driving = [noise.driving(motion, start_variance) for noise in noises]
        white, coloured = np.array([(noise.white, noise.coloured) for noise in noises]).swapaxes(0, 1)
        at, memory_s = (self.steps, self.channel, motion.all_seen), np.array([n.memory_s for n in noises])
        white, std = filtered_by_each(*at, driving, white**2, coloured, memory_s, self.residual)
        decided = std**2 < 0.1 * DIFFUSE
        return np.where(decided, white, 0.0), np.where(decided, 2.0 * np.log(std), 0.0)


def terms_of(
    rows: Sequence[Rows], noises: Sequence[Noise], start_variance: float = DIFFUSE
) -> tuple[FloatArray, FloatArray]:
    """Return the whitened residuals of manoeuvres and the log variances of their innovations, (n, k) both."""
    white, volume = np.concatenate([part.terms(noises, start_variance) for part in rows], axis=1)
    return white, volume


def cost_of(rows: Sequence[Rows], noise: Noise, start_variance: float = DIFFUSE) -> float:
    """Return -2 log likelihood of residuals, summed over the manoeuvres, up to a constant."""
    white, volume = terms_of(rows, [noise], start_variance)
    return float(np.sum(volume) + np.sum(white**2))


KNOTS_S = 0.1
"""Numerical: distance between the knots of a disturbance, s."""
LARGEST_GUST_RAD = 0.26
"""Largest standard deviation of the gust angle, rad. Beyond 15 deg lift is not linear in α."""
_MEMORY_GAIN = 5.0
"""Least log likelihood gain of coloured over white noise that starts a search for moving air."""


@dataclass(frozen=True)
class Turbulence:
    """Result of the search for moving air in residuals."""

    gain: float
    """Log likelihood gain of moving air over coloured instruments, nats."""
    gust_angle: float
    """Standard deviation of the gust angle w/V, rad."""
    noise: Noise
    """Likelier model of air and instruments."""

    @property
    def is_air(self) -> bool:
        """Whether the gusts are small enough for a linear aircraft model; larger gusts are model errors."""
        return self.gust_angle < LARGEST_GUST_RAD


def find_turbulence(rows: Sequence[Rows], white: FloatArray, start_variance: float = DIFFUSE) -> Turbulence:
    """Return the comparison of noise models with and without moving air, fitted to residuals.

    Parameters
    ----------
    rows
        Residuals of the manoeuvres without their offsets.
    white
        Shape (4,): starting values of the white noise, SI.
    start_variance
        Variance of the initial α, q and θ of a record; 0 for residuals of a fit with estimated initial
        states.
    """
    there = sorted({int(c) for r in rows for c in np.unique(r.channel)})
    instruments = [*there, *(len(white) + c for c in there), MEMORY]

    def descend(start: Noise, free: Sequence[int], settled: float = FINE) -> tuple[Noise, float]:
        noise = likeliest(lambda noises: terms_of(rows, noises, start_variance), start, free, settled)
        return noise, cost_of(rows, noise, start_variance)

    rms = spread_of(rows)
    white = np.clip(white, 1e-3 * rms + 1e-9, rms + 1e-9)
    colour = np.sqrt(np.maximum(rms**2 - white**2, (0.1 * rms) ** 2))
    still = descend(replace(Noise.still(white), coloured=colour), instruments)
    if 0.5 * (cost_of(rows, Noise.still(rms), start_variance) - still[1]) < _MEMORY_GAIN:
        # Moving air is coloured: where no channel is, there is no moving air.
        return Turbulence(0.0, 0.0, still[0])
    quieter, angle = replace(still[0], coloured=0.3 * still[0].coloured), _residual_angle(rows, rms)
    every = [*instruments, GUST, GUST_MEMORY]
    begun = [descend(replace(quieter, gust=max(share * angle, 1e-4)), every, COARSE) for share in (0.7, 0.2)]
    moving = descend(min(begun, key=lambda trial: trial[1])[0], every)
    gain = 0.5 * (still[1] - moving[1])
    return Turbulence(gain, moving[0].gust if gain > 0.0 else 0.0, moving[0] if gain > 0.0 else still[0])


def _residual_angle(rows: Sequence[Rows], rms: FloatArray) -> float:
    """Return the root mean square residual of the angle of attack, rad, or of the lift without α."""
    if any(np.any(r.channel == ALPHA) for r in rows):
        return float(rms[ALPHA])
    return float(rms[A_Z] / max(abs(np.mean([r.motion.seen[A_Z, 0] for r in rows])), 1e-6))


def spread_of(rows: Sequence[Rows]) -> FloatArray:
    """Return the root mean square residual of each output, shape (4,); 1 for a missing output."""
    picked = [np.concatenate([r.residual[r.channel == c] for r in rows]) for c in range(len(OUTPUTS))]
    return np.array([max(float(np.sqrt(np.mean(r**2))), 1e-12) if len(r) else 1.0 for r in picked])
