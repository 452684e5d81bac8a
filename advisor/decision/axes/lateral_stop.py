"""The lateral flight test: knowledge from the joint estimate, stop, and next input.

The joint estimate on all screens and pages also decides on the stop. Bank and information of the next input
follow from the last input by linearity, with the amplitude and its square.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import degrees, inf, radians

import numpy as np

from advisor.aircraft.aircraft import Aircraft, Rule
from advisor.decision.advice import GENTLE
from advisor.decision.axes.lateral import BANK_DEG
from advisor.decision.change import Change
from advisor.decision.conclusion import Criterion, concluded
from advisor.decision.conditions import ALPHA_MARGIN, BOLDER, FULL_TRAVEL_RAD
from advisor.decision.first_unit import shown_unit_s, side_unit_s
from advisor.decision.heard import Heard, first_stop
from advisor.decision.inputs import StepInput
from advisor.decision.remaining import Share, until_usable, variance_scale
from advisor.decision.tolerance import SHARE
from advisor.decision.verdict import (
    INFORMATION_LIMIT_PERCENT,
    FlightTestVerdict,
    NextInput,
    Reason,
    Remaining,
    RuleProgress,
)
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axes.lateral.estimate import LateralEstimate, LateralModes
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.words.quantiles import NORMAL_95
from advisor.words.quantities import symbol

FIRST_UNIT_S = 1.0
"""Duration of the first doublet's step, s, before any mode is known. The duration lies between half a Dutch
roll of a small aircraft (0.9 s) and of a jet (1.7 s). The duration is at least two roll time constants of a
small aircraft (0.1 s) and of a jet (0.5 s)."""


@dataclass(frozen=True, slots=True)
class FlownInput:
    """A flown input with the aircraft's response."""

    control: str
    """Control with the largest movement."""
    amplitude_rad: float
    bank_rad: float
    """Largest bank angle during the manoeuvre, rad."""
    remedy: str = ""
    """Remedy from the first reason against the manoeuvre; empty for an accepted one."""
    modes: LateralModes | None = None
    """Modes of the manoeuvre's estimate, accepted or not; None without an estimate."""

    @classmethod
    def of(
        cls, maneuver: Maneuver, reasons: Sequence[Reason], estimate: Estimate | NoEstimate | None = None
    ) -> "FlownInput":
        """Return the input of a manoeuvre with these reasons against it, and with its estimate."""
        moved = {name: _amplitude(maneuver, name) for name in LATERAL.inputs}
        control = max(moved, key=lambda name: moved[name])
        bank = maneuver.channels.get("bank")
        banked = float(np.max(np.abs(bank.y), initial=0.0)) if bank is not None else 0.0
        remedy = reasons[0].text.partition("; ")[2] if reasons else ""
        modes = estimate.modes if isinstance(estimate, LateralEstimate) else None
        return cls(control, moved[control], banked, remedy, modes)


def _amplitude(maneuver: Maneuver, name: str) -> float:
    """Return the largest deviation of a control from its level before the input, rad."""
    channel = maneuver.channels.get(name)
    if channel is None or not len(channel):
        return 0.0
    return float(np.max(np.abs(channel.y - channel.y[0])))


def next_lateral(
    control: str,
    percent: float,
    accepted: Sequence[LateralEstimate],
    flown: Sequence[FlownInput],
    aircraft: Aircraft,
    holding_back: str,
) -> NextInput:
    """Return the next lateral input.

    Parameters
    ----------
    percent
        Error of the worst derivative of this control, % of its tolerance; infinite if unknown.
    """
    ends_deg = getattr(aircraft, control).ends_deg
    travel = min(map(abs, map(radians, ends_deg))) if ends_deg and 0.0 not in ends_deg else FULL_TRAVEL_RAD
    before = next((one for one in reversed(flown) if one.control == control), None)
    amplitude = GENTLE * travel if before is None else _larger(before, percent, aircraft)
    wanted = StepInput(
        "doublet",
        _unit_s(control, accepted, flown, aircraft),
        min(amplitude, ALPHA_MARGIN * travel),
        True,
        control,
    ).rounded(travel)
    gently = ", to begin gently" if before is None else ""
    # A remedy belongs to the refused input, never to another control.
    remedy = f"; {before.remedy}" if before is not None and before is flown[-1] and before.remedy else ""
    said = f"{wanted.spoken(travel)}{gently}, {_after(control, wanted.unit_s)}{remedy}"
    return NextInput(f"next: {said}", None, holding_back, wanted)


