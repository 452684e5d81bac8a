"""Influences that the longitudinal model lacks and that move an estimate: rolling with yawing, the throttle.

The pitch equation of a rigid body holds q̇ = M/Iyy + (Izz − Ixx)/Iyy·p·r. Every body has Izz ≤ Ixx + Iyy, and
an aircraft has Ixx ≤ Izz, so that the factor lies between 0 and 1. The largest bias by rolling and yawing is
therefore known without aerodynamics and without the inertias (Etkin & Reid, Dynamics of Flight, 1996, ch. 4).
The effect of the throttle is estimated from the residual.
"""

from math import sqrt

import numpy as np
from scipy.special import chdtri

from advisor.aircraft.reference import PARAMETERS
from advisor.decision.consistency import OUTLIER_BELOW
from advisor.decision.omitted import bias_by
from advisor.decision.verdict import Reason
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.messages import FloatArray
from advisor.oem.estimate import Estimate
from advisor.words.digits import distinct_texts
from advisor.words.quantiles import NORMAL_95
from advisor.words.quantities import symbol

_JUDGED = ("M_alpha", "M_q", "M_delta_e", "Z_alpha")
"""Derivatives whose bias matters."""


def coupled(maneuver: Maneuver, estimate: Estimate) -> list[Reason]:
    """Return reasons where an influence that the model lacks moves a derivative out of its 95 % interval."""
    return [*_rolling_with_yawing(maneuver, estimate), *_throttle(maneuver, estimate)]


def _rolling_with_yawing(maneuver: Maneuver, estimate: Estimate) -> list[Reason]:
    if not {"p", "r"} <= maneuver.channels.keys():
        return []
    found = bias_by(maneuver, estimate, _at_fit(maneuver, estimate, "p") * _at_fit(maneuver, estimate, "r"))
    if found is None:
        return []
    cure = "let roll and yaw die down before the first step"
    return _beyond(estimate, found.of_one, "coupling", "rolling and yawing", cure)


def _throttle(maneuver: Maneuver, estimate: Estimate) -> list[Reason]:
    if "throttle" not in maneuver.channels:
        return []
    found = bias_by(maneuver, estimate, _at_fit(maneuver, estimate, "throttle"))
    # The statistic is the likelihood ratio of the two models, one with the throttle.
    if found is None or abs(found.ratio) < sqrt(float(chdtri(1, OUTLIER_BELOW))):
        return []
    bias = found.coefficient * found.of_one
    return _beyond(estimate, bias, "throttle", "the throttle's pitching moment", "leave it where it is")


def _at_fit(maneuver: Maneuver, estimate: Estimate, name: str) -> FloatArray:
    """Return a channel at the stamps of the fitted pitch rate."""
    channel = maneuver.channels[name]
    return np.interp(estimate.fits[0]["q"].t, channel.t, channel.y)


def _beyond(estimate: Estimate, bias: FloatArray, code: str, what: str, cure: str) -> list[Reason]:
    """Return a reason with the derivative that the bias moves farthest beyond its interval; empty within."""
    half = NORMAL_95 * estimate.std
    share = {name: abs(float(bias[k]) / float(half[k])) for name, k in _PLACES.items() if half[k] > 0.0}
    name = max(share, key=lambda name: share[name], default="")
    if not name or share[name] <= 1.0:
        return []
    shown, most = distinct_texts(share[name], 1.0, 1)
    text = f"{what} may move {symbol(name)} by {shown} times its interval (limit {most}); {cure}"
    return [Reason(code, text, share[name], 1.0)]


_PLACES = {name: PARAMETERS.index(name) for name in _JUDGED}
