"""Gusts in the residuals of a fit, distinguished from coloured noise of the instruments.

A gust adds its angle to the incidence that wing, fin and vane meet. The residuals are innovations of the
Kalman filter of ``oem.driven_motion``, in which a gust drives the motion, and the instruments have white and
coloured noise.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from advisor.flight.signals.record import robust_std
from advisor.gap.axis.fit import Fit, Known
from advisor.gap.axis.setting import Flown
from advisor.oem.arrow import solved_within
from advisor.oem.axis.motion import AxisMotion
from advisor.oem.covariance import Weighing, colours_of
from advisor.oem.driven_motion.likeliest_noise import MOST_MANEUVERS, likeliest
from advisor.oem.driven_motion.setting import GUST, GUST_MEMORY, Noise, Setting, records_of
from advisor.process.arrays import FloatArray

_STEP = 0.1
"""Numerical: difference of the logarithm of the gusts' size for the curvature of the likelihood."""


@dataclass(frozen=True, slots=True)
class Gusts:
    """Noise of the instruments and gusts, as estimated from the residuals of a fit."""

    noise: Noise
    angle_std: float
    """Standard error of the gust angle's standard deviation, rad."""
    likelihood: float
    """Log likelihood of the residuals, on the scale of ``Fit.likelihood``."""
    matrix: FloatArray
    """Shape (k, k): information about derivatives and effect parameters in the innovations."""
    gradient: FloatArray
    """Shape (k,): gradient of the log likelihood at the fit."""

    @property
    def angle(self) -> float:
        """Standard deviation of the gust's angle, rad."""
        return self.noise.gust

    def change(self, prior: Known, fit: Fit) -> FloatArray:
        """Return the change (k,) from the fit to the optimum with gusts and prior, within the bounds."""
        low, high = fit.bounds
        pull = self.gradient + prior.precision * (prior.mean - fit.values)
        whole = self.matrix + np.diag(prior.precision)
        return solved_within(whole, pull, low - fit.values, high - fit.values)

    def height(self, prior: Known, fit: Fit) -> float:
        """Return the log posterior density of the fit with these gusts, up to a constant."""
        return self.likelihood - 0.5 * float(prior.precision @ (fit.values - prior.mean) ** 2)

    def at(self, fit: Fit, flown: Flown) -> "Gusts":
        """Return gusts with unchanged statistics, with the likelihood and its slopes at another fit."""
        setting = _setting(fit, flown)
        own = setting.sensitivities[:, setting.assembly.own]
        n = len(setting.shared)
        common = np.column_stack([setting.sensitivities[:, :n], fit.slopes])
        common[:, [k for k in range(n) if k not in setting.assembly.free]] = 0.0
        white, volume = setting.whitened(np.column_stack([setting.residual, common, own]), self.noise)
        inner = np.zeros((common.shape[1] + 1,) * 2)
        for rows in setting.assembly.blocks:
            left, mine = np.split(white[rows], [common.shape[1] + 1], axis=1)
            left = left - mine @ np.linalg.lstsq(mine, left, rcond=None)[0]
            inner += left.T @ left
        likelihood = -0.5 * (volume + float(inner[0, 0]) - len(white))
        return replace(self, likelihood=likelihood, matrix=inner[1:, 1:], gradient=inner[1:, 0])


def gusts_of(fit: Fit, flown: Flown) -> Gusts:
    """Return the likeliest noise and gusts in the residuals of a fit, by its newest manoeuvres."""
    setting = _setting(fit, flown)
    begin = _begin(setting)
    outputs, count = len(begin.white), len(begin.logarithms)
    free = [*setting.measured, *(outputs + setting.measured), *range(count + GUST, count)]
    noise = likeliest(partial(_terms, setting), begin, free)
    return Gusts(noise, _size_std(setting, noise), np.nan, *np.empty((2, 0, 0))).at(fit, flown)


