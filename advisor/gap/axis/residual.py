"""Residual of a model: the disturbance of each block that explains most of the residual."""

from collections.abc import Mapping, Sequence

import numpy as np

from advisor.gap.axis.fit import Fit
from advisor.gap.axis.setting import Flown
from advisor.gap.inference.residual import NATURAL, Residual, shares_of
from advisor.gap.inference.with_motion import BIN_S, moving_power
from advisor.gap.noise.quiet import Probe, at_its_size, coloured_between
from advisor.oem.axis.disturbance import AIR, Course, blocks_of, courses_of
from advisor.process.arrays import FloatArray


def residual_of(fit: Fit, flown: Flown, share: float) -> Residual:
    """Return the disturbance that explains a fit's residual best, in any block except the air.

    Parameters
    ----------
    share
        Share of white noise in the residuals: one nat of white-noise likelihood counts as ``share``² nats.
    """
    noise = _white(fit)
    linear = fit.linear(flown)
    probes = [_probe(fit, block, courses_of(linear, block), noise) for block in blocks_of(linear)]
    probes.sort(key=lambda probe: -probe.gain)
    peaks = _peaks(fit)
    motions = [_motion(fit, m, peaks) for m in range(fit.assembly.maneuvers)]
    powers = [(_moving(fit, k, motions), (NATURAL * peak) ** 2) for k, peak in peaks.items()]
    (power, error, freedom), unit = max(powers, key=lambda it: it[0][0] / it[1])
    by_air = next((probe.explained for probe in probes if probe.block == AIR), 0.0)
    most = probes[0].explained
    size, beside = (float(np.sqrt(part * power / unit)) for part in (most, max(most - by_air, 0.0)))
    named = [probe for probe in probes if probe.block != AIR]
    blocks = shares_of([probe.block for probe in named], [share**2 * probe.gain for probe in named])
    return Residual(size, blocks, beside, most * error / unit, freedom)


def noise_at_rest(fit: Fit) -> FloatArray:
    """Return the root mean square residual of each output without the part that grows with the motion.

    Shape (outputs,), SI. Moving air acts at rest as in motion. Too few manoeuvres tell no part apart, and the
    noise is zero.
    """
    peaks = _peaks(fit)
    motions = [_motion(fit, m, peaks) for m in range(fit.assembly.maneuvers)]
    noise = np.zeros_like(fit.noise)
    for k in peaks:
        power, _, freedom = _moving(fit, k, motions)
        mean = float(np.mean(fit.residual[fit.assembly.channel == k] ** 2))
        noise[k] = np.sqrt(max(mean - power, 0.0)) if freedom else 0.0
    return noise


def _peaks(fit: Fit) -> Mapping[int, float]:
    """Return half the range of each measured output, by the output's index."""
    z, channel = fit.assembly.z, fit.assembly.channel
    return {int(k): max(float(np.ptp(z[channel == k])) / 2.0, 1e-12) for k in np.unique(channel)}


def _motion(fit: Fit, m: int, peaks: Mapping[int, float]) -> FloatArray:
    """Return the mean squares of a manoeuvre's motion, relative to the peaks, shape (channels, bins).

    A channel that the manoeuvre lacks has no motion.
    """
    moved = {}
    for rows in fit.assembly.rows[m].values():
        k, y = int(fit.assembly.channel[rows][0]), fit.fitted[rows] - np.median(fit.fitted[rows])
        moved[k] = _binned(fit, m, rows, (y / peaks[k]) ** 2)
    return np.array([moved.get(int(k), 0.0 * next(iter(moved.values()))) for k in peaks])


def _binned(fit: Fit, m: int, rows: slice, values: FloatArray) -> FloatArray:
    """Return the means of the values (n,) of one output in each bin of a manoeuvre, shape (bins,)."""
    t = fit.assembly.t[fit.assembly.blocks[m]]
    bins = max(int((t.max() - t.min()) / BIN_S), 1)
    at = np.clip(((fit.assembly.t[rows] - t.min()) / BIN_S).astype(int), 0, bins - 1)
    count = np.bincount(at, minlength=bins)
    return np.asarray(np.bincount(at, values, minlength=bins) / np.maximum(count, 1))


def _moving(fit: Fit, channel: int, motions: Sequence[FloatArray]) -> tuple[float, float, int]:
    """Return the mean square of an output's residual that grows with the motion, as ``moving_power``."""
    squares, moved = [], []
    for m, motion in enumerate(motions):
        for rows in fit.assembly.rows[m].values():
            if fit.assembly.channel[rows][0] == channel:
                squares.append(_binned(fit, m, rows, fit.residual[rows] ** 2))
                moved.append(motion)
    return moving_power(squares, moved)


def _probe(fit: Fit, block: str, courses: Sequence[Course], noise: FloatArray) -> Probe:
    """Return the disturbance of a block at its most likely size."""
    weight = 1.0 / noise[fit.assembly.channel]
    values, powers, total, unit = [], [], 0.0, 0.0
    for m, course in enumerate(courses):
        rows = fit.assembly.owner == m
        colour, columns = coloured_between(course.knots), course.columns * weight[rows, None]
        left = fit.residual[rows] * weight[rows]
        gram = colour.T @ (columns.T @ columns) @ colour
        unit = unit or float(np.sqrt(np.trace(gram) / len(left))) + 1e-300
        value, vector = np.linalg.eigh(gram / unit**2)
        values.append(np.maximum(value, 0.0))
        powers.append((vector.T @ (colour.T @ (columns.T @ left)) / unit) ** 2)
        total += float(left @ left)
    return at_its_size(block, np.hstack(values), np.hstack(powers), total)


def _white(fit: Fit) -> FloatArray:
    """Return the white noise of every output, shape (outputs,), by the second differences of its residual."""
    least = fit.assembly.axis.least
    noise = least.copy()
    for k in np.unique(fit.assembly.channel):
        parts = [
            np.diff(fit.residual[(fit.assembly.channel == k) & (fit.assembly.owner == m)], 2)
            for m in range(fit.assembly.maneuvers)
        ]
        second = np.concatenate(parts)
        noise[k] = max(float(np.sqrt(np.sum(second**2) / max(6.0 * len(second), 1.0))), least[k])
    return noise
