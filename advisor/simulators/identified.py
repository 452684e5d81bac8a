"""Linear models of a simulator from two flights with opposite inputs.

Half the difference of both flights holds the odd part of the motion, in which every term of even order
cancels. For a linear simulator the odd part is the motion itself, so that the derivatives are exact.

Pitch is an output-error fit with the servo's lag and dead time. Roll and yaw are the one-step equation
x(k+1) = Φ·x(k) + Γ·u(k), whose logarithm gives the derivatives.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.linalg import expm, logm
from scipy.optimize import least_squares
from scipy.signal import lfilter

from advisor.gap.result import Value
from advisor.gap.simulator.layout import DERIVATIVES
from advisor.process.arrays import FloatArray
from advisor.simulators.protocol import Replay
from advisor.words.problems import UnusableInputError

_STATES = ("beta", "p", "r", "bank")
_EDGE_STEPS = 2.5
"""Steps after an edge of the input without a comparison of a_z. A simulator may state the force before or
after the edge."""
_STARTS_S = (0.0, 0.05)
"""Starts of the servo's lag and of its dead time, s. The cost has local minima in a dead time."""
_AT_REST = 1e-9
"""Range of a state, relative to the largest one, rad or rad/s, below which the state counts as at rest."""
_EXACT = 1e-4
"""Root mean square of the residual, in units of an output's range, at which no other start is tried."""
_CONVERGED = 1e-9
"""Relative change of the cost or of the parameters that ends the search."""
_MOST_EVALUATIONS = 60
"""Largest number of Jacobians of one search."""
_AT_ONCE_S = 1e-7
"""Lag, s, below which the surface follows its command at once."""


@dataclass(frozen=True)
class IdentifiedPitch:
    """Short period of a simulator, and the servo before its elevator."""

    derivatives: Mapping[str, Value]
    lag_s: Value
    dead_time_s: Value


def odd_part(up: Replay, down: Replay, name: str, t: FloatArray) -> FloatArray:
    """Return half the difference of an output of two flights at the times ``t``, shape (n,)."""
    rows = [np.interp(t, replay.t, getattr(replay, name)) for replay in (up, down)]
    half: FloatArray = 0.5 * (rows[0] - rows[1])
    return half


def identified_pitch(replay: Replay, other: Replay, t: FloatArray, elevator: FloatArray) -> IdentifiedPitch:
    """Return derivatives, lag and dead time with their standard deviations.

    Parameters
    ----------
    replay, other
        Flights with ``elevator`` and with its opposite.
    t, elevator
        Shape (n,): middle times of the input's steps, s, and the elevator's deflection in each step, rad.

    Raises
    ------
    UnusableInputError
        No linear model describes the flights.
    """
    fit = _PitchFit(replay, other, t, elevator)
    best = None
    for lag_s, delay_s in product(_STARTS_S, _STARTS_S):
        start = np.array([*fit.regressed(delay_s), lag_s, delay_s])
        lower = np.array([*np.full(len(start) - 2, -np.inf), 0.0, 0.0])
        optimum = least_squares(
            fit.residual, start, bounds=(lower, np.inf), x_scale="jac",
            xtol=_CONVERGED, ftol=_CONVERGED, gtol=None, max_nfev=_MOST_EVALUATIONS,
        )  # fmt: skip
        best = optimum if best is None or optimum.cost < best.cost else best
        if 2.0 * best.cost < len(best.fun) * _EXACT**2:
            break
    if best is None or not np.all(np.isfinite(best.x)):
        raise UnusableInputError(
            "simulator_replay", "No linear model describes the simulator.", "Check the simulator's outputs."
        )
    std = _standard_deviations(np.asarray(best.jac), best.fun, fit.sizes)
    values = [Value(float(x), float(s)) for x, s in zip(best.x, std, strict=True)]
    return IdentifiedPitch(dict(zip(DERIVATIVES, values, strict=False)), *values[-2:])


