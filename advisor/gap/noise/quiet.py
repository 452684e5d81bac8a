"""Noise of a flight, from the quiet stretches before and after the input and from probes of its residuals.

Before the first step and late in the free response the elevator rests. Motion in a quiet stretch is noise of
instruments and air, not an effect that the elevator excites. Every explanation of the other motion is judged
against the noise in quiet stretches.

A first-order Gauss-Markov disturbance is added to the input, to either equation, to the air or to one sensor
of the fitted model. A disturbance in the wrong block cannot explain the responses in *all* channels. The
compared marginal likelihoods come from linear algebra; a Kalman filter would give equal values.

A vane turns with a gust, and the motion of the aircraft follows later. In still air α̇ equals the pitch rate
minus the rate of the flight path angle. The vane reading beyond the integral of that difference is the gust
angle w/V plus instrument errors.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.flight.signals.derived_alpha import integrated, path_turning
from advisor.gap.decision import LEAST_GAIN
from advisor.gap.fitting.fit import EffectFit, power_of, rms_of
from advisor.gap.fitting.holdout import mean_squares
from advisor.gap.fitting.linear import as_measured, pulse_response
from advisor.gap.fitting.problem import EffectProblem, SearchPoint, row_weights
from advisor.gap.fitting.step import factor, solve_blocks
from advisor.gap.fitting.whitening import Weighting, Whitening, filters_for, motion_of, rows_in_time
from advisor.gap.noise.stamps import stamp_variance
from advisor.gap.records.flights import PreparedManeuver, PreparedManeuvers
from advisor.gap.records.floor import stated_floor
from advisor.gap.simulator.layout import (
    A_X,
    BANK,
    DERIVATIVES,
    DISTURB_AIR,
    DISTURB_FORCE,
    DISTURB_INPUT,
    DISTURB_MOMENT,
    INDEX,
    OUTPUTS,
    SPEED,
)
from advisor.oem.arrow import solved
from advisor.oem.driven_motion.setting import Noise
from advisor.oem.turbulence import KNOTS_S, LARGEST_GUST_RAD, Rows, cost_of, find_turbulence, spread_of
from advisor.process.arrays import FloatArray

_NEEDED = ("alpha", "q", "a_z", "theta")


def largest_gust(flights: PreparedManeuvers, z_alpha: float) -> float:
    """Return the largest gust angle that the flight shows, rad, from its vane and motion, and from its lift.

    A gust moves the vane, and the lift follows the gust. A fit with a wrong model can require a gust of any
    size.

    Parameters
    ----------
    z_alpha
        Lift derivative Z_α, 1/s, of a model that may be wrong.
    """
    shown = [LARGEST_GUST_RAD]
    if "alpha" in flights.channels and not flights.alpha_is_derived:
        shown.append(max(float(np.ptp(_beyond_motion(flight))) for flight in flights.flights))
    if "a_z" in flights.channels and z_alpha != 0.0:
        forces = (float(np.ptp(f.outputs["a_z"].y) / np.mean(f.slow[SPEED])) for f in flights.flights)
        shown.append(max(forces) / abs(z_alpha))
    return min(shown)


def _beyond_motion(flight: PreparedManeuver) -> FloatArray:
    """Return α minus that of the motion, rad, shape (n,), without the straight line of offsets."""
    t, alpha = flight.outputs["alpha"].t, flight.outputs["alpha"].y
    if not all(name in flight.outputs for name in _NEEDED):
        return alpha
    q, a_z, theta = (flight.outputs[n].at(t) for n in _NEEDED[1:])
    middles = (np.arange(flight.n) + 0.5) * flight.h
    a_x, bank, speed = (np.interp(t, middles, flight.slow[row]) for row in (A_X, BANK, SPEED))
    beyond = alpha - integrated(t, q + path_turning(a_x, a_z, theta, alpha, bank) / speed)
    line = np.column_stack([np.ones_like(t), t])
    return np.asarray(beyond - line @ np.linalg.lstsq(line, beyond)[0])


MEMORY_S = 0.6
"""Numerical: correlation time of a disturbance, s. Sums of such disturbances represent faster and slower
disturbances."""
SENSOR_CHANNELS = {
    "alpha_sensor": "alpha",
    "pitch_rate_sensor": "q",
    "accelerometer": "a_z",
    "attitude_sensor": "theta",
}
DYNAMIC = {
    "input": DISTURB_INPUT,
    "force_equation": DISTURB_FORCE,
    "moment_equation": DISTURB_MOMENT,
    "air": DISTURB_AIR,
}
_SIZES = np.geomspace(1e-3, 30.0, 24)
"""Numerical: candidate sizes of the disturbance: 1 gives a response as large as the noise."""


@dataclass(frozen=True)
class Probe:
    """A disturbance in one block at its most likely size."""

    block: str
    gain: float
    """Log likelihood gain of the disturbance over white noise alone, nats."""
    explained: float
    """Share of the weighted residual power that the disturbance explains."""


def probe_blocks(problem: EffectProblem, fitted: EffectFit, noise: FloatArray) -> list[Probe]:
    """Return the likeliest disturbance of every block, likeliest block first.

    With a filter in the problem, the disturbance exceeds the noise that the filter assumes.

    Parameters
    ----------
    noise
        Shape (channels,): noise of the innovations; without a filter, noise of the instruments alone.
    """
    shown = {*problem.channels, *(["air"] if problem.flights.shows_air else [])}
    needed = {**SENSOR_CHANNELS, "air": "air"}
    there = [block for block in (*DYNAMIC, *SENSOR_CHANNELS) if needed.get(block, "q") in shown]
    spectra: dict[str, list[FloatArray]] = {block: [] for block in there}
    powers: dict[str, list[FloatArray]] = {block: [] for block in there}
    units: dict[str, float] = {}
    p, total = problem.driving(fitted.point), 0.0
    for i, flight in enumerate(problem.flights.flights):
        w, colour = row_weights(problem, i, 1.0 / noise), _colour(flight)
        A, r = fitted.linear[i].own * w[:, None], fitted.innovations[i] * w
        chol = factor(A, fitted.linear[i].prior)
        unabsorbed = r - A @ solved(chol, A.T @ r)
        total += float(r @ r)
        for block in there:
            B = problem.innovations(i, responses_at_knots(problem, flight, p[i], block)) * w[:, None]
            AB, BB = A.T @ B, B.T @ B
            # The knots are coloured last: they are fewer than the rows.
            unit = units.setdefault(block, float(np.sqrt(np.sum(colour * (BB @ colour)) / len(B))) + 1e-300)
            gram = colour.T @ (BB - AB.T @ solved(chol, AB)) @ colour / unit**2
            value, vector = np.linalg.eigh((gram + gram.T) / 2.0)
            spectra[block].append(np.maximum(value, 0.0))
            powers[block].append((vector.T @ (colour.T @ (B.T @ unabsorbed)) / unit) ** 2)
    probes = (at_its_size(b, np.hstack(spectra[b]), np.hstack(powers[b]), total) for b in there)
    return sorted(probes, key=lambda p: -p.gain)


def at_its_size(block: str, value: FloatArray, power: FloatArray, total: float) -> Probe:
    """Return the disturbance of a block at its most likely size.

    Parameters
    ----------
    value, power
        Shape (directions,): information on each direction of the disturbance, and its squared gradient. The
        disturbance's response is as large as the noise.
    total
        Weighted power of the residual.
    """
    squares = _SIZES[:, None] ** 2
    shrunk = 1.0 / (1.0 / squares + value)
    gains = 0.5 * np.sum(power * shrunk - np.log1p(squares * value), axis=1)
    best = int(np.argmax(gains))
    taken = float(np.sum(power * shrunk[best] * (2.0 - value * shrunk[best])))
    return Probe(block, float(gains[best]), min(taken / max(total, 1e-300), 1.0))


def disturbance_columns(
    problem: EffectProblem, flight: PreparedManeuver, p: FloatArray, block: str
) -> FloatArray:
    """Return the response of all channels to a Gauss-Markov disturbance of unit variance, shape (rows, k).

    A vane reads a gust; an α estimated from inertial sensors does not.
    """
    return np.asarray(responses_at_knots(problem, flight, p, block) @ _colour(flight))


def responses_at_knots(
    problem: EffectProblem, flight: PreparedManeuver, p: FloatArray, block: str
) -> FloatArray:
    """Return the response of all channels to a disturbance at each knot in turn, shape (rows, k)."""
    knots = np.arange(0.0, flight.duration_s, KNOTS_S)
    hat = round(KNOTS_S / flight.h)
    shape = np.concatenate([np.arange(1, hat + 1), np.arange(hat - 1, 0, -1)]) / hat
    n = flight.n + 1
    response = np.zeros((4, n))
    if block in SENSOR_CHANNELS:
        response[OUTPUTS.index(SENSOR_CHANNELS[block]), : len(shape)] = shape
    else:
        pulse = pulse_response(problem, flight, p, DYNAMIC[block])
        for c in range(4):
            response[c] = np.convolve(pulse[c], shape)[:n] * flight.h
        if block == "air" and problem.flights.alpha_is_derived:
            response[OUTPUTS.index("alpha"), : len(shape)] -= shape * (1.0 + p[INDEX["alpha_scale"]])
    # The rising side of the hat function lies before its knot.
    return problem.read_delayed(flight, response, knots[1:] - KNOTS_S, p)


@dataclass(frozen=True)
class DisturbanceCourse:
    """The likeliest time course of a block's disturbance."""

    knots: tuple[FloatArray, ...]
    """Per manoeuvre: value of the disturbance at each knot."""
    residuals: tuple[FloatArray, ...]
    """Per manoeuvre: residuals of the stacked channels without the disturbance, in the channels' units."""


