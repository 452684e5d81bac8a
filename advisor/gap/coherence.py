"""Is anything left that the motion itself predicts? The question behind "none" and "unknown".

Noise, however coloured, cannot be predicted from the stick on a manoeuvre it was not learned from;
an unmodelled effect can. The residual of every channel is regressed on a broad, shapeless set of
features (the deflection at many lags, products of the simulated motion) on some manoeuvres
and predicted on the others.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit

from advisor.flight.messages import FloatArray
from advisor.gap.data import Flight
from advisor.gap.fit import Fitted, rms_of
from advisor.gap.holdout import folds_of
from advisor.gap.layout import OUTPUTS
from advisor.gap.problem import Problem, row_weights
from advisor.gap.simulate import read_off, surface

_LAG_SPACING_S = 0.04
_LAGS = 24
_RIDGES = (3.0, 30.0, 300.0)


@dataclass(frozen=True)
class Coherence:
    """What of the residual is predictable on manoeuvres kept out."""

    share: FloatArray
    """Shape (channels,): share of the mean square that is predicted, 0 when none."""
    power: FloatArray
    """Shape (channels,): that share as a mean square."""
    consistent: float
    """Share of manoeuvre-channel pairs in which the prediction helped."""


def coherent_part(problem: Problem, fitted: Fitted) -> Coherence:
    """Predict the residuals of every manoeuvre from the others."""
    n = len(problem.flights)
    channels = len(problem.channels)
    if n < 3:
        return Coherence(np.zeros(channels), np.zeros(channels), 0.0)
    weights = 1.0 / fitted.noise
    p = problem.driving(fitted.point)
    columns, residuals = [], []
    for i, flight in enumerate(problem.flights.flights):
        X = _features(problem, flight, problem.fly(flight, p[i]), p[i])
        w = row_weights(problem, i, weights)
        A = fitted.linear[i].own * w[:, None]
        r = fitted.innovations[i] * w
        cleaned = []
        for rows in problem.rows(flight):
            # Own numbers (initial state, trim, offsets) act on one channel's features like on any residual.
            own, x = A[rows], X[rows]
            q = np.linalg.qr(own[:, np.linalg.norm(own, axis=0) > 1e-9])[0]
            cleaned.append(x - q @ (q.T @ x))
        columns.append(cleaned)
        residuals.append([r[rows] for rows in problem.rows(flight)])
    before, saved, power = np.zeros(channels), np.zeros(channels), np.zeros(channels)
    helped = 0
    for c in range(channels):
        total = float(np.sum([np.sum(r[c] ** 2) for r in residuals]))
        scale = np.sqrt(np.mean(np.vstack([x[c] for x in columns]) ** 2, axis=0)) + 1e-12
        grams = [(x[c] / scale).T @ (x[c] / scale) for x in columns]
        cross = [(x[c] / scale).T @ r[c] for x, r in zip(columns, residuals, strict=True)]
        gains = {ridge: np.zeros(n) for ridge in _RIDGES}
        for fold in folds_of(n):
            keep = [i for i in range(n) if i not in fold]
            G, g = np.sum([grams[i] for i in keep], axis=0), np.sum([cross[i] for i in keep], axis=0)
            for ridge in _RIDGES:
                beta = np.linalg.solve(G + ridge * np.eye(len(G)), g)
                for i in fold:
                    gains[ridge][i] = 2.0 * beta @ cross[i] - beta @ grams[i] @ beta
        best = max(gains.values(), key=lambda gain: float(np.sum(gain)))
        helped += int(np.count_nonzero(best > 0.0))
        before[c], saved[c] = total, float(np.sum(best))
        # A prediction that helps in a few manoeuvres only is chance, not structure.
        spread = float(np.std(best)) / np.sqrt(n)
        power[c] = saved[c] if np.mean(best) > 2.0 * spread and saved[c] > 0.0 else 0.0
    share = power / np.maximum(before, 1e-300)
    return Coherence(share, share * rms_of(problem, fitted.left) ** 2, helped / (n * channels))


def _features(problem: Problem, flight: Flight, grid: FloatArray, p: FloatArray) -> FloatArray:
    """Shape (rows, features), the same features for each channel at its own stamps."""
    delta = surface(flight.h, flight.n, flight.t_u, flight.u, problem.held, flight.u_trim, p)
    delta = np.append(delta, delta[-1])
    alpha, q = grid[OUTPUTS.index("alpha")] - flight.trim[0], grid[OUTPUTS.index("q")]
    size = [max(float(np.std(s)), 1e-9) for s in (delta, alpha, q)]
    d, a, r = delta / size[0], alpha / size[1], q / size[2]
    rate = np.gradient(r, flight.h)
    rate = rate / max(float(np.std(rate)), 1e-9)
    spacing = round(_LAG_SPACING_S / flight.h)
    total = np.concatenate([np.zeros(spacing), np.cumsum(d)])
    lagged = (total[spacing:] - total[:-spacing]) / spacing
    made = [
        np.concatenate([np.full(k * spacing, lagged[0]), lagged[: len(lagged) - k * spacing]])
        for k in range(_LAGS)
    ]
    decay = np.exp(-flight.h / 0.15)
    products = (d * d, d * np.abs(d), a * a, a**3, r * np.abs(r), a * r, a * d, r * d, np.abs(d))
    for y in (*products, np.sign(r), np.sign(rate)):
        made += [y, _smoothed(y, decay)]
    made += [a, r, rate]
    return np.vstack(
        [
            np.column_stack([read_off(y, flight.h, flight.outputs[c].t, 0.0) for y in made])
            for c in problem.channels
        ]
    )


def unrest(problem: Problem, lefts: Sequence[FloatArray]) -> tuple[FloatArray, FloatArray]:
    """Mean squares while the elevator works, and while all is quiet; both shape (channels,).

    Noise and turbulence do not care what the pilot does; an effect without a name does.
    """
    sums, counts = np.zeros((2, len(problem.channels))), np.zeros((2, len(problem.channels)))
    for flight, left in zip(problem.flights.flights, lefts, strict=True):
        free = flight.duration_s - flight.last_step_s
        for c, (name, rows) in enumerate(zip(problem.channels, problem.rows(flight), strict=True)):
            t = flight.outputs[name].t
            quiet = (t < flight.first_step_s) | (t > flight.last_step_s + 0.6 * free)
            active = (t >= flight.first_step_s) & (t <= flight.last_step_s + 0.3 * free)
            for k, inside in enumerate((active, quiet)):
                sums[k, c] += float(np.sum(left[rows][inside] ** 2))
                counts[k, c] += np.count_nonzero(inside)
    active_power, quiet_power = sums / np.maximum(counts, 1.0)
    return active_power, quiet_power


@njit(cache=True)
def _smoothed(y: FloatArray, decay: float) -> FloatArray:
    """First-order low pass from rest."""
    out = np.empty(len(y))
    state = 0.0
    for i in range(len(y)):
        state = decay * state + (1.0 - decay) * y[i]
        out[i] = state
    return out