def _standard_deviations(jacobian: FloatArray, residual: FloatArray, sizes: Sequence[int]) -> FloatArray:
    """Return the standard deviations, shape (k,), for residuals that are correlated in time."""
    covariance = np.linalg.pinv(jacobian.T @ jacobian)
    free = max(len(residual) - jacobian.shape[1], 1)
    variance = (
        float(residual @ residual) / free * max(map(_colour, np.split(residual, np.cumsum(sizes)[:-1])))
    )
    result: FloatArray = np.sqrt(np.maximum(variance * np.diag(covariance), 0.0))
    return result


def _colour(residual: FloatArray) -> float:
    """Return the factor by which the correlation of a series widens the variance of a mean."""
    power = float(residual @ residual)
    if power <= 0.0:
        return 1.0
    size = 2 * len(residual)
    spectrum = np.abs(np.fft.rfft(residual, size)) ** 2
    correlation = np.fft.irfft(spectrum, size)[: len(residual)] / power
    crossing = int(np.argmax(correlation <= 0.0)) or len(correlation)
    return max(1.0 + 2.0 * float(np.sum(correlation[1:crossing])), 1.0)


class _PitchFit:
    """Odd part of two flights, and its residual from a linear model."""

    def __init__(self, up: Replay, down: Replay, t: FloatArray, elevator: FloatArray) -> None:
        self._h, self._speed = float(t[1] - t[0]), float(up.airspeed_m_s[0])
        self._elevator = elevator
        self._ends: FloatArray = np.arange(len(t) + 1, dtype=np.float64) * self._h
        own: FloatArray = up.t[up.t <= self._ends[-1]]
        self._own = own
        self._alpha, self._q = (odd_part(up, down, name, own) for name in ("alpha", "q"))
        faster = odd_part(up, down, "airspeed_m_s", own)
        along = [np.interp(own, flown.t, _lift_axis_force(flown)) for flown in (up, down)]
        self._normal = 0.5 * (along[0] - along[1]) / self._speed
        self._faster = odd_part(up, down, "airspeed_m_s", t) / self._speed
        self._moves_speed = bool(np.ptp(self._faster) > 0.0)
        self._faster_own = faster / self._speed
        edges = self._ends[1:-1][np.diff(elevator) != 0.0]
        step = max(self._h, float(np.median(np.diff(own))))
        since = own[:, None] - edges[None, :]
        self._calm = ~np.any((since > -_EDGE_STEPS * step) & (since < _EDGE_STEPS * step), axis=1)
        self._scales = [max(float(np.ptp(y)), 1e-12) for y in (self._alpha, self._q, self._normal)]
        self.sizes = (len(own), len(own), int(np.sum(self._calm)))

    def regressed(self, delay_s: float) -> FloatArray:
        """Return derivatives of both equations from the integrated motion, for a start."""
        moved = np.interp(self._own - delay_s, self._ends[1:] - 0.5 * self._h, self._elevator)
        motion = [self._alpha, self._q, moved, *([self._faster_own] if self._moves_speed else [])]
        force, *_ = np.linalg.lstsq(np.column_stack(motion), self._normal, rcond=None)
        dt = np.diff(self._own)
        integrals = [np.concatenate([[0.0], np.cumsum(0.5 * dt * (y[1:] + y[:-1]))]) for y in motion]
        moment, *_ = np.linalg.lstsq(np.column_stack(integrals), self._q, rcond=None)
        return np.array([*force[:3], *moment[:3], *force[3:], *moment[3:]])

    def residual(self, x: FloatArray) -> FloatArray:
        """Return the differences of α, q and normal force from the model, in units of their ranges."""
        z, m = x[:3], x[3:6]
        by_speed = x[6:8] if self._moves_speed else np.zeros(2)
        at_ends, mean = self._surface(*x[-2:])
        a = np.array([[z[0], 1.0 + z[1]], [m[0], m[1]]])
        b = np.array([[z[2], by_speed[0]], [m[2], by_speed[1]]])
        states = _flown(a, b, np.column_stack([mean, self._faster]), self._h)
        alpha, q = (np.interp(self._own, self._ends, y) for y in states.T)
        moved = np.interp(self._own, self._ends, at_ends)
        normal = z[0] * alpha + z[1] * q + z[2] * moved + by_speed[0] * self._faster_own
        rows = (self._alpha - alpha, self._q - q, (self._normal - normal)[self._calm])
        return np.concatenate([row / scale for row, scale in zip(rows, self._scales, strict=True)])

    def _surface(self, lag_s: float, delay_s: float) -> tuple[FloatArray, FloatArray]:
        """Return the deflection at the ends of the steps, shape (n + 1,), and the mean in each step, (n,)."""
        area = np.concatenate([[0.0], np.cumsum(self._elevator * self._h)])
        late = np.interp(self._ends - delay_s, self._ends, area)
        command = np.diff(late) / self._h
        if lag_s < _AT_ONCE_S:
            return np.concatenate([command, command[-1:]]), command
        stays = float(np.exp(-self._h / lag_s))
        held = lag_s / self._h * (1.0 - stays)
        at_ends = np.concatenate([[0.0], lfilter([1.0 - stays], [1.0, -stays], command)])
        return at_ends, command + held * (at_ends[:-1] - command)


