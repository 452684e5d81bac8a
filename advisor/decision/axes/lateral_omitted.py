"""Bias of the lateral derivatives due to influences that the lateral model omits (see ``decision.omitted``).

The roll and yaw equations of a rigid body contain (Iyy − Izz)/Ixx·q·r and (Ixx − Iyy)/Izz·p·q. An aircraft
has Ixx and Iyy of at most Izz. Both factors therefore have a size of at most one (Etkin & Reid, Dynamics of
Flight, 1996, ch. 4). L_r, N_p and L_β change with the angle of attack. Moments may depart from their growth
with V². The size of such changes is estimated from the residual.
"""

from collections.abc import Collection, Iterator
from math import sqrt

import numpy as np
from scipy.special import chdtri

from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.decision.consistency import OUTLIER_BELOW
from advisor.decision.omitted import Bias, beyond, bias_of, driven
from advisor.decision.verdict import Reason
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.model.axes.lateral import LATERAL, Trim, state_matrix
from advisor.oem.axes.lateral.estimate import LateralEstimate
from advisor.process.arrays import FloatArray

JUDGED = ("L_p", "L_delta_a", "N_beta", "N_r", "N_delta_r")
"""Derivatives whose bias is examined: those that a test of aileron or rudder determines."""
_P, _R = 1, 2
_FEWEST = 40
"""Least number of roll rate samples, two for each of the parameters in one equation and its neighbours."""


def side_coupled(maneuver: Maneuver, estimate: LateralEstimate, exceeded: Collection[str]) -> list[Reason]:
    """Return a reason for each omitted influence that biases a derivative beyond its 95 % interval.

    Parameters
    ----------
    exceeded
        Codes of the limits that the manoeuvre exceeds. Within all limits no influence is examined.
    """
    return list(_biased(maneuver, estimate)) if exceeded else []


def _biased(maneuver: Maneuver, estimate: LateralEstimate) -> Iterator[Reason]:
    linear = _Linear(maneuver, estimate, estimate.fits[0]["p"].t)
    if len(linear.t) < _FEWEST:
        return
    judged = [name for name in JUDGED if name[2:] not in ("delta_a", "delta_r") or _is_flown(name, estimate)]
    q, alpha, speed = (linear.deviation(name) for name in ("q", "alpha", "airspeed"))
    if q is not None:
        cure = "hold the nose still"
        for row, rate in ((_P, linear.states[_R]), (_R, linear.states[_P])):
            found = linear.bias(q * rate, row)
            if found is not None:
                yield from beyond(estimate, found.of_one, "coupling", "pitching with rolling", cure, judged)
    if alpha is not None:
        for row, state in ((_P, _R), (_R, _P), (_P, 0)):
            bias = _significant(linear.bias(alpha * linear.states[state], row))
            said = "the changing angle of attack"
            yield from beyond(estimate, bias, "alpha", said, "keep the nose where it is", judged)
    if speed is not None and estimate.scales_with_speed:
        growth = speed / float(np.mean(maneuver.channels["airspeed"].y))
        for row in (_P, _R):
            bias = _significant(linear.bias(growth * np.gradient(linear.states[row], linear.t), row))
            said = "the changing air speed"
            yield from beyond(estimate, bias, "airspeed", said, "smaller steps, from steady speed", judged)


def _is_flown(name: str, estimate: LateralEstimate) -> bool:
    return {"delta_a": "aileron", "delta_r": "rudder"}[name[2:]] in estimate.flown


def _significant(found: Bias | None) -> FloatArray:
    """Return the bias of a term of unknown size; zero for a size that the residual does not show."""
    if found is None or abs(found.ratio) < sqrt(float(chdtri(1, OUTLIER_BELOW))):
        return np.zeros(len(SIDE_PARAMETERS))
    return found.coefficient * found.of_one


def side_sensitivities(
    maneuver: Maneuver, estimate: LateralEstimate
) -> tuple[FloatArray, dict[str, FloatArray]]:
    """Return the stamps of the roll rate, and the sensitivities of the outputs there, shape (n, 24) each.

    The columns are the fifteen derivatives, three constants and four initial states of a linear model. The
    last two columns are the lateness of aileron and rudder, which every record determines anew.
    """
    linear = _Linear(maneuver, estimate, maneuver.channels["p"].t)
    by_aileron = linear.columns(linear.late("L_delta_a", "aileron"), _P)
    by_rudder = linear.columns(linear.late("N_delta_r", "rudder"), _R)
    return linear.t, {
        name: np.nan_to_num(np.column_stack([column, by_rudder[name][:, -1]]))
        for name, column in by_aileron.items()
    }


