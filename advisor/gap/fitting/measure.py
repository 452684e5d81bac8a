"""The gap in numbers: by channel, manoeuvre, phase and frequency band."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from advisor.gap.fitting.fit import EffectFit, power_of
from advisor.gap.fitting.holdout import HeldOut
from advisor.gap.fitting.natural import with_natural
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.fitting.refit import own_refitted
from advisor.gap.records.flights import PreparedManeuver
from advisor.gap.result import Gap, Shrink
from advisor.process.arrays import FloatArray

_BANDS_HZ = ((0.0, 0.5), (0.5, 1.0), (1.0, 2.0), (2.0, 4.0), (4.0, 10.0))
"""Words: limits of the frequency bands in Hz. The short period lies in the middle bands, drift of the trim
below, structure and noise above."""
_EDGE_S = 0.2
"""Words: time in s after a step of the command that belongs to the step's edge."""
PHASES = ("step edge", "plateau", "free response")


def gap_of(mean_square: FloatArray, floor: FloatArray) -> FloatArray:
    """Return the gap of each channel: mean square error over the squared noise floor, minus 1, at least 0."""
    return np.maximum(mean_square / floor**2 - 1.0, 0.0)


def whole_gap(mean_square: FloatArray, floor: FloatArray) -> float:
    """Return the mean of the gap over the channels."""
    return float(np.mean(gap_of(mean_square, floor)))


def gap_between(
    channels: Sequence[str], numbers: Sequence[int], floor: FloatArray, note: str,
    before: tuple[FloatArray, FloatArray], after: tuple[FloatArray, FloatArray],
) -> Gap:  # fmt: skip
    """Return the gap of the simulator as given and of the final model.

    Parameters
    ----------
    numbers
        Number of each manoeuvre.
    floor, note
        Standard deviation of the noise (channels,), and its source.
    before, after
        Mean squared errors over all manoeuvres, (channels,), and of each manoeuvre, (manoeuvres, channels);
        NaN where there are none.
    """
    whole = [gap_of(squares, floor) for squares, _ in (before, after)]
    each = [np.ma.masked_invalid(gap_of(squares, floor)).mean(axis=1) for _, squares in (before, after)]
    by = [dict(zip(channels, values.tolist(), strict=True)) for values in (floor, *whole)]
    by_maneuver = tuple(zip(numbers, *(gaps.filled(np.nan).tolist() for gaps in each), strict=True))
    return Gap(float(np.mean(whole[0])), float(np.mean(whole[1])), by[0], note, by[1], by[2], by_maneuver)


def shrink_between(
    gap: Gap, numbers: Sequence[int], floor: FloatArray, before: FloatArray, after: FloatArray
) -> Shrink:
    """Return the shrink of a gap on manoeuvres, with its 95 % interval by resampling.

    ``before`` and ``after`` are mean squares of shape (manoeuvres, channels).
    """
    percent = 100.0 * (1.0 - gap.after / gap.before) if gap.before > 1e-9 else 0.0
    low, high = shrink_interval(before, after, floor)
    # A long manoeuvre has more samples, and counts for more in the gap than in a draw of manoeuvres.
    return Shrink(tuple(numbers), gap.before, gap.after, percent, (min(low, percent), max(high, percent)))


def by_phase(
    problem: EffectProblem, residuals: Sequence[FloatArray], floor: FloatArray
) -> Mapping[str, float]:
    """Return the gap just after the command's steps, between the steps, and after the last step."""
    each = ((phase, *power_of(problem, residuals, partial(_inside, phase))) for phase in PHASES)
    return {phase: whole_gap(power / count, floor) for phase, power, count in each if np.all(count > 0)}


def _inside(phase: str, flight: PreparedManeuver, t: FloatArray) -> np.ndarray:
    """Return whether each stamp (n,) lies in a phase of ``PHASES``."""
    after = t > flight.last_step_s + _EDGE_S
    if phase == "free response":
        return after
    edges = flight.edges[:, 0] if len(flight.edges) else np.array([flight.first_step_s, flight.last_step_s])
    since = t[:, None] - edges
    near = np.min(np.where(since >= 0.0, since, np.inf), axis=1) < _EDGE_S
    return np.asarray((near == (phase == "step edge")) & (t >= flight.first_step_s) & ~after)


def by_band(
    problem: EffectProblem, residuals: Sequence[FloatArray]
) -> tuple[tuple[float, float, float], ...]:
    """Return the limits of each frequency band in Hz, and its share of the pitch-rate error's power."""
    if "q" not in problem.channels:
        return ()
    power = np.zeros(len(_BANDS_HZ))
    c = problem.channels.index("q")
    for flight, residual in zip(problem.flights.flights, residuals, strict=True):
        t, y = flight.outputs["q"].t, residual[problem.rows(flight)[c]]
        step = float(np.median(np.diff(t)))
        even = np.interp(np.arange(t[0], t[-1], step), t, y)
        spectrum = np.abs(np.fft.rfft(even * np.hanning(len(even)))) ** 2
        hz = np.fft.rfftfreq(len(even), step)
        power += [float(np.sum(spectrum[(hz >= a) & (hz < b)])) for a, b in _BANDS_HZ]
    total = float(np.sum(power))
    return tuple(
        (a, b, float(s / total) if total > 0 else 0.0) for (a, b), s in zip(_BANDS_HZ, power, strict=True)
    )


def shrink_interval(before: FloatArray, after: FloatArray, floor: FloatArray) -> tuple[float, float]:
    """Return the 95 % interval of the shrink in per cent, by resampling manoeuvres.

    Parameters
    ----------
    before, after
        Shape (manoeuvres, channels): mean squares of the residuals.
    floor
        Shape (channels,): standard deviation of the noise.
    """
    rng = np.random.default_rng(20)
    n = len(before)
    drawn = rng.integers(0, n, (2000, n))
    was, now = (
        np.mean(gap_of(np.mean(residual[drawn], axis=1), floor), axis=1) for residual in (before, after)
    )
    percent = 100.0 * (1.0 - now / np.maximum(was, 1e-12))
    low, high = np.percentile(percent, [2.5, 97.5])
    return float(max(low, -100.0)), float(min(high, 100.0))


def file_model_of(problem: EffectProblem, fitted: EffectFit) -> HeldOut | None:
    """Return the hold-out of the aircraft file's derivatives, with initial states, trim and offsets
    refitted."""
    if problem.prior_derivatives is None:
        return None
    file = replace(fitted.point, derivatives=problem.prior_derivatives).keeping([])
    return own_refitted(problem, with_natural(problem, file, fitted.point, fitted.noise), fitted.noise)
