"""Requirements of pitch on a manoeuvre: the elevator's record, its limits, and the natural period."""

import math
from dataclasses import replace
from functools import partial

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.decision.axes.influences import carries_speed, coupled, has_banking
from advisor.decision.envelope import (
    banked,
    follows_motion,
    other_controls,
    saturated,
    steep,
    throttled,
    too_quick,
)
from advisor.decision.quality import Examined, objections
from advisor.decision.response import Response, explained_share
from advisor.decision.verdict import Reason
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.findings import findings_of
from advisor.words.quantiles import NORMAL_95

_RESPONSES = (
    Response("q", "pitch rate", "deg/s", "stick"),
    Response("alpha", "angle of attack", "deg", "stick", least_signal=8.0, least_r2=0.70),
)
_DETERMINED = ("M_alpha", "M_q", "M_delta_e")
_OTHERS = ("aileron", "rudder")
NEEDED = ("elevator", "q")
"""Channels without which no pitch manoeuvre can be judged."""


def judge_pitch(
    maneuver: Maneuver, estimate: Estimate | NoEstimate, aircraft: Aircraft
) -> tuple[Reason, ...]:
    """Return objections to a manoeuvre of the elevator, the most important first."""
    period_s = natural_period(maneuver, estimate)
    x = Examined(
        maneuver,
        aircraft,
        estimate,
        period_s,
        needed=NEEDED,
        responses=_RESPONSES,
        determined=_DETERMINED,
        bands=("q",),
        outside=outside(maneuver, aircraft),
        quick=tuple(too_quick(maneuver, period_s)),
    )
    if isinstance(estimate, NoEstimate):
        return objections(x)
    return objections(
        replace(
            x,
            needless=_needless(maneuver, estimate),
            bands=tuple(estimate.prediction),
            findings=findings_of(estimate, aircraft),
            lacks=partial(coupled, maneuver, estimate),
        )
    )


def _needless(maneuver: Maneuver, estimate: Estimate) -> frozenset[str]:
    """Return the codes of the limits that a precise estimate of pitch makes needless."""
    return frozenset(
        {
            *_OTHERS,
            *(("bank",) if has_banking(maneuver) else ()),
            *(("airspeed",) if carries_speed(estimate) else ()),
        }
    )


def outside(maneuver: Maneuver, aircraft: Aircraft) -> tuple[Reason, ...]:
    """Return reasons for exceeded limits: bank, saturation, angle of attack, throttle, other controls."""
    return (
        *banked(maneuver, aircraft.limits.bank_deg),
        *saturated(maneuver, "elevator", aircraft.elevator.ends_deg),
        *steep(maneuver, aircraft.limits.alpha_deg),
        *throttled(maneuver),
        *other_controls(maneuver, _OTHERS, "use the elevator alone"),
        *follows_motion(maneuver, "elevator", _OTHERS),
    )


def natural_period(maneuver: Maneuver, estimate: Estimate | NoEstimate) -> float:
    """Return the natural period of the short-period motion in s, 2π/ω with ω² = Z_α M_q − (1 + Z_q) M_α.

    Without a valid estimate, the period follows from the input, which crews match to the aircraft. That
    period is 2.5 times the shortest step, or twice the median lobe of a multisine.
    """
    if isinstance(estimate, Estimate) and _knows_the_motion(estimate):
        square = estimate.value("Z_alpha") * estimate.value("M_q")
        square -= (1.0 + estimate.value("Z_q")) * estimate.value("M_alpha")
        if square > 0.0:
            return 2.0 * math.pi / math.sqrt(square)
    held_s = np.diff([onset for onset, _ in maneuver.span.steps])
    held_s = held_s[held_s > 0.0]  # two steps between two samples have one onset
    if len(held_s) == 0:
        return 1.0
    swept = maneuver.span.kind == "multisine"
    return 2.0 * float(np.median(held_s)) if swept else 2.5 * float(np.min(held_s))


def _knows_the_motion(estimate: Estimate) -> bool:
    """Return whether an estimate explains and predicts its response, and the stiffness is significant at
    95 %."""
    stiffness, rate = estimate.names.index("M_alpha"), _RESPONSES[0]
    determined = abs(float(estimate.theta[stiffness])) > NORMAL_95 * float(estimate.std[stiffness])
    fit = estimate.fits[0].get(rate.output) if estimate.fits else None
    holds = fit is None or explained_share(fit) >= rate.least_r2
    return determined and holds and estimate.prediction.get("q", 0.0) < 1.0
