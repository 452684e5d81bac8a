"""Side gusts in the residuals of a fit, distinguished from coloured noise of the instruments.

A gust adds its angle to the sideslip that fin, wing and vane meet, so it enters side force, roll and yaw
together. Its angle is linear between knots, with an exponential correlation, as in Dryden's turbulence across
the flight path. Noise of an instrument, however coloured, enters its own output alone. The likelihoods of the
residuals distinguish the two.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.linalg import expm
from scipy.optimize import minimize

from advisor.flight.signals.messages import FloatArray
from advisor.gap.noise.probes import KNOTS_S
from advisor.model.lateral import LATERAL, Trim, state_matrix
from advisor.oem.colour import Stretch, find_colour
from advisor.oem.whitening import schedule, whiten
from advisor.side_gap.fit import Fit, N
from advisor.side_gap.setting import Flown

STEP_S = 0.02
"""Step of the motion that a gust causes, s: a fifth of the distance of the knots."""
_MEMORY_S = 1.0
"""Correlation time with which the search begins, s: 60 m at 25 m/s are 2.4 s."""
_RANGE = (1e-3, 1e3)
"""Range of every standard deviation, over its start."""
_LONGEST_MEMORY_S = 60.0
_MOST_STEPS = 400
_BEND = 0.2
"""Step of the logarithm of the gust angle for the curvature of its likelihood."""
_BETA, _P, _R, _BANK = range(len(LATERAL.states))


class Course(NamedTuple):
    """A gust angle in one manoeuvre."""

    knots: FloatArray
    """(k,) times of its knots, s."""
    columns: FloatArray
    """(n, k) change of the manoeuvre's rows by 1 rad at each knot, free of what its own parameters absorb."""


@dataclass(frozen=True, slots=True)
class Gusts:
    """White noise of the outputs, and a gust angle in every manoeuvre."""

    noise: FloatArray
    """(outputs,) standard deviation of the white noise."""
    angle: float
    """Standard deviation of the gust angle, rad."""
    angle_std: float
    """Standard deviation of that number, with all other numbers at their values."""
    likelihood: float
    """Log likelihood of the residuals, on the scale of ``Fit.likelihood``."""


def side_gusts(fit: Fit, courses: Sequence[Course]) -> Gusts:
    """Return the likeliest white noise and gusts in the residuals of a fit."""
    sums = [_Sums.of(fit, m, course) for m, course in enumerate(courses)]
    there = np.unique(fit.assembly.channel)
    reach = np.mean(
        [
            np.sqrt(np.mean((course.columns * fit.weight[fit.assembly.owner == m, None]) ** 2))
            for m, course in enumerate(courses)
        ]
    ) * np.sqrt(len(courses[0].knots))
    angle = 1.0 / max(float(reach), 1e-12)

    def model(x: FloatArray) -> tuple[FloatArray, float, float]:
        noise = np.ones(len(fit.noise))
        noise[there] = np.exp(x[:-2])
        return noise, float(np.exp(x[-2])), float(np.exp(x[-1]))

    def cost(x: FloatArray) -> float:
        noise, angle, memory_s = model(x)
        return sum(one.cost(noise, _root(one.knots, angle, memory_s)) for one in sums)

    sizes = np.append(fit.noise[there], angle)
    bounds = [*((np.log(_RANGE[0] * s), np.log(_RANGE[1] * s)) for s in sizes),
              (np.log(KNOTS_S), np.log(_LONGEST_MEMORY_S))]  # fmt: skip
    found = minimize(
        cost,
        np.log([*sizes, _MEMORY_S]),
        method="Nelder-Mead",
        bounds=bounds,
        options={"maxfev": _MOST_STEPS, "xatol": 0.02, "fatol": 0.1},
    )
    step = _BEND * (np.arange(len(found.x)) == len(found.x) - 2)
    bend = (cost(found.x + step) - 2.0 * float(found.fun) + cost(found.x - step)) / (2.0 * _BEND**2)
    noise, angle, _ = model(found.x)
    return Gusts(noise, angle, angle / np.sqrt(max(bend, _BEND)), -0.5 * (float(found.fun) - len(fit.fitted)))


def coloured_likelihood(fit: Fit) -> float:
    """Return the log likelihood of the residuals under instruments of any colour, on the same scale."""
    cost = 0.0
    for name in LATERAL.outputs:
        parts = [fit.residual[named[name]] for named in fit.assembly.rows if name in named]
        if not parts:
            continue
        colour = find_colour([Stretch(left, np.ones((len(left), 1))) for left in parts])
        variance = max(colour.variance, float(np.finfo(float).tiny))
        for left in parts:
            # White noise is a first-order autoregression without memory.
            scale, gain, determinant = schedule(len(left), colour.memory, colour.white_share)
            white = whiten(np.ascontiguousarray(left[:, None]), colour.memory, scale, gain)[0]
            cost += len(left) * (np.log(variance) - 1.0) + determinant + float(white @ white) / variance
    return -0.5 * cost


def gust_courses(fit: Fit, flown: Flown) -> tuple[Course, ...]:
    """Return what a gust angle changes in every manoeuvre, by the derivatives of a fit."""
    return tuple(_course(fit, flown, m) for m in range(len(flown)))


