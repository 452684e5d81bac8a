"""Search for the likeliest noise at one setting of all parameters."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from advisor.flight.signals.record import robust_std
from advisor.oem.arrow import solved_within
from advisor.oem.driven_motion.setting import Noise, Setting
from advisor.process.arrays import FloatArray

Terms = Callable[[Sequence[Noise]], tuple[FloatArray, FloatArray]]
"""Whitened residual and log variance of its innovations, both of shape (n, k), by k noises."""
MOST_MANEUVERS = 4
"""Number of the newest manoeuvres for the noise estimate. More manoeuvres would change the noise estimate
little."""
_FEW_MANEUVERS = 2
"""Numerical: number of the newest manoeuvres with which a noise search begins."""
COARSE, FINE = 20.0, 2.0
"""Numerical: decrease of -2 log likelihood by a step below which a search from one start, and the last one,
ends."""
_ROUNDS = 20
"""Numerical: largest number of steps."""
_DIFFERENCE = 0.02
"""Numerical: difference in the logarithms of the noise parameters for slopes."""
_LONGEST = 2.0
"""Numerical: longest step in a logarithm."""
_FLAT = 0.01
"""Numerical: information that is added for each logarithm, so that parameters without effect stay."""
_DAMPINGS = (0.0, 0.3, 3.0, 30.0)
"""Numerical: tried dampings of a step, as shares of the information's diagonal."""
_MOST = 0.1
"""Numerical: largest starting value of an intensity's root, SI. A state that no output shows starts from this
value.
"""


def first_noise(setting: Setting) -> Noise:
    """Return the likeliest noise, from the better of two starts."""
    few = [noise_of(setting, noise, _FEW_MANEUVERS, COARSE) for noise in _starts(setting)]
    return noise_of(setting, min(few, key=setting.cost))


def noise_of(setting: Setting, noise: Noise, newest: int = MOST_MANEUVERS, settled: float = FINE) -> Noise:
    """Return the likeliest noise near another one, by the residuals of the ``newest`` manoeuvres."""
    outputs, count = len(noise.white), len(noise.logarithms)
    free = [*setting.measured, *(outputs + setting.measured), *range(2 * outputs, count)]
    return likeliest(lambda noises: setting.terms(noises, newest), noise, free, settled)


def _starts(setting: Setting) -> Iterator[Noise]:
    """Yield the starts of the noise search: one with large jolts, and one with large gusts.

    The white noise is that of the residuals' differences.
    """
    channel, outputs = setting.assembly.channel, len(setting.assembly.names.outputs)
    white, size = np.ones(outputs), np.ones(outputs)
    for c in np.unique(channel):
        parts = [setting.residual[rows][channel[rows] == c] for rows in setting.assembly.blocks]
        size[c] = max(
            float(np.std(np.concatenate([part - part.mean() for part in parts if len(part)]))), 1e-9
        )
        white[c] = robust_std(np.concatenate([np.diff(part) for part in parts])) / 2.0**0.5
    seen, forced = np.abs(setting.records[0].motion.seen), setting.records[0].motion.forced
    measured = np.isin(np.arange(outputs), channel)
    sizes = size[measured, None] / np.maximum(seen[measured][:, forced], 1e-9)
    moved = np.min(sizes, axis=0, initial=_MOST)
    white = np.clip(white, 1e-3 * size, size)
    for jolts, gusts in ((1.0, 0.1), (0.1, 1.0)):
        yield Noise(white, 0.5 * size, 0.3, jolts * moved, gusts * float(moved[0]), 1.0)


def likeliest(terms: Terms, noise: Noise, free: Sequence[int], settled: float = FINE) -> Noise:
    """Return the likeliest noise, by Fisher scoring in the logarithms from another one.

    Innovations e with variances F have the information Σ (∂F ∂F/(2·F²) + ∂e ∂e/F). Source: Harvey,
    *Forecasting, Structural Time Series Models and the Kalman Filter*, section 3.4.

    Parameters
    ----------
    terms
        Function that returns the whitened residual and the log variance of its innovations with each noise.
    free
        Indices of the logarithms that move.
    settled
        Decrease of -2 log likelihood by a step below which the search ends.
    """
    x = noise.logarithms
    moves = _DIFFERENCE * np.vstack([np.zeros(len(x)), np.eye(len(x))[free]])
    for _ in range(_ROUNDS):
        (white, by_white), (volume, by_volume) = (
            (part[:, 0], (part[:, 1:] - part[:, :1]) / _DIFFERENCE)
            for part in terms([noise.at(x + move) for move in moves])
        )
        cost = float(np.sum(volume) + white @ white)
        gradient = by_volume.sum(axis=0) + 2.0 * by_white.T @ white
        innovation = by_white + 0.5 * white[:, None] * by_volume
        information = by_volume.T @ by_volume + 2.0 * innovation.T @ innovation
        least, most = noise.limits[:, free] - x[free]
        for damping in _DAMPINGS:
            damped = information + np.diag(damping * np.diag(information) + _FLAT)
            step = solved_within(damped, -gradient, np.maximum(least, -_LONGEST), np.minimum(most, _LONGEST))
            if damping == 0.0 and -0.5 * float(step @ gradient) < settled:
                return noise
            trial = x.copy()
            trial[free] += step
            there, volume = terms([noise.at(trial)])
            reached = float(np.sum(volume) + np.sum(there**2))
            if reached < cost:
                break
        else:
            return noise
        noise, gained, x = noise.at(trial), cost - reached, trial
        if gained < settled:
            break
    return noise