class _Linear:
    """Sensitivities of a lateral fit about straight flight, at the stamps of the roll rate."""

    def __init__(self, maneuver: Maneuver, estimate: LateralEstimate, t: FloatArray) -> None:
        self._maneuver, self._fits, self.t = maneuver, estimate.fits[0], t
        self._speed = float(np.mean(maneuver.channels["airspeed"].y)) if self._has("airspeed") else 1.0
        means = [float(np.mean(maneuver.channels[n].y)) if self._has(n) else 0.0 for n in ("alpha", "theta")]
        theta = np.where(np.isfinite(estimate.theta), estimate.theta, 0.0)
        self._theta = dict(zip(LATERAL.names.reported, theta.tolist(), strict=True))
        self._system = state_matrix(theta, Trim(max(self._speed, 1.0), *means))
        self._inputs = {name: self._moved(name) for name in LATERAL.inputs}
        driving = np.zeros((4, len(self.t), 1))
        for row, letter in enumerate("YLN"):
            for ending, control in (("delta_a", "aileron"), ("delta_r", "rudder")):
                driving[row, :, 0] += self._theta[f"{letter}_{ending}"] * self._inputs[control]
        self.states = driven(self._system, self.t, driving)[:, :, 0]
        """Shape (4, n): sideslip, roll rate, yaw rate and bank of the linear model."""

    def deviation(self, name: str) -> FloatArray | None:
        """Return a channel's deviation from its mean, shape (n,); None for a missing channel."""
        if not self._has(name):
            return None
        channel = self._maneuver.channels[name]
        y = np.interp(self.t, channel.t, channel.y)
        return np.asarray(y - np.mean(y))

    def late(self, derivative: str, control: str) -> FloatArray:
        """Return the acceleration by a control that acts one second earlier, shape (n,), rad/s²."""
        return np.asarray(self._theta[derivative] * np.gradient(self._inputs[control], self.t))

    def bias(self, term: FloatArray, row: int) -> Bias | None:
        """Return the bias due to an omitted part of an acceleration; None for a response that overflows.

        Parameters
        ----------
        term
            Shape (n,): omitted part of ṗ or ṙ for a coefficient of one, rad/s².
        row
            Index of the state with the omitted part.
        """
        columns = self.columns(term, row)
        outputs = [(fit, columns[name]) for name, fit in self._fits.items() if name in columns]
        return bias_of(outputs, self.t, len(SIDE_PARAMETERS))

    def columns(self, term: FloatArray, row: int) -> dict[str, FloatArray]:
        """Return the sensitivities of each output, shape (n, 23), with those by the omitted term last."""
        beta, p, r, _ = self.states
        regressors = np.stack([beta, p, r, self._inputs["aileron"], self._inputs["rudder"], np.ones_like(p)])
        k = len(regressors)
        inputs = np.zeros((4, len(self.t), 3 * k + 5))
        for equation in range(3):
            inputs[equation, :, equation * k : (equation + 1) * k] = regressors.T
        inputs[row, :, -1] = term
        initial = np.zeros((4, inputs.shape[2]))
        initial[range(4), range(3 * k, 3 * k + 4)] = 1.0
        with np.errstate(over="ignore", invalid="ignore"):
            states = driven(self._system, self.t, inputs, initial)
            force = inputs[0] + sum(
                self._theta[name] * states[i] for i, name in enumerate(("Y_beta", "Y_p", "Y_r"))
            )
        force[:, -1] -= inputs[0, :, -1]
        columns = {"p": states[1], "r": states[2], "bank": states[3], "beta": states[0]}
        columns["a_y"] = self._speed * force
        # The fifteen derivatives in their order come before the constants.
        order = [e * k + i for e in range(3) for i in range(k - 1)] + [e * k + k - 1 for e in range(3)]
        order += range(3 * k, 3 * k + 5)
        return {name: column[:, order] for name, column in columns.items()}

    def _has(self, name: str) -> bool:
        return name in self._maneuver.channels and len(self._maneuver.channels[name]) > 1

    def _moved(self, name: str) -> FloatArray:
        found = self.deviation(name)
        return np.zeros(len(self.t)) if found is None else found
