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
from advisor.decision.axes.judge_lateral import BANK_DEG
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
from advisor.model.axes.lateral import CONTROLS, LATERAL
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
    too_small: float = 1.0
    """Factor by which the first reason asks for a larger input; 1 where it asks for something else."""

    @classmethod
    def of(
        cls, maneuver: Maneuver, reasons: Sequence[Reason], estimate: Estimate | NoEstimate | None = None
    ) -> "FlownInput":
        """Return the input of a manoeuvre with these reasons against it, and with its estimate."""
        moved = {name: _amplitude(maneuver, name) for name in LATERAL.inputs}
        control = max(moved, key=lambda name: moved[name])
        bank = maneuver.channels.get("bank")
        banked = float(np.max(np.abs(bank.y), initial=0.0)) if bank is not None else 0.0
        remedy = reasons[0].remedy if reasons else ""
        modes = estimate.modes if isinstance(estimate, LateralEstimate) else None
        gentle = bool(reasons) and reasons[0].code == "amplitude" and reasons[0].value > 0.0
        factor = reasons[0].limit / reasons[0].value if gentle else 1.0
        return cls(control, moved[control], banked, remedy, modes, factor)


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
    # A remedy belongs to the refused input, never to another control. A larger amplitude is a remedy.
    refused = before is not None and before is flown[-1] and before.too_small <= 1.0
    remedy = f"; {before.remedy}" if before is not None and refused and before.remedy else ""
    said = f"{wanted.spoken(travel)}{gently}, {_after(control, wanted.unit_s)}{remedy}"
    return NextInput(f"next: {said}", None, holding_back, wanted)


def _larger(before: FlownInput, percent: float, aircraft: Aircraft) -> float:
    """Return the amplitude that meets the tolerance with one more manoeuvre, within the bank limit.

    A refused input grows only if the refusal asks for a larger one.
    """
    wanted = percent / INFORMATION_LIMIT_PERCENT if percent < inf else 1.0
    factor = min(max(before.too_small if before.remedy else wanted, 1.0), BOLDER)
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
Judged = Mapping[str, str]
"""Control for each judged derivative of an aircraft, by the derivative's name."""
CHECKED = 2
"""Least number of accepted manoeuvres for each control. A single manoeuvre shows no scatter: nine derivatives
of one rudder doublet were wrong by many standard errors."""
_RULE: Rule = "information"
NOT_FLOWN = "No test input of the aileron or the rudder has been flown."
"""Sentence about a flight without a lateral manoeuvre."""


def judged_by(controls: Sequence[str]) -> Judged:
    """Return the judged derivatives of an aircraft with these controls. The other control shows the motion of
    an aircraft that lacks one."""
    absent = tuple(suffix for suffix, control in CONTROLS.items() if control not in controls)
    return {
        name: best if best in controls else controls[0]
        for name, best in JUDGED.items() if not name.endswith(absent)
    }  # fmt: skip


def shares_of(
    joint: LateralEstimate | None, tolerance_percent: float, judged: Judged = JUDGED
) -> Mapping[str, float]:
    """Return each judged derivative's 95 % half-width, % of its tolerance; infinite if unknown."""
    shares = dict.fromkeys(judged, math.inf)
    if joint is None:
        return shares
    for name, control in judged.items():
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
    controls: Sequence[str] = LATERAL.inputs,
) -> FlightTestVerdict:
    """Return the verdict on the lateral test, with the next input.

    Parameters
    ----------
    history
        Estimate of every manoeuvre in the order flown; None for a refused manoeuvre.
    controls
        Controls whose outputs are known. No input of another control is advised or needed.
    """
    accepted = [one for one in history if one is not None]
    judged = judged_by(controls)
    shares = shares_of(joint, aircraft.campaign.tolerance_percent, judged)
    worst = max(shares.values())
    holds = worst < INFORMATION_LIMIT_PERCENT and not _flown_fewer_than(CHECKED, accepted, controls)
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
        advised = _next(shares, accepted, flown, aircraft, judged)
        return replace(advised, remaining=_remaining(shares, accepted, len(history), judged))

    def said(stop: bool) -> str:
        return f"{_sentence(shares, accepted, stop, controls)}{_without(controls)}" if history else NOT_FLOWN

    criterion = Criterion(
        _RULE, {_RULE: progress}, said,
        following, len(history), {i for i, one in enumerate(history) if one is not None},
    )  # fmt: skip
    return concluded(criterion, heard, change, () if change is None else (change.sentence,))