def _size_std(setting: Setting, noise: Noise) -> float:
    """Return the standard error of the gusts' size, rad, with their memory free within its range."""
    x, moves = noise.logarithms, _STEP * np.eye(len(noise.logarithms))[[GUST, GUST_MEMORY]]

    def nats(size: float, memory: float) -> float:
        return 0.5 * _cost(setting, noise.at(x + size * moves[0] + memory * moves[1]))

    middle = nats(0.0, 0.0)
    size, memory = (nats(a, b) + nats(-a, -b) - 2.0 * middle for a, b in ((1.0, 0.0), (0.0, 1.0)))
    mixed = 0.5 * (nats(1.0, 1.0) + nats(-1.0, -1.0) - size - memory - 2.0 * middle)
    # A flat likelihood leaves the memory anywhere in its range, and the size anywhere within a factor.
    range_of_memory = float(np.ptp(noise.limits[:, GUST_MEMORY]))
    bend = size - mixed**2 / max(memory, 12.0 * _STEP**2 / range_of_memory**2)
    return float(noise.gust * min(_STEP / max(bend, 1e-300) ** 0.5, 1.0))


def _terms(setting: Setting, noises: Sequence[Noise]) -> tuple[FloatArray, FloatArray]:
    """Return the whitened residual and the log variance of its innovations with each noise, (n, k) both.

    Trims and initial states absorb a part of the residual, which is left out.
    """
    columns = np.column_stack([setting.residual, setting.sensitivities[:, setting.assembly.own]])
    records = setting.records[-MOST_MANEUVERS:]
    rows = [columns[record.order] for record in records]
    each = [[setting.gains(record, noise) for record in records] for noise in noises]
    pairs = ([(_alone(g.innovations(y)), g.std) for g, y in zip(gains, rows, strict=True)] for gains in each)
    parts = [tuple(map(np.concatenate, zip(*parts, strict=True))) for parts in pairs]
    white, std = (np.column_stack(part) for part in zip(*parts, strict=True))
    return white, 2.0 * np.log(std)


def _alone(white: FloatArray) -> FloatArray:
    """Return the first column (n,) of a manoeuvre's rows without what its other columns absorb."""
    left, own = white[:, 0], white[:, 1:]
    return np.asarray(left - own @ np.linalg.lstsq(own, left, rcond=None)[0])


def _cost(setting: Setting, noise: Noise) -> float:
    white, volume = _terms(setting, [noise])
    return float(np.sum(volume) + np.sum(white**2))


def coloured_likelihood(fit: Fit) -> float:
    """Return the residuals' log likelihood with coloured noise in each instrument, on the scale of
    ``Fit.likelihood``."""
    colours = colours_of(fit.assembly, fit.residual, np.ones_like(fit.sensitivities))
    weighing = Weighing.by(colours, fit.assembly)
    own = fit.sensitivities[:, fit.assembly.own]
    white = weighing.forward(np.column_stack([fit.residual, own]))
    power = sum(float(np.sum(_alone(white[rows]) ** 2)) for rows in fit.assembly.blocks)
    return -0.5 * (weighing.volume + power - len(fit.fitted))


def _setting(fit: Fit, flown: Flown) -> Setting:
    """Return the fit with its linear motions, as the filter takes it."""
    laid, (derivatives, local, numbers) = fit.assembly, fit.point
    values = {place: float(each[0]) for place, each in numbers.items()}
    problem = replace(flown.problem, values=values)
    records, measured = records_of(AxisMotion(flown.axis), problem, laid, derivatives)
    floor = laid.least
    return Setting(
        problem, laid, derivatives, local, fit.residual, fit.sensitivities,
        lambda: fit.slopes, (), records, measured, floor,
    )  # fmt: skip


def _begin(setting: Setting) -> Noise:
    """Return the begin of the noise search: white noise by the residuals' differences, the rest half of
    coloured instruments and half of gusts."""
    channel, outputs = setting.assembly.channel, len(setting.floor)
    white, size = np.ones(outputs), np.ones(outputs)
    for c in setting.measured:
        parts = [setting.residual[rows][channel[rows] == c] for rows in setting.assembly.blocks]
        white[c] = max(robust_std(np.concatenate([np.diff(part) for part in parts])) / 2.0**0.5, 1e-9)
        size[c] = max(float(np.std(np.concatenate([part - part.mean() for part in parts]))), 1e-9)
    shown = np.abs(setting.records[0].motion.air_seen)
    moved = min((size[c] / shown[c] for c in setting.measured if shown[c] > 0.0), default=1e-3)
    still = Noise.still(np.clip(white, 1e-3 * size, size))
    return replace(still, coloured=0.5 * size, gust=0.5 * float(moved))
