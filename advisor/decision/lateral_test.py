"""The lateral flight test: what all accepted manoeuvres tell together, whether to stop, and what to fly next.

Estimates of single manoeuvres are pooled by their information. A manoeuvre without a rudder tells nothing of
the rudder's derivatives, and those are no part of its information. Where the manoeuvres scatter more than
their errors allow, every error is enlarged by the Birge ratio (Birge, *Physical Review* 40, 1932).
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.decision.advice import ENOUGH
from advisor.decision.lateral_advice import FlownInput, next_lateral
from advisor.decision.tolerance import SHARE
from advisor.decision.verdict import (
    INFORMATION_LIMIT_PERCENT,
    FlightTestVerdict,
    NextInput,
    RuleProgress,
)
from advisor.flight.signals.messages import FloatArray
from advisor.model.lateral import LATERAL
from advisor.oem.lateral_estimate import LateralEstimate
from advisor.words.quantiles import NORMAL_95

JUDGED: Mapping[str, str] = {
    "L_p": "aileron",
    "L_delta_a": "aileron",
    "N_beta": "rudder",
    "N_delta_r": "rudder",
}
"""Derivatives that must meet their tolerance, and the control whose input tells each best."""
NOT_FLOWN = "No test input of the aileron or the rudder has been flown."
"""Sentence of a flight without a lateral manoeuvre."""
_PLACES = {name: LATERAL.names.reported.index(name) for name in JUDGED}
_CONTROL_OF = {f"{letter}_{suffix}": name for letter in "YLN" for suffix, name in
               (("delta_a", "aileron"), ("delta_r", "rudder"))}  # fmt: skip
_UNKNOWN = 1e-9
"""Least eigenvalue of the pooled information, normalised to a unit diagonal. Below it nothing is known."""


@dataclass(frozen=True, slots=True)
class LateralKnowledge:
    """Knowledge from all accepted manoeuvres together."""

    theta: FloatArray
    """(15,) derivatives; NaN where no manoeuvre tells one."""
    std: FloatArray
    """(15,) standard deviations; infinite where no manoeuvre tells one."""
    flown: frozenset[str]
    """Controls that were flown."""

    def percent(self, tolerance_percent: float) -> Mapping[str, float]:
        """Return each judged derivative's 95 % half-width, % of its tolerance; infinite for an unknown
        one."""
        found = {}
        for name, k in _PLACES.items():
            size = 0.01 * SHARE * tolerance_percent * abs(self.theta[k])
            known = math.isfinite(self.std[k]) and size > 0.0 and JUDGED[name] in self.flown
            found[name] = 100.0 * NORMAL_95 * float(self.std[k]) / size if known else math.inf
        return found


def lateral_knowledge(estimates: Sequence[LateralEstimate]) -> LateralKnowledge:
    """Return the knowledge from accepted estimates, in any order."""
    n = len(LATERAL.names.reported)
    information, pull = np.zeros((n, n)), np.zeros(n)
    parts = []
    for one in estimates:
        told = [k for k, name in enumerate(LATERAL.names.reported) if _CONTROL_OF.get(name, "") in
                ("", *one.flown)]  # fmt: skip
        own = np.linalg.pinv(one.estimate.covariance[np.ix_(told, told)], hermitian=True)
        information[np.ix_(told, told)] += own
        pull[told] += own @ one.estimate.theta[told]
        parts.append((told, own, one.estimate.theta[told]))
    known = np.diag(information) > 0.0
    theta, std = np.full(n, np.nan), np.full(n, np.inf)
    if known.any():
        covariance = _inverse(information[np.ix_(known, known)])
        theta[known] = covariance @ pull[known]
        std[known] = np.sqrt(np.diag(covariance))
    distance, freedom = 0.0, -int(np.count_nonzero(known))
    for told, own, found in parts:
        apart = found - theta[told]
        distance += float(apart @ own @ apart)
        freedom += len(told)
    birge = math.sqrt(max(distance / freedom, 1.0)) if freedom > 0 else 1.0
    return LateralKnowledge(theta, std * birge, frozenset(name for one in estimates for name in one.flown))


def _inverse(information: FloatArray) -> FloatArray:
    scale = 1.0 / np.sqrt(np.diag(information))
    values, vectors = np.linalg.eigh(information * np.outer(scale, scale))
    kept = 1.0 / np.maximum(values, _UNKNOWN)
    return np.asarray((vectors * kept) @ vectors.T * np.outer(scale, scale))


def lateral_flight_test(
    history: Sequence[LateralEstimate | None], aircraft: Aircraft, flown: Sequence[FlownInput] = ()
) -> FlightTestVerdict:
    """Return whether the lateral test may stop, and the next input.

    Parameters
    ----------
    history
        Estimate of every manoeuvre in the order flown; None for one that was not accepted.
    aircraft
        The crew's aircraft file, with its tolerance.
    flown
        Inputs of all manoeuvres, accepted or not.
    """
    plan = aircraft.campaign
    accepted: list[LateralEstimate] = []
    values: list[float | None] = []
    stopped_at = None
    shares: Mapping[str, float] = dict.fromkeys(JUDGED, math.inf)
    for number, one in enumerate(history, start=1):
        if one is not None:
            accepted.append(one)
            shares = lateral_knowledge(accepted).percent(plan.tolerance_percent)
        worst = max(shares.values())
        values.append(worst if math.isfinite(worst) else None)
        if stopped_at is None and worst < INFORMATION_LIMIT_PERCENT:
            stopped_at = number
    stop = max(shares.values()) < INFORMATION_LIMIT_PERCENT
    return FlightTestVerdict(
        rule="information",
        decision="stop" if stop else "continue",
        sentence=_sentence(shares, accepted, stop) if history else NOT_FLOWN,
        criterion_percent=values[-1] if values else None,
        limit_percent=INFORMATION_LIMIT_PERCENT,
        stopped_at=stopped_at,
        by_rule={
            "information": RuleProgress(
                stopped_at,
                tuple(values),
                INFORMATION_LIMIT_PERCENT,
                parameter_percent={k: v if math.isfinite(v) else None for k, v in shares.items()},
            )
        },
        next=ENOUGH if stop else _next(shares, accepted, flown, aircraft),
    )


def _missing(accepted: Sequence[LateralEstimate]) -> list[str]:
    flown = {name for one in accepted for name in one.flown}
    return [name for name in LATERAL.inputs if name not in flown]


def _sentence(shares: Mapping[str, float], accepted: Sequence[LateralEstimate], stop: bool) -> str:
    if stop:
        return (
            f"TEST COMPLETE: roll and yaw are known within their tolerance from {len(accepted)} accepted "
            "manoeuvres."
        )
    missing = _missing(accepted)
    if missing:
        return f"CONTINUE: no accepted manoeuvre has moved the {' or the '.join(missing)}."
    worst = max(shares, key=lambda name: shares[name])
    said = f"{shares[worst]:.0f} % of its tolerance" if math.isfinite(shares[worst]) else "unknown"
    return f"CONTINUE: the error of {worst} is {said}."


def _next(
    shares: Mapping[str, float],
    accepted: Sequence[LateralEstimate],
    flown: Sequence[FlownInput],
    aircraft: Aircraft,
) -> NextInput:
    missing = _missing(accepted)
    worst = max(shares, key=lambda name: shares[name])
    control = missing[0] if missing else JUDGED[worst]
    percent = max(share for name, share in shares.items() if JUDGED[name] == control)
    return next_lateral(control, percent, accepted, flown, aircraft, worst)
