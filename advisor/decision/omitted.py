"""Bias of the derivatives due to an omitted influence, and reasons against a manoeuvre because of the bias.

S holds the sensitivities of the fitted outputs with respect to the parameters. s is the response to the
omitted term with the coefficient one. W is the inverse of the noise's covariance. Near the optimum the
parameters take up

    Δθ = (SᵀWS)⁻¹·SᵀW·s

for each unit of the coefficient (omitted-variable bias; Greene, Econometric Analysis, 2012, ch. 4). An
unknown coefficient is estimated from the residual, by least squares with s as an additional column. The
residual's lag-1 correlation is removed first.

The pitch equation of a rigid body is q̇ = M/Iyy + (Izz − Ixx)/Iyy·p·r. Every body has Izz ≤ Ixx + Iyy, and an
aircraft has Ixx ≤ Izz, so that the factor lies between 0 and 1. The largest bias by rolling and yawing is
therefore known without aerodynamics and without the inertias (Etkin & Reid, Dynamics of Flight, 1996, ch. 4).
Sideslip in a roll turns the path by −p·β, which is known where β is measured.
The effects of throttle, aileron and rudder, and a moment that does not grow with V², are estimated from the
residual.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np
from scipy.linalg import expm
from scipy.special import chdtri

from advisor.aircraft.reference import PARAMETERS
from advisor.decision.consistency import OUTLIER_BELOW
from advisor.decision.verdict import Reason
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import ChannelFit, Estimate
from advisor.process.arrays import FloatArray
from advisor.words.digits import distinct_texts
from advisor.words.quantiles import NORMAL_95
from advisor.words.quantities import symbol

_OUTPUTS = ("alpha", "q", "a_z")
_LOCAL = 2
"""Number of initial states of each manoeuvre."""
_FEWEST = 20
"""Least number of pitch rate samples, two for each of ten parameters."""


@dataclass(frozen=True, slots=True)
class Bias:
    """Bias of the eight parameters due to one omitted term."""

    of_one: FloatArray
    """Shape (8,): change of the parameters for a coefficient of one."""
    coefficient: float
    """Coefficient of the omitted term, estimated from the residual."""
    ratio: float
    """Coefficient of the omitted term over its standard deviation."""


def bias_by(maneuver: Maneuver, estimate: Estimate, term: FloatArray) -> Bias | None:
    """Return the bias due to an omitted moment; None for a constant moment, for too short a fit,
    and for a model whose response overflows.

    Parameters
    ----------
    term
        Shape (n,): omitted part of q̇ for a coefficient of one, at the stamps of the fitted pitch rate.
    """
    fits = estimate.fits[0]
    t = fits["q"].t
    if len(t) < _FEWEST or not np.ptp(term) > 0.0:
        return None
    elevator = maneuver.channels["elevator"]
    moved = np.interp(t, elevator.t, elevator.y)
    with np.errstate(over="ignore", invalid="ignore"):
        columns = _columns(estimate, t, moved - moved[0], term)
    return bias_of([(fits[name], columns[name]) for name in _OUTPUTS if name in fits], t, len(PARAMETERS))


def sensitivities(maneuver: Maneuver, estimate: Estimate) -> tuple[FloatArray, dict[str, FloatArray]]:
    """Return the stamps of the pitch rate, and the sensitivities of the outputs there, shape (n, 11) each.

    The columns are the eight parameters and two initial states of a linear model with an estimate's values.
    The last column is the lateness of the elevator, which every record determines anew.
    """
    t, elevator = maneuver.channels["q"].t, maneuver.channels["elevator"]
    moved = behind(t, np.interp(t, elevator.t, elevator.y) - elevator.y[0], estimate.servo_lag_s)
    late = estimate.value("M_delta_e") * np.gradient(moved, t)
    with np.errstate(over="ignore", invalid="ignore"):
        columns = _columns(estimate, t, moved, late)
    return t, {name: np.nan_to_num(column) for name, column in columns.items()}


def bias_of(outputs: Sequence[tuple[ChannelFit, FloatArray]], t: FloatArray, derivatives: int) -> Bias | None:
    """Return the bias of the first ``derivatives`` parameters; None for a response that overflows.

    Parameters
    ----------
    outputs
        Fit of each output, and its sensitivities at the times ``t``, shape (n, m), the omitted term last.
    """
    if not all(np.all(np.isfinite(column)) for _, column in outputs):
        return None  # The response of a fast unstable model overflows, and tells no bias.
    taken, _, _ = _regressed([_rows(fit, t, column, 0.0) for fit, column in outputs])
    # Coloured residuals make a term look significant that only follows their colour.
    _, coefficient, ratio = _regressed([_rows(fit, t, column, fit.lag1) for fit, column in outputs])
    return Bias(taken[:derivatives], coefficient, ratio)


def _regressed(outputs: list[tuple[FloatArray, FloatArray]]) -> tuple[FloatArray, float, float]:
    """Return the known columns' share of the last column, its coefficient, and that over its std."""
    rows = np.vstack([rows for rows, _ in outputs])
    residual = np.concatenate([left for _, left in outputs])
    size = np.maximum(np.linalg.norm(rows, axis=0), 1e-300)
    known, omitted = rows[:, :-1] / size[:-1], rows[:, -1] / size[-1]
    taken = np.linalg.lstsq(known, omitted, rcond=None)[0]
    rest = omitted - known @ taken
    power = max(float(rest @ rest), 1e-300)
    coefficient = float(rest @ residual) / power
    ratio = coefficient * float(np.sqrt(power)) / max(float(np.std(residual)), 1e-300)
    return taken / size[:-1] * size[-1], coefficient / float(size[-1]), ratio