def _course(fit: Fit, flown: Flown, m: int) -> Course:
    assembly = fit.assembly
    own = np.flatnonzero(assembly.owner == m)
    stamps = assembly.t[own]
    knots = np.arange(np.min(stamps), np.max(stamps) + KNOTS_S, KNOTS_S)
    t = np.arange(knots[0], knots[-1] + STEP_S, STEP_S)
    seen = _outputs(fit.point.theta, flown, m, _hats(t, knots))
    columns = np.zeros((len(own), len(knots)))
    between = _hats(stamps, t, STEP_S)
    for name, rows in assembly.rows[m].items():
        mine = slice(rows.start - own[0], rows.stop - own[0])
        columns[mine] = between[mine] @ seen[name]
    weight = fit.weight[own][:, None]
    local = fit.sensitivities[own][:, assembly.free[assembly.free >= N]] * weight
    basis = np.linalg.svd(local, full_matrices=False)[0]
    weighed = columns * weight
    return Course(knots, (weighed - basis @ (basis.T @ weighed)) / weight)


def _outputs(theta: FloatArray, flown: Flown, m: int, gust: FloatArray) -> Mapping[str, FloatArray]:
    """Return by output what gust angles (n, k), one value a step, change (n, k)."""
    problem, record = flown.problem, flown.problem.records[m]
    speed = float(np.mean(record.airspeed.y))
    ratio = speed / (problem.reference_airspeed_m_s or speed)
    trim = Trim(speed, float(np.mean(record.alpha.y)), float(np.mean(record.theta.y)))
    scaled = theta * np.array([ratio**term.power for term in LATERAL.shared])
    a = state_matrix(scaled, trim)
    aerodynamic = a - state_matrix(np.zeros(len(theta)), trim)
    by_gust = aerodynamic[:, _BETA]
    whole = np.zeros((6, 6))
    whole[:4, :4], whole[:4, 4], whole[4, 5] = a, by_gust, 1.0 / STEP_S
    step = expm(STEP_S * whole)
    x = np.zeros((len(gust), 4, gust.shape[1]))
    for i, (now, following) in enumerate(pairwise(gust)):
        x[i + 1] = step[:4, :4] @ x[i] + np.outer(step[:4, 4], now) + np.outer(step[:4, 5], following - now)
    force, turn = (np.einsum("s,nsk->nk", aerodynamic[k], x) + by_gust[k] * gust for k in (_BETA, _R))
    return {
        "p": x[:, _P],
        "r": x[:, _R],
        "bank": x[:, _BANK],
        "a_y": speed * force + problem.accelerometer_arm_m * turn,
        "beta": x[:, _BETA] + gust + problem.beta_arm_m / speed * x[:, _R],
    }


def _hats(t: FloatArray, knots: FloatArray, apart: float = KNOTS_S) -> FloatArray:
    """Return the share (n, k) of every knot at times ``t``, linear between knots ``apart`` seconds apart."""
    return np.maximum(0.0, 1.0 - np.abs(t[:, None] - knots) / apart)


def _root(knots: FloatArray, angle: float, memory_s: float) -> FloatArray:
    """Return the Cholesky factor (k, k) of the covariance of a gust angle at its knots."""
    apart = np.abs(knots[:, None] - knots)
    return np.asarray(angle * np.linalg.cholesky(np.exp(-apart / memory_s) + 1e-9 * np.eye(len(knots))))


class _Sums(NamedTuple):
    """Sums of one manoeuvre from which the likelihood under any gusts follows."""

    knots: FloatArray
    counts: FloatArray
    """(outputs,) rows of each output."""
    squares: FloatArray
    """(outputs,) sum of the squared residuals."""
    pulls: FloatArray
    """(outputs, k)"""
    grams: FloatArray
    """(outputs, k, k)"""

    @classmethod
    def of(cls, fit: Fit, m: int, course: Course) -> "_Sums":
        """Return the sums of manoeuvre ``m``."""
        rows = fit.assembly.owner == m
        channel, residual = fit.assembly.channel[rows], fit.residual[rows]
        parts = [(residual[channel == c], course.columns[channel == c]) for c in range(len(fit.noise))]
        return cls(
            course.knots,
            np.array([float(len(left)) for left, _ in parts]),
            np.array([left @ left for left, _ in parts]),
            np.array([columns.T @ left for left, columns in parts]),
            np.array([columns.T @ columns for _, columns in parts]),
        )

    def cost(self, noise: FloatArray, root: FloatArray) -> float:
        """Return -2 log likelihood under white noise (outputs,) and gusts with a covariance's factor (k,
        k)."""
        weight = noise**-2.0
        inner = root.T @ np.tensordot(weight, self.grams, 1) @ root
        lower = np.linalg.cholesky(inner + np.eye(len(root)))
        explained = np.linalg.solve(lower, root.T @ (weight @ self.pulls))
        white = self.counts @ np.log(noise**2) + weight @ self.squares
        return float(white + 2.0 * np.sum(np.log(np.diag(lower))) - explained @ explained)
