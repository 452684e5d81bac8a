"""Noise of a flight, from the quiet stretches before and after the input.

Before the first step and late in the free response the elevator rests. Motion in a quiet stretch is noise of
instruments and air, not an effect that the elevator excites. Every explanation of the other motion is judged
against the noise in quiet stretches.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.gap.decision import LEAST_GAIN
from advisor.gap.fitting.fit import EffectFit, power_of, rms_of
from advisor.gap.fitting.holdout import mean_squares
from advisor.gap.fitting.linear import as_measured
from advisor.gap.fitting.problem import EffectProblem, SearchPoint, row_weights
from advisor.gap.fitting.step import solve_blocks
from advisor.gap.fitting.whitening import Weighting, Whitening, filters_for, motion_of, rows_in_time
from advisor.gap.noise.probes import probe_blocks
from advisor.gap.noise.shown_gust import largest_gust
from advisor.gap.noise.stamps import stamp_variance
from advisor.gap.records.flights import PreparedManeuver
from advisor.gap.records.floor import stated_floor
from advisor.gap.simulator.layout import DERIVATIVES, OUTPUTS
from advisor.oem.driven_motion.noise import Noise
from advisor.oem.turbulence import Rows, cost_of, find_turbulence, spread_of
from advisor.process.arrays import FloatArray

_LEAST_SAMPLES = 50
"""Record: least number of a channel's samples in quiet stretches for an estimate of its noise."""
_LONE = 8.0
"""Power of a quiet stretch over the median of all stretches, above which a gust disturbed the stretch."""
_LOUD = 3.0
"""Power of a manoeuvre over that of the quietest quarter, above which a gust may be the cause."""
_MARGIN = 1.2
"""Least ratio of log likelihood gains, moving air over any other block, for a gust. A change of mass also
looks like moving air."""
_NO_LESS = 0.98
"""Numerical: weight of a sample above which the fit treats the sample's stamp as exact."""
_NONE_OF_PEAK = 1e-9
"""Numerical: white noise over the channel's peak that replaces a noise of zero, to avoid a division by
zero."""


def whitening_of(problem: EffectProblem, fitted: EffectFit, first_look: bool = False) -> Whitening | None:
    """Return the filter or the weights that the noise of this flight requires; None for white noise.

    Before the first fit with a filter, a gust may have biased the derivatives. Every suspect manoeuvre is
    then excluded, and the fit of the others shows whether it had a gust.
    """
    extra = stamp_variance(problem, fitted)
    air = noise_in_quiet(problem, fitted)
    still = air or with_floor(problem, Noise.still(instrument_noise(problem)))
    gusts = gusts_in(problem, fitted, still, first_look)
    if air is not None or gusts:
        airs = [gusts.get(i, still) for i in range(len(problem.flights))]
        filters = filters_for(problem.flights, problem.driving(fitted.point), airs, extra)
        if filters.is_sound:
            return filters
    white = stated_floor(problem.flights) ** 2
    weights = tuple(1.0 / np.sqrt(1.0 + e / row_weights(problem, i, white)) for i, e in enumerate(extra))
    return Weighting(weights) if min(float(np.min(w)) for w in weights) < _NO_LESS else None


def noise_in_quiet(problem: EffectProblem, fitted: EffectFit) -> Noise | None:
    """Return coloured instruments or moving air in quiet stretches; None for white noise."""
    rows = quiet_rows(problem, fitted)
    if not rows:
        return None
    turbulence = find_turbulence(rows, instrument_noise(problem))
    gain = 0.5 * (cost_of(rows, Noise.still(spread_of(rows))) - cost_of(rows, turbulence.noise))
    return with_floor(problem, turbulence.noise) if gain > LEAST_GAIN else None


def quiet_rows(problem: EffectProblem, fitted: EffectFit) -> list[Rows]:
    """Return the residuals of the quiet stretches without offsets; empty where the records show no air."""
    if not problem.flights.shows_air:
        return []
    parts = [part for i in range(len(problem.flights)) for part in _quiet_parts(problem, fitted, i)]
    rows = _without_offsets(parts)
    # A gust in a quiet stretch does not represent the noise of the flight.
    white = instrument_noise(problem)
    loud = np.array([float(np.mean((r.residual / white[r.channel]) ** 2)) for r in rows])
    return [r for r, power in zip(rows, loud, strict=True) if power <= _LONE * np.median(loud)]


def loudness(problem: EffectProblem, fitted: EffectFit) -> float:
    """Return the median power of the residual in quiet stretches, relative to the instruments' noise."""
    white = instrument_noise(problem)
    parts = [part for i in range(len(problem.flights)) for part in _quiet_parts(problem, fitted, i)]
    powers = [float(np.mean((r.residual / white[r.channel]) ** 2)) for r in _without_offsets(parts)]
    return float(np.median(powers)) if powers else 0.0


def gusts_in(problem: EffectProblem, fitted: EffectFit, still: Noise, first_look: bool) -> dict[int, Noise]:
    """Return the air model of each manoeuvre with a gust, whose residual far exceeds that of the quietest
    quarter.

    An elevator effect may appear in some manoeuvres only, but another block then explains it equally well.
    """
    noise = np.array([float(np.hypot(still.white[c], still.coloured[c]))
                      for c in (OUTPUTS.index(name) for name in problem.channels)])  # fmt: skip
    power = np.mean(mean_squares(problem, _begun_anew(problem, fitted, noise)) / noise**2, axis=1)
    louder = power / np.percentile(power, 25.0)
    suspects = [int(i) for i in np.flatnonzero(louder > _LOUD)]
    gusty = [i for i in suspects if _likelier(problem, fitted, i, noise) > _MARGIN]
    most = largest_gust(problem.flights, float(fitted.point.derivatives[0]))
    return {i: replace(still, gust=most) for i in (suspects if first_look and gusty else gusty)}


