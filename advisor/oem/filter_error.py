"""Filter error: a second opinion when the air moves.

Output error takes every deviation for measurement noise. In turbulence the deviations are driven
through the aircraft, and a Kalman filter has to follow them (``turbulence``). Since filter and model are
linear about the fitted motion, it whitens residuals and sensitivities alike, and the estimate is least
squares of the whitened ones (Maine & Iliff, NASA RP-1168; Jategaonkar, *Flight Vehicle System
Identification*, chapter 5).
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numba import njit

from advisor.aircraft import PARAMETERS, Aircraft
from advisor.flight.maneuver import Maneuver
from advisor.flight.messages import FloatArray
from advisor.oem.estimate import ChannelFit, Estimate, NoEstimate
from advisor.oem.estimator import estimate, estimate_jointly
from advisor.oem.innovations import gains_of
from advisor.oem.turbulence import Turbulence, system_of, turbulence_in

_GROWTH = 25.0
"""Powers of e by which a model may grow over a record: one that runs away says nothing of the aircraft."""
_GRID_S = 0.005
"""Step of the linear model."""


def filter_error_estimate(
    maneuvers: Sequence[Maneuver],
    aircraft: Aircraft,
    start: Estimate | NoEstimate | None = None,
    found: Turbulence | None = None,
) -> Estimate | NoEstimate:
    """The eight parameters with the air's motion allowed for.

    One whitened Gauss-Newton step from the output error estimate, with sensitivities by differences of
    the fitted responses, repeated until it moves less than a tenth of its own error.

    Parameters
    ----------
    start
        Output error estimate of the same manoeuvres, where it is known already.
    found
        What ``turbulence_in`` said of it, where that is known already.

    Returns
    -------
    An estimate whose note says how it was made, or the output error's own failure.
    """
    if start is None:
        single = len(maneuvers) == 1
        start = estimate(maneuvers[0], aircraft) if single else estimate_jointly(maneuvers, aircraft)
    if isinstance(start, NoEstimate):
        return start
    if found is None:
        derived = any(m.channels["alpha"].provenance == "derived" for m in maneuvers)
        found = turbulence_in(start, seen_by_alpha=not derived)
    speed = start.airspeed_m_s or 20.0
    fitted_at = start.theta if start.theta_of_lowest_cost is None else start.theta_of_lowest_cost
    theta = fitted_at.copy()
    information, step = np.eye(len(theta)), np.zeros(len(theta))
    for _ in range(3):
        if any(_runs_away(theta, maneuver) for maneuver in maneuvers):
            return NoEstimate("not_converged", "The filter error estimate did not settle.")
        information, gradient = np.zeros((8, 8)), np.zeros(8)
        for maneuver, fits in zip(maneuvers, start.fits, strict=False):
            t, channel, columns = _linear(maneuver, fits, theta, fitted_at)
            white = gains_of(t, channel, np.append(system_of(start), speed), found.air).innovations(columns)
            own = white[:, 9:]
            project = np.linalg.qr(own)[0]
            kept = white[:, :9] - project @ (project.T @ white[:, :9])
            information += kept[:, 1:].T @ kept[:, 1:]
            gradient += kept[:, 1:].T @ kept[:, 0]
        scale = np.sqrt(np.maximum(np.diag(information), 1e-300))
        step = np.linalg.lstsq(information / np.outer(scale, scale), gradient / scale, rcond=1e-10)[0] / scale
        theta = theta + step
        if np.all(np.abs(step) < 0.1 / scale):
            break
    covariance = np.asarray(np.linalg.pinv(information, rcond=1e-12, hermitian=True), float)
    note = (
        f"Filter error: gusts of {np.degrees(found.gust_angle):.2f} deg allowed for." if found.present
        else "Filter error: no moving air found, noise of the instruments only."
    )  # fmt: skip
    return replace(
        start, theta=theta, covariance=covariance, covariance_cr=covariance, notes=(*start.notes, note)
    )


def _runs_away(theta: FloatArray, maneuver: Maneuver) -> bool:
    """Whether no linear model can be followed over the record: it diverges, or is too fast for the grid."""
    if not np.all(np.isfinite(theta)):
        return True
    z_a, z_q, m_a, m_q = (theta[PARAMETERS.index(name)] for name in ("Z_alpha", "Z_q", "M_alpha", "M_q"))
    eigenvalues = np.linalg.eigvals(np.array([[z_a, 1.0 + z_q], [m_a, m_q]]))
    record_s = float(np.ptp(maneuver.channels["q"].t))
    return bool(np.max(eigenvalues.real) * record_s > _GROWTH or np.max(np.abs(eigenvalues)) * _GRID_S > 1.0)


def _linear(
    maneuver: Maneuver, fits: Mapping[str, ChannelFit], theta: FloatArray, fitted_at: FloatArray
) -> tuple[FloatArray, np.ndarray, FloatArray]:
    """Times, channels, and columns: residual, eight sensitivities, then initial states and offsets.

    Responses of the linear model of Eqs. (1)-(2) to α, q, δe and a constant, driven by the fitted motion.
    """
    t_all, channel_all, column_all = [], [], []
    base = fits["q"].t[0]
    grid = np.arange(base, fits["q"].t[-1], _GRID_S)
    a = np.interp(grid, fits["alpha"].t, fits["alpha"].fitted)
    q = np.interp(grid, fits["q"].t, fits["q"].fitted)
    d = np.interp(grid, maneuver.channels["elevator"].t, maneuver.channels["elevator"].y)
    drives = np.zeros((10, 2, len(grid)))
    for k, signal in enumerate((np.ones_like(grid), a, q, d)):
        drives[k, 0], drives[4 + k, 1] = signal, signal
    drives[8, 0, 0], drives[9, 1, 0] = 1.0 / _GRID_S, 1.0 / _GRID_S
    names = PARAMETERS
    z_a, z_q = theta[names.index("Z_alpha")], theta[names.index("Z_q")]
    m_a, m_q = theta[names.index("M_alpha")], theta[names.index("M_q")]
    states = _respond(drives, _GRID_S, z_a, 1.0 + z_q, m_a, m_q)
    for c, name in enumerate(("alpha", "q")):
        fit = fits[name]
        response = np.column_stack([np.interp(fit.t, grid, states[k, c]) for k in range(10)])
        shift = response[:, :8] @ (theta - fitted_at)
        t_all.append(fit.t)
        channel_all.append(np.full(len(fit.t), c))
        column_all.append(np.column_stack([fit.residual - shift, response]))
    t = np.concatenate(t_all)
    order = np.argsort(t, kind="stable")
    return t[order], np.concatenate(channel_all)[order], np.vstack(column_all)[order]


@njit(cache=True)
def _respond(drives: FloatArray, h: float, z_a: float, z_q: float, m_a: float, m_q: float) -> FloatArray:
    """States (k, 2, n) of the linear model driven in both equations, by the midpoint rule."""
    k, _, n = drives.shape
    out = np.zeros((k, 2, n))
    for j in range(k):
        x, y = 0.0, 0.0
        for i in range(n - 1):
            u, v = drives[j, 0, i], drives[j, 1, i]
            dx, dy = z_a * x + z_q * y + u, m_a * x + m_q * y + v
            mx, my = x + 0.5 * h * dx, y + 0.5 * h * dy
            x += h * (z_a * mx + z_q * my + u)
            y += h * (m_a * mx + m_q * my + v)
            out[j, 0, i + 1], out[j, 1, i + 1] = x, y
    return out