def disturbance_courses(
    problem: EffectProblem, fitted: EffectFit, noise: FloatArray, block: str, sizes: Sequence[float]
) -> list[DisturbanceCourse]:
    """Return the likeliest course of a block's disturbance for each prior standard deviation in ``sizes``."""
    p = problem.driving(fitted.point)
    courses: list[list[FloatArray]] = [[] for _ in sizes]
    residuals: list[list[FloatArray]] = [[] for _ in sizes]
    for i, flight in enumerate(problem.flights.flights):
        w = row_weights(problem, i, 1.0 / noise)
        own, prior = fitted.linear[i].measured.own, fitted.linear[i].prior
        both = np.column_stack([own, disturbance_columns(problem, flight, p[i], block)])
        A, colour = both * w[:, None], _colour(flight)
        free = len(colour)
        for k, size in enumerate(sizes):
            chol = factor(A, np.concatenate([prior, np.full(free, 1.0 / size**2)]))
            solution = solved(chol, A.T @ (fitted.residuals[i] * w))
            courses[k].append(np.asarray(colour @ solution[-free:]))
            residuals[k].append(np.asarray(fitted.residuals[i] - both @ solution))
    return [DisturbanceCourse(tuple(u), tuple(y)) for u, y in zip(courses, residuals, strict=True)]


def _colour(flight: PreparedManeuver) -> FloatArray:
    """Return the Cholesky factor of the correlation between the knots of a disturbance."""
    return coloured_between(np.arange(0.0, flight.duration_s, KNOTS_S)[1:])


def coloured_between(knots: FloatArray) -> FloatArray:
    """Return the Cholesky factor (k, k) of the correlation of a disturbance between knots (k,), s."""
    lags = np.abs(knots[:, None] - knots[None, :])
    return np.asarray(np.linalg.cholesky(np.exp(-lags / MEMORY_S) + 1e-9 * np.eye(len(knots))))


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
