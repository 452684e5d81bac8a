"""Location of an unknown disturbance, found by trying one block of the simulator after another.

A first-order Gauss-Markov disturbance is added to the input, to either equation, to the air or to one sensor
of the fitted model. A disturbance in the wrong block cannot explain the responses in *all* channels. The
compared marginal likelihoods come from linear algebra; a Kalman filter would give equal values.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.linear import pulse_response
from advisor.gap.fitting.problem import EffectProblem, row_weights
from advisor.gap.fitting.step import factor
from advisor.gap.records.flights import PreparedManeuver
from advisor.gap.simulator.layout import (
    DISTURB_AIR,
    DISTURB_FORCE,
    DISTURB_INPUT,
    DISTURB_MOMENT,
    INDEX,
    OUTPUTS,
)
from advisor.oem.arrow import solved
from advisor.oem.turbulence import KNOTS_S
from advisor.process.arrays import FloatArray

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