def _larger(before: FlownInput, percent: float, aircraft: Aircraft) -> float:
    """Return the amplitude that meets the tolerance with one more manoeuvre, within the bank limit."""
    factor = min(max(percent / INFORMATION_LIMIT_PERCENT, 1.0), BOLDER) if percent < inf else 1.0
    limit = ALPHA_MARGIN * max(BANK_DEG, aircraft.limits.bank_deg)
    if before.bank_rad > 0.0:
        factor = min(factor, limit / degrees(before.bank_rad))
    return factor * before.amplitude_rad


def _unit_s(
    control: str, accepted: Sequence[LateralEstimate], flown: Sequence[FlownInput], aircraft: Aircraft
) -> float:
    """Return the duration of a step, s: by accepted manoeuvres, the file's model, or other manoeuvres."""
    shown = shown_unit_s(control, [one.modes for one in accepted])
    shown = shown or side_unit_s(control, aircraft.model, aircraft.reference_airspeed_m_s)
    shown = shown or shown_unit_s(control, [one.modes for one in flown if one.modes is not None])
    return shown or FIRST_UNIT_S


def _after(control: str, unit_s: float) -> str:
    if control == "aileron":
        return "then stick still"
    return f"then hands and feet still for {4.0 * unit_s:.0f} s"


JUDGED: Mapping[str, str] = {
    "L_p": "aileron",
    "L_delta_a": "aileron",
    "N_beta": "rudder",
    "N_delta_r": "rudder",
}
"""Control whose input determines each judged derivative best, by the derivative's name."""
CHECKED = 2
"""Least number of accepted manoeuvres for each control. A single manoeuvre shows no scatter: nine derivatives
of one rudder doublet were wrong by many standard errors."""
_RULE: Rule = "information"
NOT_FLOWN = "No test input of the aileron or the rudder has been flown."
"""Sentence about a flight without a lateral manoeuvre."""


def shares_of(joint: LateralEstimate | None, tolerance_percent: float) -> Mapping[str, float]:
    """Return each judged derivative's 95 % half-width, % of its tolerance; infinite if unknown."""
    shares = dict.fromkeys(JUDGED, math.inf)
    if joint is None:
        return shares
    for name, control in JUDGED.items():
        k = joint.names.index(name)
        size = 0.01 * SHARE * tolerance_percent * abs(float(joint.theta[k]))
        if control in joint.flown and name not in joint.not_identifiable and size > 0.0:
            shares[name] = 100.0 * NORMAL_95 * float(joint.std[k]) / size
    return shares


def lateral_flight_test(
    history: Sequence[LateralEstimate | None],
    joint: LateralEstimate | None,
    aircraft: Aircraft,
    flown: Sequence[FlownInput] = (),
    heard: Sequence[Heard] = (),
    change: Change | None = None,
) -> FlightTestVerdict:
    """Return the verdict on the lateral test, with the next input.

    Parameters
    ----------
    history
        Estimate of every manoeuvre in the order flown; None for a refused manoeuvre.
    """
    accepted = [one for one in history if one is not None]
    shares = shares_of(joint, aircraft.campaign.tolerance_percent)
    worst = max(shares.values())
    holds = worst < INFORMATION_LIMIT_PERCENT and not _flown_fewer_than(CHECKED, accepted)
    now = worst if math.isfinite(worst) else None
    told = tuple(one.percent.get(_RULE) for one in heard)
    progress = RuleProgress(
        first_stop(heard, _RULE) or (len(history) if holds else None),
        (*told, now) if len(told) < len(history) else told,
        INFORMATION_LIMIT_PERCENT,
        parameter_percent={k: v if math.isfinite(v) else None for k, v in shares.items()},
        now_percent=now,
        holds=holds,
    )

    def following() -> NextInput:
        advised = _next(shares, accepted, flown, aircraft)
        return replace(advised, remaining=_remaining(shares, accepted, len(history)))

    criterion = Criterion(
        _RULE, {_RULE: progress}, lambda stop: _sentence(shares, accepted, stop) if history else NOT_FLOWN,
        following, len(history), {i for i, one in enumerate(history) if one is not None},
    )  # fmt: skip
    return concluded(criterion, heard, change, () if change is None else (change.sentence,))