def _columns(estimate: Estimate, t: FloatArray, moved: FloatArray, term: FloatArray) -> dict[str, FloatArray]:
    """Return the sensitivities of each output, shape (n, 11): eight parameters, two states, the term."""
    z_alpha, z_q, z_delta, m_alpha, m_q, m_delta = (
        estimate.value(name) for name in ("Z_alpha", "Z_q", "Z_delta_e", "M_alpha", "M_q", "M_delta_e")
    )
    system = np.array([[z_alpha, 1.0 + z_q], [m_alpha, m_q]])
    alpha, q = driven(system, t, np.stack([z_delta * moved, m_delta * moved])[:, :, None])[:, :, 0]
    regressors = np.stack([np.ones(len(t)), alpha, q, moved], axis=1)
    inputs = np.zeros((2, len(t), 2 * regressors.shape[1] + _LOCAL + 1))
    inputs[0, :, :4] = inputs[1, :, 4:8] = regressors
    inputs[1, :, -1] = term
    initial = np.zeros((2, inputs.shape[2]))
    initial[0, 8] = initial[1, 9] = 1.0
    states = driven(system, t, inputs, initial)
    force = z_alpha * states[0] + z_q * states[1] + inputs[0]
    force[:, -1] -= inputs[0, :, -1]  # A turn of the path is no force.
    return {"alpha": states[0], "q": states[1], "a_z": (estimate.airspeed_m_s or 1.0) * force}


def driven(
    system: FloatArray, t: FloatArray, inputs: FloatArray, initial: FloatArray | None = None
) -> FloatArray:
    """Return the states, shape (k, n, m), of the linear system for m sets of inputs, shape (k, n, m)."""
    states = np.zeros_like(inputs)
    if initial is not None:
        states[:, 0] = initial
    step_s = float(np.median(np.diff(t)))
    one = expm(system * step_s)
    for k in range(1, len(t)):
        held = states[:, k - 1] + 0.5 * step_s * inputs[:, k - 1]
        states[:, k] = one @ held + 0.5 * step_s * inputs[:, k]
    return states


def behind(t: FloatArray, command: FloatArray, lag_s: float) -> FloatArray:
    """Return the course of a servo with a first-order lag, s, for a command that begins at zero."""
    if not lag_s > 0.0:
        return command
    return driven(np.array([[-1.0 / lag_s]]), t, (command / lag_s)[None, :, None])[0, :, 0]


def _rows(fit: ChannelFit, t: FloatArray, columns: FloatArray, lag1: float) -> tuple[FloatArray, FloatArray]:
    """Return an output's sensitivities and residual over its std, without the correlation ``lag1``."""
    at_fit = np.stack([np.interp(fit.t, t, column) for column in columns.T], axis=1)
    keep = min(max(lag1, 0.0), 0.99)
    rows, left = (both[1:] - keep * both[:-1] for both in (at_fit, fit.residual))
    spread = max(float(np.std(left)), 1e-3 * fit.noise, 1e-300)
    return rows / spread, left / spread


