"""Requirements of each axis on a manoeuvre: the records, the limits, and the natural period.

Roll and yaw may bank by up to 45 deg, because their model contains sin φ. Their derivatives hold for one
angle of attack and one air speed. The moments p·q and q·r are not in their model.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.decision.axes.influences import carries_speed, coupled, has_banking, side_coupled
from advisor.decision.envelope import (
    above,
    banked,
    flown,
    follows_motion,
    is_broken_off,
    other_controls,
    saturated,
    steep,
    throttled,
    too_quick,
)
from advisor.decision.first_unit import PITCH_RATE, dutch_roll_s, natural_period
from advisor.decision.quality import WIDEST_PREDICTION_PERCENT, Examined, objections
from advisor.decision.response import Response
from advisor.decision.verdict import Reason
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.record import rms
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.notes import findings_of
from advisor.words.axes import AxisName
from advisor.words.quantities import NORMAL_95, distinct_texts

BANK_DEG = 45.0
"""Largest bank in a lateral manoeuvre, deg, unless the aircraft file has a smaller limit."""
ALPHA_CHANGE_DEG = 5.0
"""Largest change of the angle of attack, half of its range, deg, for which the lift is taken as linear."""
COUPLING = 0.2
"""Largest root mean square of the moments p·q and q·r, over that of the angular accelerations."""
_TRIMMING = Reason(
    "information",
    "the movement determines no derivative, as a pilot's trimming; fly a doublet, from trim",
    math.nan,
    math.nan,
)


@dataclass(frozen=True, slots=True)
class Requirements:
    """Table of one axis."""

    responses: Mapping[str, tuple[Response, ...]]
    """Outputs that show the response to each control."""
    determined: Mapping[str, tuple[str, ...]]
    """Derivatives that a test of each control determines."""
    needed: tuple[str, ...]
    """Channels in addition to the controls without which no manoeuvre can be judged."""
    outside: Callable[[Maneuver, Aircraft], tuple[Reason, ...]]
    """Function that returns reasons for exceeded limits of the model."""
    period_s: Callable[[Maneuver, Estimate | NoEstimate], float]
    """Function that returns the natural period of the motion, s."""
    too_quick: Callable[[Maneuver, float], Sequence[Reason]]
    """Function that returns reasons for steps too short for a natural period, s."""
    of_estimate: Callable[[Examined, Estimate], Examined]
    """Function that adds the requirements on an estimate."""


def judge(
    axis: AxisName, maneuver: Maneuver, estimate: Estimate | NoEstimate, aircraft: Aircraft
) -> tuple[Reason, ...]:
    """Return objections to a manoeuvre of an axis, the most important first; empty for a good one."""
    table = REQUIREMENTS[axis]
    period_s = table.period_s(maneuver, estimate)
    x = Examined(
        maneuver,
        aircraft,
        estimate,
        period_s,
        needed=needed(axis, maneuver),
        responses=responses_of(axis, estimate),
        determined=tuple(name for control in _moved(table, estimate) for name in table.determined[control]),
        outside=table.outside(maneuver, aircraft),
        quick=tuple(table.too_quick(maneuver, period_s)),
    )
    return objections(x if isinstance(estimate, NoEstimate) else table.of_estimate(x, estimate))


def needed(axis: AxisName, maneuver: Maneuver) -> tuple[str, ...]:
    """Return the channels without which a manoeuvre cannot be judged. One control of the axis suffices."""
    table = REQUIREMENTS[axis]
    recorded = tuple(name for name in table.responses if name in maneuver.channels)
    return (*(recorded or table.responses), *table.needed)


def responses_of(axis: AxisName, estimate: Estimate | NoEstimate) -> tuple[Response, ...]:
    """Return the outputs that show the response to the controls of a test."""
    table = REQUIREMENTS[axis]
    return tuple(response for control in _moved(table, estimate) for response in table.responses[control])


def _moved(table: Requirements, estimate: Estimate | NoEstimate) -> tuple[str, ...]:
    """Return the controls of a test. Of several controls only an estimate tells which ones moved."""
    if isinstance(estimate, AxisEstimate):
        return estimate.flown
    return tuple(table.responses) if len(table.responses) == 1 else ()


def pitch_limits(maneuver: Maneuver, aircraft: Aircraft) -> tuple[Reason, ...]:
    """Return reasons for exceeded limits of pitch: bank, stops, angle of attack, throttle, other controls."""
    others = ("aileron", "rudder")
    return (
        *banked(maneuver, aircraft.limits.bank_deg),
        *saturated(maneuver, "elevator", aircraft.elevator.ends_deg),
        *steep(maneuver, aircraft.limits.alpha_deg),
        *throttled(maneuver),
        *other_controls(maneuver, others, "use the elevator alone"),
        *follows_motion(maneuver, "elevator", others),
    )


def _side_limits(maneuver: Maneuver, aircraft: Aircraft) -> tuple[Reason, ...]:
    stops = (
        reason
        for name in ("aileron", "rudder")
        for reason in saturated(maneuver, name, getattr(aircraft, name).ends_deg)
    )
    return (
        *banked(maneuver, max(BANK_DEG, aircraft.limits.bank_deg), "less aileron, or shorter"),
        *stops,
        *steep(maneuver, aircraft.limits.alpha_deg),
        *_unsteady_alpha(maneuver),
        *throttled(maneuver),
        *other_controls(maneuver, ("elevator",), "hold the nose with less elevator"),
        *_pitching(maneuver),
    )


def _of_pitch(x: Examined, estimate: Estimate) -> Examined:
    """Add what an estimate of pitch makes needless, and what its model lacks."""
    carried = {"bank": has_banking(x.maneuver), "airspeed": carries_speed(estimate)}
    return replace(
        x,
        needless=frozenset(
            {"aileron", "rudder", *(code for code, is_carried in carried.items() if is_carried)}
        ),
        bands=tuple(estimate.prediction),
        findings=findings_of(estimate, x.aircraft),
        lacks=partial(coupled, x.maneuver, estimate),
    )


def _of_side(x: Examined, estimate: Estimate) -> Examined:
    """Add what an estimate of roll and yaw makes needless, and what its model lacks."""
    assert isinstance(estimate, AxisEstimate)
    needless: tuple[str, ...] = ()
    if {"q", "alpha", "theta", "airspeed"} <= x.maneuver.channels.keys():
        needless = ("bank", "elevator", "coupling", *(("airspeed",) if estimate.scales_with_speed else ()))
    # A record that ends within its input tells no free motion, however narrow its intervals are.
    informed = not is_broken_off(x.maneuver.span)
    untold = set(estimate.not_identifiable) == set(estimate.names)
    return replace(
        x,
        needless=frozenset(needless),
        bands=tuple(response.output for response in x.responses) if informed else (),
        lacks=partial(side_coupled, x.maneuver, estimate),
        modes_alone=_modes_alone(x.maneuver, estimate) if untold else None,
    )


def _unsteady_alpha(maneuver: Maneuver) -> list[Reason]:
    alpha = flown(maneuver, "alpha")
    change = 0.5 * float(np.degrees(np.ptp(alpha))) if len(alpha) else 0.0
    text = "angle of attack moved by {} deg (limit {}); keep the nose where it is"
    return above("alpha", change, ALPHA_CHANGE_DEG, text, 1)


def _pitching(maneuver: Maneuver) -> list[Reason]:
    """Return a reason if the moments of combined pitching and rolling are too large."""
    q, p, r = (maneuver.channels.get(name) for name in ("q", "p", "r"))
    if q is None or p is None or r is None:
        return []
    t = p.t
    roll, yaw, pitch = p.y, np.interp(t, r.t, r.y), np.interp(t, q.t, q.y)
    pitch = pitch - np.mean(pitch)
    shares = [
        rms(pitch * rate) / max(rms(np.gradient(other, t)), 1e-12)
        for rate, other in ((roll, yaw), (yaw, roll))
    ]
    if max(shares) <= COUPLING:
        return []
    shown, most = distinct_texts(100.0 * max(shares), 100.0 * COUPLING)
    text = f"pitching with rolling makes up to {shown} % of the moments (limit {most}); hold the nose still"
    return [Reason("coupling", text, max(shares), COUPLING)]


def _modes_alone(maneuver: Maneuver, estimate: AxisEstimate) -> tuple[Reason, ...]:
    """Return a reason if the Dutch roll frequency, the only result of a record, is too uncertain."""
    if maneuver.span.kind == "other":
        return (_TRIMMING,)
    omega = estimate.modes.get("dutch_roll_omega")
    width = 100.0 * NORMAL_95 * omega.std / omega.value if omega is not None else math.inf
    text = "the Dutch roll's frequency is known to {} % only (limit {}); use more rudder"
    return tuple(above("information", width, WIDEST_PREDICTION_PERCENT, text))


REQUIREMENTS: Mapping[AxisName, Requirements] = {
    "pitch": Requirements(
        responses={
            "elevator": (
                PITCH_RATE,
                Response("alpha", "angle of attack", "deg", "stick", least_signal=8.0, least_r2=0.70),
            )
        },
        determined={"elevator": ("M_alpha", "M_q", "M_delta_e")},
        needed=("q",),
        outside=pitch_limits,
        period_s=natural_period,
        too_quick=too_quick,
        of_estimate=_of_pitch,
    ),
    "lateral": Requirements(
        responses={
            "aileron": (Response("p", "roll rate", "deg/s", "aileron"),),
            "rudder": (Response("r", "yaw rate", "deg/s", "rudder"),),
        },
        determined={"aileron": ("L_p", "L_delta_a"), "rudder": ("N_beta", "N_r", "N_delta_r")},
        needed=("p", "r", "bank"),
        outside=_side_limits,
        period_s=dutch_roll_s,
        too_quick=lambda maneuver, period_s: (),
        of_estimate=_of_side,
    ),
}
"""Table of each axis, by its name."""
