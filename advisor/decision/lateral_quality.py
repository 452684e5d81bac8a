"""Objections to a lateral manoeuvre itself: complete data, within the model, long enough, well explained.

A bank of up to 45 deg is the response, because the model keeps sin φ. The derivatives hold for one angle of
attack and one air speed. The moments p·q and q·r are no part of the model.
"""

import math

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.decision.envelope import (
    above,
    banked,
    changed_speed,
    flown,
    is_broken_off,
    other_controls,
    saturated,
    short_response,
    steep,
    throttled,
    too_slow,
    with_gap,
)
from advisor.decision.quality import (
    LEAST_R2,
    LEAST_SIGNAL,
    WIDEST_PREDICTION_PERCENT,
    half_range,
    refusals,
    white_part,
)
from advisor.decision.verdict import UNTRUSTED, Reason
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.maneuvers.purpose import LEAST_PITCH_RATE_DEG_S
from advisor.oem.estimate import NoEstimate
from advisor.oem.lateral_estimate import LateralEstimate
from advisor.words.digits import distinct_texts
from advisor.words.quantiles import NORMAL_95

BANK_DEG = 45.0
"""Largest bank in a lateral manoeuvre, deg, where the aircraft file allows no more."""
ALPHA_CHANGE_DEG = 5.0
"""Largest change of the angle of attack, half of its range, deg: as far as the lift is taken as linear."""
COUPLING = 0.2
"""Largest root mean square of the moments p·q and q·r, over that of the angular accelerations."""
_USUAL_PERIOD_S = 2.0
"""Period of the Dutch roll where no estimate gives one, s. Small aircraft have 1.8 s, jets 3.5 s."""
_RATE_OF = {"aileron": "p", "rudder": "r"}
_NEEDED = ("p", "r", "bank")
_DETERMINED = {"aileron": ("L_p", "L_delta_a"), "rudder": ("N_beta", "N_r", "N_delta_r")}
"""Control to the derivatives that its test determines."""


_TRIMMING = Reason(
    "information",
    "the movement determines no derivative, as a pilot's trimming; fly a doublet, from trim",
    math.nan,
    math.nan,
)


def judge_lateral(
    maneuver: Maneuver, estimate: LateralEstimate | NoEstimate, aircraft: Aircraft
) -> tuple[Reason, ...]:
    """Return objections to a lateral manoeuvre, the most important first; empty for an accepted one.

    Parameters
    ----------
    maneuver
        Manoeuvre as cut from the stream.
    estimate
        Estimate from this manoeuvre alone, or the reason for its absence.
    """
    period_s = _period_s(estimate)
    missing = [name for name in _NEEDED if name not in maneuver.channels]
    if missing:
        text = f"no {' and no '.join(missing)} during the manoeuvre; check the recording and fly it again"
        return (Reason("missing", text, float(len(missing)), 0.0),)
    controls = [name for name in _RATE_OF if name in maneuver.channels]
    needed = [maneuver.channels[name] for name in (*controls, *_NEEDED)]
    reasons = [*too_slow(needed, period_s), *with_gap(needed, maneuver, period_s)]
    if {reason.code for reason in reasons} & UNTRUSTED:
        return tuple(reasons)
    if refused := refusals(maneuver.findings):
        return refused
    reasons += banked(maneuver, max(BANK_DEG, aircraft.limits.bank_deg), "less aileron, or shorter")
    for name in controls:
        reasons += saturated(maneuver, name, getattr(aircraft, name).ends_deg)
    reasons += steep(maneuver, aircraft.limits.alpha_deg)
    reasons += [*_unsteady_alpha(maneuver), *throttled(maneuver)]
    reasons += other_controls(maneuver, ("elevator",), "hold the nose with less elevator")
    reasons += [*_pitching(maneuver), *changed_speed(maneuver, aircraft)]
    short = [] if _is_informed(estimate) else short_response(maneuver, period_s)
    if isinstance(estimate, NoEstimate):
        untold = Reason(estimate.code, estimate.text, math.nan, math.nan)
        return (*reasons, *short, untold)
    if is_broken_off(maneuver.span):
        # A record that ends within its input tells no free motion, however narrow its intervals are.
        short = short_response(maneuver, period_s)
    gentle = _too_gentle(maneuver, estimate)
    lacking = _badly_explained(estimate) or ([] if gentle else _poor(maneuver, estimate))
    return (*reasons, *short, *gentle, *lacking)


def _is_informed(estimate: LateralEstimate | NoEstimate) -> bool:
    """Return whether a manoeuvre determines its axis, whatever the length of its free response.

    The band of each flown control's predicted rate is narrow. The intervals of damping and control exclude
    zero, and with the rudder the interval of stiffness does too.
    """
    if isinstance(estimate, NoEstimate) or not estimate.flown:
        return False
    found = estimate.estimate
    known = all(
        name not in found.not_identifiable
        and abs(found.value(name)) > NORMAL_95 * float(found.std[found.names.index(name)])
        for control in estimate.flown
        for name in _DETERMINED[control]
    )
    bands = [100.0 * found.prediction[_RATE_OF[name]] for name in estimate.flown] if known else [math.inf]
    return max(bands) <= WIDEST_PREDICTION_PERCENT