def _lift_axis_force(flown: Replay) -> FloatArray:
    """Return the specific force across the path in the plane of symmetry, m/s², which turns the path."""
    if flown.a_x is None:
        return np.asarray(flown.a_z)
    force: FloatArray = flown.a_z * np.cos(flown.alpha) - flown.a_x * np.sin(flown.alpha)
    return force


def _flown(a: FloatArray, b: FloatArray, inputs: FloatArray, h: float) -> FloatArray:
    """Return the states at the ends of all steps, shape (n + 1, 2), for inputs (n, k) that a step holds."""
    joined = np.zeros((4, 4))
    joined[:2, :2], joined[:2, 2:] = a * h, b * h
    stepped = expm(np.clip(joined, -30.0, 30.0))
    pushed = inputs @ stepped[:2, 2:].T
    before = np.concatenate([np.zeros((1, 2)), pushed[:-1]])
    # Each state alone follows the characteristic polynomial of the step (Cayley and Hamilton).
    (p11, p12), (p21, p22) = stepped[:2, :2]
    driven = pushed - before @ np.array([[p22, -p21], [-p12, p11]])
    states = lfilter([1.0], [1.0, -p11 - p22, p11 * p22 - p12 * p21], driven, axis=0)
    flown: FloatArray = np.clip(np.nan_to_num(np.concatenate([np.zeros((1, 2)), states])), -1e6, 1e6)
    return flown


def identified_side(replay: Replay, other: Replay, t: FloatArray, moved: FloatArray) -> dict[str, Value]:
    """Return L and N by sideslip, rates and control (named ``u``), with standard deviations.

    Parameters
    ----------
    t, moved
        Shape (n,): middle times of the input's steps, s, and the control's deflection in each step, rad.
    """
    h = float(np.median(np.diff(replay.t)))
    grid = np.arange(0.0, min(replay.t[-1], t[-1]), h)
    x = np.column_stack([odd_part(replay, other, name, grid) for name in _STATES])
    area = np.concatenate([[0.0], np.cumsum(moved * (t[1] - t[0]))])
    ends = np.arange(len(area)) * (t[1] - t[0])
    mean = np.diff(np.interp(grid, ends, area)) / h
    moving = [k for k in range(len(_STATES)) if np.ptp(x[:, k]) > _AT_REST * np.max(np.ptp(x, axis=0))]
    x = x[:, moving]
    columns = np.column_stack([x[:-1], mean])
    steps, *_ = np.linalg.lstsq(columns, x[1:], rcond=None)
    joined = np.eye(len(moving) + 1)
    joined[:-1] = steps.T
    rates = np.real(logm(joined)) / h
    left = x[1:] - columns @ steps
    spread = np.sqrt(np.maximum(np.diag(np.linalg.pinv(columns.T @ columns)), 0.0)) / h
    names = [*(_STATES[k] for k in moving), "u"]
    derivatives = {f"{letter}_{name}": Value(0.0, 0.0) for letter in "LN" for name in ("beta", "p", "r", "u")}
    for letter, rate in (("L", "p"), ("N", "r")):
        if rate not in names:
            continue
        row = names.index(rate)
        noise = float(np.std(left[:, row])) * np.sqrt(_colour(left[:, row]))
        for k, name in enumerate(names):
            if name != "bank":
                derivatives[f"{letter}_{name}"] = Value(float(rates[row, k]), noise * float(spread[k]))
    return derivatives
