"""First estimates of the derivatives by equation error: regression of rates on angle, pitch rate and
command."""

from typing import NamedTuple

import numpy as np

from advisor.flight.signals.derived_alpha import integrated
from advisor.gap.records.flights import PreparedManeuver, PreparedManeuvers
from advisor.process.arrays import FloatArray

_STEP_S = 0.02
"""Numerical: step of the regression's time grid, s."""
_SPAN = 10
"""Numerical: number of steps over which the equations are integrated, so that no measurement is
differentiated."""
_RIDGE = 1e-6
"""Numerical: ridge of the regression, relative to a regressor's mean square, for directions without
excitation."""
_SIMULTANEOUS = 0.01
"""Numerical: product of both equations' residual shares below which no shift of a channel is tried."""
_BETTER = 0.5
"""Numerical: ratio of residual shares with and without a shift, below which the shifted regression becomes a
start.
"""


class Late(NamedTuple):
    """Delay of each channel for the regression, s."""

    alpha_s: float = 0.0
    q_s: float = 0.0
    surface_s: float = 0.0
    """Delay of the surface behind the command, s."""


_SHIFTS_S = (-0.12, -0.08, -0.04, 0.04, 0.08, 0.12)
"""Numerical: shifts of a channel that are tried, s: up to about one radian of a fast short period."""
_ONE_LATE = (
    *(Late(q_s=shift) for shift in _SHIFTS_S),
    *(Late(alpha_s=shift) for shift in _SHIFTS_S),
    *(Late(surface_s=shift) for shift in (0.04, 0.08, 0.12, 0.16)),
)


def regressions(flights: PreparedManeuvers) -> list[FloatArray]:
    """Return starting values of the derivatives, each of shape (6,).

    A channel with a delay near a radian of the short period spoils the regression, even in sign. No search
    converges from a wrong sign of a derivative. The regression with the late channel shifted is then a second
    start.
    """
    as_stamped, left_share = _regressed(flights, Late())
    if left_share < _SIMULTANEOUS:
        return [as_stamped]
    shifted, less = min((_regressed(flights, late) for late in _ONE_LATE), key=lambda pair: pair[1])
    return [as_stamped, shifted] if less < _BETTER * left_share else [as_stamped]


def _regressed(flights: PreparedManeuvers, late: Late) -> tuple[FloatArray, float]:
    """Return derivatives, shape (6,), and the product of the residual shares of the two equations."""
    systems = [_system(flight, late) for flight in flights.flights]
    moment, left_share = _solved([s[0] for s in systems], [s[1] for s in systems])
    force, left_of_lift = np.zeros(2), 1.0
    if "alpha" in flights.channels:
        force, left_of_lift = _solved([s[2] for s in systems], [s[3] for s in systems])
    damped = min(force[0], -0.1), min(moment[1], -0.05)
    return np.array([damped[0], 0.0, force[1], moment[0], damped[1], moment[2]]), left_share * left_of_lift


def _system(f: PreparedManeuver, late: Late) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return regressors and rates of the moment equation and of the force equation, in integral form."""
    t = np.arange(0.0, f.duration_s, _STEP_S)
    q = f.outputs["q"].at(t + late.q_s)
    d = np.interp(t - late.surface_s, f.t_u, f.u) - f.u_trim
    a = np.zeros(len(t))
    if "alpha" in f.outputs:
        a = f.outputs["alpha"].at(t + late.alpha_s) - f.alpha_trim

    def windowed(y: FloatArray) -> FloatArray:
        total = integrated(t, y)
        return total[_SPAN:] - total[:-_SPAN]

    X = np.column_stack([windowed(a), windowed(q), windowed(d)])
    X = X - X.mean(axis=0)
    dq, da = q[_SPAN:] - q[:-_SPAN], a[_SPAN:] - a[:-_SPAN] - windowed(q)
    return X, dq - dq.mean(), X[:, [0, 2]], da - da.mean()


def _solved(rows: list[FloatArray], rates: list[FloatArray]) -> tuple[FloatArray, float]:
    """Return the ridge regression, and the share of the power in its residual."""
    X, y = np.vstack(rows), np.concatenate(rates)
    scale = np.sqrt(np.mean(X**2, axis=0)) + 1e-12
    Xs = X / scale
    theta = np.linalg.solve(Xs.T @ Xs + _RIDGE * len(X) * np.eye(X.shape[1]), Xs.T @ y)
    residual = y - Xs @ theta
    return theta / scale, float(residual @ residual) / max(float(y @ y), 1e-300)
