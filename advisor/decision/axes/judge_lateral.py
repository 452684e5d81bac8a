"""Requirements of roll and yaw on a manoeuvre: records of aileron and rudder, their limits, and the Dutch
roll.

The response may bank by up to 45 deg, because the model contains sin φ. The derivatives hold for one angle of
attack and one air speed. The moments p·q and q·r are not in the model.
"""

import math
from dataclasses import replace
from functools import partial

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.decision.axes.influences import side_coupled
from advisor.decision.envelope import (
    above,
    banked,
    flown,
    is_broken_off,
    other_controls,
    saturated,
    steep,
    throttled,
)
from advisor.decision.quality import WIDEST_PREDICTION_PERCENT, Examined, objections
from advisor.decision.response import Response
from advisor.decision.verdict import Reason
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.robust import rms
from advisor.oem.axes.lateral.estimate import LateralEstimate
from advisor.oem.estimate import NoEstimate
from advisor.words.digits import distinct_texts
from advisor.words.quantiles import NORMAL_95

BANK_DEG = 45.0
"""Largest bank in a lateral manoeuvre, deg, unless the aircraft file has a smaller limit."""
ALPHA_CHANGE_DEG = 5.0
"""Largest change of the angle of attack, half of its range, deg, for which the lift is taken as linear."""
COUPLING = 0.2
"""Largest root mean square of the moments p·q and q·r, over that of the angular accelerations."""
_USUAL_PERIOD_S = 2.0
"""Period of the Dutch roll without an estimate, s. Small aircraft have periods of 1.8 s, and jets of 3.5
s."""
RESPONSES = {
    "aileron": Response("p", "roll rate", "deg/s", "aileron"),
    "rudder": Response("r", "yaw rate", "deg/s", "rudder"),
}
"""Output that shows the response to each control."""
_DETERMINED = {"aileron": ("L_p", "L_delta_a"), "rudder": ("N_beta", "N_r", "N_delta_r")}
"""Derivatives that a test of each control determines."""
_TRIMMING = Reason(
    "information",
    "the movement determines no derivative, as a pilot's trimming; fly a doublet, from trim",
    math.nan,
    math.nan,
)


def judge_lateral(
    maneuver: Maneuver, estimate: LateralEstimate | NoEstimate, aircraft: Aircraft
) -> tuple[Reason, ...]:
    """Return objections to a lateral manoeuvre, the most important first; empty for an accepted one."""
    controls = [name for name in RESPONSES if name in maneuver.channels]
    outside = banked(maneuver, max(BANK_DEG, aircraft.limits.bank_deg), "less aileron, or shorter")
    for name in controls:
        outside += saturated(maneuver, name, getattr(aircraft, name).ends_deg)
    outside += [*steep(maneuver, aircraft.limits.alpha_deg), *_unsteady_alpha(maneuver), *throttled(maneuver)]
    outside += other_controls(maneuver, ("elevator",), "hold the nose with less elevator")
    x = Examined(
        maneuver,
        aircraft,
        estimate,
        _period_s(estimate),
        needed=(*controls, "p", "r", "bank"),
        responses=(),
        determined=(),
        bands=(),
        outside=(*outside, *_pitching(maneuver)),
    )
    if isinstance(estimate, NoEstimate):
        return objections(x)
    # A record that ends within its input tells no free motion, however narrow its intervals are.
    informing = () if is_broken_off(maneuver.span) else estimate.flown
    return objections(
        replace(
            x,
            responses=tuple(RESPONSES[name] for name in estimate.flown),
            determined=tuple(k for name in estimate.flown for k in _DETERMINED[name]),
            bands=tuple(RESPONSES[name].output for name in informing),
            needless=_needless(maneuver, estimate),
            lacks=partial(side_coupled, maneuver, estimate),
            modes_alone=_modes_alone(maneuver, estimate)
            if set(estimate.not_identifiable) == set(estimate.names)
            else None,
        )
    )


def _needless(maneuver: Maneuver, estimate: LateralEstimate) -> frozenset[str]:
    """Return the codes of the limits that a precise lateral estimate makes needless."""
    measured = {"q", "alpha", "theta", "airspeed"} <= maneuver.channels.keys()
    if not measured:
        return frozenset()
    speed = ("airspeed",) if estimate.scales_with_speed else ()
    return frozenset({"bank", "elevator", "coupling", *speed})


def _period_s(estimate: LateralEstimate | NoEstimate) -> float:
    omega = estimate.modes.dutch_roll_omega if isinstance(estimate, LateralEstimate) else None
    return _USUAL_PERIOD_S if omega is None else 2.0 * math.pi / omega.value


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


def _modes_alone(maneuver: Maneuver, estimate: LateralEstimate) -> tuple[Reason, ...]:
    """Return a reason if the Dutch roll frequency, the only result of a record, is too uncertain."""
    if maneuver.span.kind == "other":
        return (_TRIMMING,)
    omega = estimate.modes.dutch_roll_omega
    width = 100.0 * NORMAL_95 * omega.std / omega.value if omega is not None else math.inf
    text = "the Dutch roll's frequency is known to {} % only (limit {}); use more rudder"
    return tuple(above("information", width, WIDEST_PREDICTION_PERCENT, text))