def _period_s(estimate: LateralEstimate | NoEstimate) -> float:
    omega = estimate.modes.dutch_roll_omega if isinstance(estimate, LateralEstimate) else None
    return 2.0 * math.pi / omega.value if omega is not None and omega.value > 0.0 else _USUAL_PERIOD_S


def _unsteady_alpha(maneuver: Maneuver) -> list[Reason]:
    alpha = flown(maneuver, "alpha")
    change = 0.5 * float(np.degrees(np.ptp(alpha))) if len(alpha) else 0.0
    text = "angle of attack moved by {} deg (limit {}); keep the nose where it is"
    return above("alpha", change, ALPHA_CHANGE_DEG, text, 1)


def _pitching(maneuver: Maneuver) -> list[Reason]:
    """Return a reason where the moments of pitching and rolling together are no longer small."""
    q, p, r = (maneuver.channels.get(name) for name in ("q", "p", "r"))
    if q is None or p is None or r is None:
        return []
    t = p.t
    roll, yaw, pitch = p.y, np.interp(t, r.t, r.y), np.interp(t, q.t, q.y)
    pitch = pitch - np.mean(pitch)
    shares = [
        _rms(pitch * rate) / max(_rms(np.gradient(other, t)), 1e-12)
        for rate, other in ((roll, yaw), (yaw, roll))
    ]
    if max(shares) <= COUPLING:
        return []
    shown, most = distinct_texts(100.0 * max(shares), 100.0 * COUPLING)
    text = f"pitching with rolling makes up to {shown} % of the moments (limit {most}); hold the nose still"
    return [Reason("coupling", text, max(shares), COUPLING)]


def _rms(x: np.ndarray) -> float:
    return float(np.sqrt(np.mean(x**2)))


def _too_gentle(maneuver: Maneuver, estimate: LateralEstimate) -> list[Reason]:
    """Return a reason where no rate that a control moves exceeds the noise."""
    rates = {name: _RATE_OF[name] for name in estimate.flown}
    fits = estimate.estimate.fits[0]
    wanting = []
    for control, rate in rates.items():
        peak = math.degrees(half_range(maneuver, rate))
        noise = math.degrees(white_part(fits[rate].residual)) if rate in fits else 0.0
        limit = max(LEAST_SIGNAL["q"] * noise, LEAST_PITCH_RATE_DEG_S)
        wanting.append((peak / limit, peak, limit, control))
    share, peak, limit, control = max(wanting, default=(1.0, 0.0, 0.0, ""))
    if share >= 1.0:
        return []
    rate_said = "roll rate" if control == "aileron" else "yaw rate"
    shown, least = distinct_texts(peak, limit, 2, "g")
    text = f"too gentle, {rate_said} {shown} deg/s (at least {least}); use more {control}"
    return [Reason("amplitude", text, peak, limit)]


def _badly_explained(estimate: LateralEstimate) -> list[Reason]:
    """Return a reason where the model does not explain the rate of a control that was flown."""
    fits = estimate.estimate.fits[0]
    shares = {name: fits[_RATE_OF[name]].r2 for name in estimate.flown}
    least = LEAST_R2["q"]
    worst = min(shares, key=lambda name: shares[name], default="")
    if not worst or shares[worst] >= least:
        return []
    shown, most = distinct_texts(100.0 * shares[worst], 100.0 * least)
    rate = "roll rate" if worst == "aileron" else "yaw rate"
    text = f"the model explains {shown} % of the {rate} (at least {most}); fly it in calm air, from trim"
    return [Reason("fit", text, shares[worst], least)]


def _unknown_modes(estimate: LateralEstimate) -> list[Reason]:
    """Return a reason where the frequency of the Dutch roll is known too poorly."""
    omega = estimate.modes.dutch_roll_omega
    width = 100.0 * NORMAL_95 * omega.std / omega.value if omega is not None else math.inf
    text = "the Dutch roll's frequency is known to {} % only (limit {}); use more rudder"
    return above("information", width, WIDEST_PREDICTION_PERCENT, text)


def _poor(maneuver: Maneuver, estimate: LateralEstimate) -> list[Reason]:
    """Return a reason where the estimate predicts the rate of a control too poorly.

    Where a test input determines the modes only, the frequency of the Dutch roll stands for the prediction.
    A movement without the shape of a test that determines no derivative is a pilot's trimming.
    """
    if set(estimate.estimate.not_identifiable) == set(estimate.estimate.names):
        return [_TRIMMING] if maneuver.span.kind == "other" else _unknown_modes(estimate)
    bands = {name: 100.0 * estimate.estimate.prediction[_RATE_OF[name]] for name in estimate.flown}
    widest = max(bands, key=lambda name: bands[name], default="")
    text = f"the {widest}'s response is known to {{}} % only (limit {{}}); use more {widest}"
    return above("information", bands[widest], WIDEST_PREDICTION_PERCENT, text) if widest else []