def _flown_fewer_than(n: int, accepted: Sequence[LateralEstimate], controls: Sequence[str]) -> list[str]:
    return [name for name in controls if sum(name in one.flown for one in accepted) < n]


def _without(controls: Sequence[str]) -> str:
    """Return a sentence about a control that no output moves; empty for an aircraft with both."""
    return "".join(
        f" No output is the {name}'s: this aircraft has no {name}, or {name}.output must name the output."
        for name in LATERAL.inputs if name not in controls
    )  # fmt: skip


def _remaining(
    shares: Mapping[str, float], accepted: Sequence[LateralEstimate], flown: int, judged: Judged
) -> Remaining | None:
    """Return the expected number of further manoeuvres; None if that cannot be told."""
    # The variance of a derivative falls with the number of manoeuvres that move its control.
    controls = sorted(set(judged.values()))
    scale = variance_scale(len(controls) * (len(accepted) - 1))
    needed = np.zeros(len(scale))
    for control in controls:
        times = sum(control in one.flown for one in accepted)
        worst = _percent_of(control, shares, judged)
        if not times or not math.isfinite(worst):
            return None
        within = np.ceil(times * (worst / INFORMATION_LIMIT_PERCENT) ** 2 * scale)
        needed += np.maximum(np.maximum(within, CHECKED), times) - times
    return until_usable(np.maximum(needed, 1.0), Share(len(accepted), flown - len(accepted)))


def _sentence(
    shares: Mapping[str, float], accepted: Sequence[LateralEstimate], stop: bool, controls: Sequence[str]
) -> str:
    if stop:
        return (
            f"TEST COMPLETE: roll and yaw are known within their tolerance from {len(accepted)} accepted "
            "manoeuvres."
        )
    missing = _flown_fewer_than(1, accepted, controls)
    if missing:
        return f"CONTINUE: no accepted manoeuvre has moved the {' or the '.join(missing)}."
    worst = max(shares, key=lambda name: shares[name])
    if shares[worst] < INFORMATION_LIMIT_PERCENT:
        once = _flown_fewer_than(CHECKED, accepted, controls)
        which = " and of the ".join(once)
        return f"CONTINUE: one input of the {which} cannot show its own error; one more will."
    said = f"{shares[worst]:.0f} % of its tolerance" if math.isfinite(shares[worst]) else "unknown"
    return f"CONTINUE: the error of {symbol(worst)} is {said}."


def _next(
    shares: Mapping[str, float],
    accepted: Sequence[LateralEstimate],
    flown: Sequence[FlownInput],
    aircraft: Aircraft,
    judged: Judged,
) -> NextInput:
    controls = [name for name in LATERAL.inputs if name in judged.values()]
    missing = _flown_fewer_than(1, accepted, controls) or _flown_fewer_than(CHECKED, accepted, controls)
    worst = max(shares, key=lambda name: shares[name])
    control = missing[0] if missing else judged[worst]
    if flown and flown[-1].remedy and _is_open(flown[-1].control, shares, missing, judged):
        control = flown[-1].control
    percent = _percent_of(control, shares, judged)
    return next_lateral(control, percent, accepted, flown, aircraft, worst)


def _percent_of(control: str, shares: Mapping[str, float], judged: Judged) -> float:
    """Return the error of the worst derivative of a control, % of its tolerance."""
    return max((share for name, share in shares.items() if judged[name] == control), default=0.0)


def _is_open(control: str, shares: Mapping[str, float], missing: Sequence[str], judged: Judged) -> bool:
    """Return whether a further input of a control is needed."""
    return control in missing or _percent_of(control, shares, judged) >= INFORMATION_LIMIT_PERCENT