def _flown_fewer_than(n: int, accepted: Sequence[LateralEstimate]) -> list[str]:
    return [name for name in LATERAL.inputs if sum(name in one.flown for one in accepted) < n]


def _remaining(
    shares: Mapping[str, float], accepted: Sequence[LateralEstimate], flown: int
) -> Remaining | None:
    """Return the expected number of further manoeuvres; None if that cannot be told."""
    # The variance of a derivative falls with the number of manoeuvres that move its control.
    scale = variance_scale(len(LATERAL.inputs) * (len(accepted) - 1))
    needed = np.zeros(len(scale))
    for control in LATERAL.inputs:
        times = sum(control in one.flown for one in accepted)
        worst = _percent_of(control, shares)
        if not times or not math.isfinite(worst):
            return None
        within = np.ceil(times * (worst / INFORMATION_LIMIT_PERCENT) ** 2 * scale)
        needed += np.maximum(np.maximum(within, CHECKED), times) - times
    return until_usable(np.maximum(needed, 1.0), Share(len(accepted), flown - len(accepted)))


def _sentence(shares: Mapping[str, float], accepted: Sequence[LateralEstimate], stop: bool) -> str:
    if stop:
        return (
            f"TEST COMPLETE: roll and yaw are known within their tolerance from {len(accepted)} accepted "
            "manoeuvres."
        )
    missing = _flown_fewer_than(1, accepted)
    if missing:
        return f"CONTINUE: no accepted manoeuvre has moved the {' or the '.join(missing)}."
    worst = max(shares, key=lambda name: shares[name])
    if shares[worst] < INFORMATION_LIMIT_PERCENT:
        once = _flown_fewer_than(CHECKED, accepted)
        which = " and of the ".join(once)
        return f"CONTINUE: one input of the {which} cannot show its own error; one more will."
    said = f"{shares[worst]:.0f} % of its tolerance" if math.isfinite(shares[worst]) else "unknown"
    return f"CONTINUE: the error of {symbol(worst)} is {said}."


def _next(
    shares: Mapping[str, float],
    accepted: Sequence[LateralEstimate],
    flown: Sequence[FlownInput],
    aircraft: Aircraft,
) -> NextInput:
    missing = _flown_fewer_than(1, accepted) or _flown_fewer_than(CHECKED, accepted)
    worst = max(shares, key=lambda name: shares[name])
    control = missing[0] if missing else JUDGED[worst]
    if flown and flown[-1].remedy and _is_open(flown[-1].control, shares, missing):
        control = flown[-1].control
    percent = _percent_of(control, shares)
    return next_lateral(control, percent, accepted, flown, aircraft, worst)


def _percent_of(control: str, shares: Mapping[str, float]) -> float:
    """Return the error of the worst derivative of a control, % of its tolerance."""
    return max(share for name, share in shares.items() if JUDGED[name] == control)


def _is_open(control: str, shares: Mapping[str, float], missing: Sequence[str]) -> bool:
    """Return whether a further input of a control is needed."""
    return control in missing or _percent_of(control, shares) >= INFORMATION_LIMIT_PERCENT