_JUDGED = ("M_alpha", "M_q", "M_delta_e", "Z_alpha")
"""Derivatives whose bias is examined."""


def coupled(maneuver: Maneuver, estimate: Estimate, exceeded: Collection[str] = ()) -> list[Reason]:
    """Return a reason for each omitted influence that biases a derivative beyond its 95 % interval.

    Parameters
    ----------
    exceeded
        Codes of the limits that the manoeuvre exceeds. Air speed, aileron and rudder are examined beyond
        their limits only.
    """
    return [
        *_rolling_with_yawing(maneuver, estimate),
        *(_changing_speed(maneuver, estimate) if "airspeed" in exceeded else ()),
        *_moved(maneuver, estimate, "throttle", "leave it where it is"),
        *(
            reason
            for control in ("aileron", "rudder")
            if control in exceeded
            for reason in _moved(maneuver, estimate, control, f"use less {control}")
        ),
    ]


def _rolling_with_yawing(maneuver: Maneuver, estimate: Estimate) -> list[Reason]:
    if not {"p", "r"} <= maneuver.channels.keys():
        return []
    found = bias_by(maneuver, estimate, _at_fit(maneuver, estimate, "p") * _at_fit(maneuver, estimate, "r"))
    if found is None:
        return []
    cure = "let roll and yaw die down before the first step"
    return beyond(estimate, found.of_one, "coupling", "rolling and yawing", cure)


def _changing_speed(maneuver: Maneuver, estimate: Estimate) -> list[Reason]:
    """Return a reason if moments that do not grow with V² have moved an estimate."""
    if "airspeed" not in maneuver.channels or not carries_speed(estimate):
        return []
    speed, q = _at_fit(maneuver, estimate, "airspeed"), estimate.fits[0]["q"]
    term = (speed / float(np.mean(speed)) - 1.0) * np.gradient(q.fitted, q.t)
    cure = "smaller steps, from steady speed"
    return _by_residual(maneuver, estimate, term, "airspeed", "the changing air speed", cure)


def has_banking(maneuver: Maneuver) -> bool:
    """Return whether a record contains all that a banked flight adds to the motion in pitch."""
    return {"p", "r", "bank", "beta", "theta"} <= maneuver.channels.keys()


def carries_speed(estimate: Estimate) -> bool:
    """Return whether the derivatives of an estimate grow with the measured air speed."""
    return estimate.airspeed_m_s is not None


def _moved(maneuver: Maneuver, estimate: Estimate, channel: str, cure: str) -> list[Reason]:
    """Return a reason if the pitching moment of another control has moved an estimate."""
    if channel not in maneuver.channels:
        return []
    term = _at_fit(maneuver, estimate, channel)
    return _by_residual(maneuver, estimate, term, channel, f"the {channel}'s pitching moment", cure)


def _by_residual(
    maneuver: Maneuver, estimate: Estimate, term: FloatArray, code: str, what: str, cure: str
) -> list[Reason]:
    """Return a reason if a term of unknown size, as estimated from the residual, moves an estimate."""
    found = bias_by(maneuver, estimate, term)
    # The statistic is the likelihood ratio of the two models, one with the term.
    if found is None or abs(found.ratio) < sqrt(float(chdtri(1, OUTLIER_BELOW))):
        return []
    return beyond(estimate, found.coefficient * found.of_one, code, what, cure)


def _at_fit(maneuver: Maneuver, estimate: Estimate, name: str) -> FloatArray:
    channel = maneuver.channels[name]
    return np.interp(estimate.fits[0]["q"].t, channel.t, channel.y)


def beyond(
    estimate: Estimate,
    bias: FloatArray,
    code: str,
    what: str,
    cure: str,
    judged: Sequence[str] = _JUDGED,
) -> list[Reason]:
    """Return a reason with the derivative whose bias exceeds its interval most; empty without one."""
    half = NORMAL_95 * estimate.std
    places = {name: estimate.names.index(name) for name in judged if name not in estimate.not_identifiable}
    share = {name: abs(float(bias[k]) / float(half[k])) for name, k in places.items() if half[k] > 0.0}
    name = max(share, key=lambda name: share[name], default="")
    if not name or share[name] <= 1.0:
        return []
    shown, most = distinct_texts(share[name], 1.0, 1)
    text = f"{what} may move {symbol(name)} by {shown} times its interval (limit {most}); {cure}"
    return [Reason(code, text, share[name], 1.0)]