def _begun_anew(problem: EffectProblem, fitted: EffectFit, noise: FloatArray) -> list[FloatArray]:
    """Return each manoeuvre's stacked residuals, with nuisances refitted to the instruments' noise."""
    # A filter that allows for any gust does not determine an initial state.
    problem, fitted = unfiltered(problem, fitted)
    owns = solve_blocks(problem, fitted.linear, 1.0 / noise, fitted.point).free
    still = np.zeros(len(fitted.point.shared))
    return [block.after(still, own) for block, own in zip(fitted.linear, owns, strict=True)]


def _likelier(problem: EffectProblem, fitted: EffectFit, i: int, noise: FloatArray) -> float:
    """Return the gain in log likelihood of moving air over any other block in a manoeuvre's residual, at
    least 0.
    """
    best, second, *_ = probe_blocks(*in_one_maneuver(problem, fitted, i), noise)
    return best.gain / max(second.gain, 1e-9) if best.block == "air" else 0.0


def in_one_maneuver(problem: EffectProblem, fitted: EffectFit, i: int) -> tuple[EffectProblem, EffectFit]:
    """Return the problem and its fit, restricted to one manoeuvre."""
    problem, fitted = unfiltered(problem, fitted)
    flights = replace(problem.flights, flights=(problem.flights.flights[i],))
    # An effect between manoeuvres needs all of them, so its value here becomes part of the base.
    base = problem.driving(fitted.point)[i]
    derivatives = base[: len(DERIVATIVES)].copy()
    base[: len(DERIVATIVES)] = 0.0  # the point adds them
    return (
        replace(problem, flights=flights, base=base, changes=()),
        replace(
            fitted,
            point=SearchPoint(derivatives, fitted.point.own[i : i + 1]),
            innovations=(fitted.residuals[i],),
            residuals=(fitted.residuals[i],),
            linear=(fitted.linear[i],),
        ),
    )


def unfiltered(problem: EffectProblem, fitted: EffectFit) -> tuple[EffectProblem, EffectFit]:
    """Return the problem and its fit without a filter of the noise."""
    linear = tuple(as_measured(block) for block in fitted.linear)
    return replace(problem, whitening=None), replace(fitted, innovations=fitted.residuals, linear=linear)


def with_floor(problem: EffectProblem, noise: Noise) -> Noise:
    """Return the noise with white noise of at least half the stated floor.

    A record that was filtered before storage has almost no white noise. With so little noise, the errors of a
    simplified model would be overweighted a thousandfold.
    """
    white = noise.white.copy()
    for c, least in zip(problem.channels, 0.5 * stated_floor(problem.flights), strict=True):
        white[OUTPUTS.index(c)] = max(white[OUTPUTS.index(c)], least)
    return replace(noise, white=white)


def quiet_rms(problem: EffectProblem, fitted: EffectFit) -> FloatArray:
    """Return the root mean square residual in quiet stretches, shape (channels,)."""
    power, count = power_of(problem, fitted.residuals, PreparedManeuver.is_quiet)
    whole = rms_of(problem, fitted.residuals)
    # A few samples say nothing; the root mean square of the whole residual is then the best estimate.
    return np.where(count > _LEAST_SAMPLES, np.sqrt(power / np.maximum(count, 1.0)), whole)


def instrument_noise(problem: EffectProblem) -> FloatArray:
    """Return the white noise of each channel from differences of its samples, shape (4,); 1 for a missing
    channel.

    In quiet stretches a channel with a resolution coarser than its noise shows no differences.
    """
    least = _NONE_OF_PEAK * problem.flights.peaks
    white = dict(zip(problem.channels, np.maximum(problem.flights.white, least), strict=True))
    return np.array([white.get(c, 1.0) for c in OUTPUTS])


def rows_of(problem: EffectProblem, fitted: EffectFit, i: int) -> Rows:
    """Return the residual of manoeuvre ``i`` in order of time."""
    driving = problem.driving(fitted.point)
    t, channel, order = rows_in_time(problem.flights, i, driving[i])
    return Rows(t, channel, fitted.residuals[i][order], motion_of(problem.flights, i, driving[0]))


def _quiet_parts(problem: EffectProblem, fitted: EffectFit, i: int) -> list[Rows]:
    """Return the quiet stretches before the first and after the last step, each as a record of its own."""
    flight = problem.flights.flights[i]
    whole = rows_of(problem, fitted, i)
    quiet = flight.is_quiet(whole.t)
    before = whole.t < flight.first_step_s
    return [
        Rows(whole.t[inside], whole.channel[inside], whole.residual[inside], whole.motion)
        for inside in (quiet & before, quiet & ~before)
        if np.count_nonzero(inside) > 10 * len(problem.channels)
    ]


def _without_offsets(rows: Sequence[Rows]) -> list[Rows]:
    """Return the stretches without each channel's mean, because an offset is an effect and not noise."""
    offset = np.zeros(len(OUTPUTS))
    for c in range(len(OUTPUTS)):
        picked = [r.residual[r.channel == c] for r in rows]
        if sum(len(p) for p in picked):
            offset[c] = float(np.mean(np.concatenate(picked)))
    return [replace(r, residual=r.residual - offset[r.channel]) for r in rows]
