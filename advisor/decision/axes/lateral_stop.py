"""The lateral flight test: knowledge from the joint estimate, stop, and next input.

The joint estimate on all screens and pages also decides on the stop.

Bank and information of the next input follow from the last input by linearity, with the amplitude and its
square.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import degrees, inf, isfinite

import numpy as np

from advisor.aircraft.aircraft import Aircraft, Rule
from advisor.decision.advice import GENTLE
from advisor.decision.axes.requirements import BANK_DEG
from advisor.decision.change import Change
from advisor.decision.conditions import ALPHA_MARGIN, BOLDER, Share, travel_of, until_usable, variance_scale
from advisor.decision.first_unit import first_unit_s
from advisor.decision.history import Heard, first_stop
from advisor.decision.information import times_its_tolerance
from advisor.decision.inputs import StepInput
from advisor.decision.prediction import SHARE
from advisor.decision.stopping import Criterion, concluded
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
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.words.quantities import NORMAL_95, symbol


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
    estimate: Estimate | NoEstimate | None = None
    """Estimate of the manoeuvre, accepted or not."""
    asked: float = 1.0
    """Factor on the amplitude that the first reason asks for; 1 if the reason asks for another change."""

    @classmethod
    def of(
        cls, maneuver: Maneuver, reasons: Sequence[Reason], estimate: Estimate | NoEstimate | None = None
    ) -> "FlownInput":
        moved = {name: _amplitude(maneuver, name) for name in LATERAL.inputs}
        control = max(moved, key=lambda name: moved[name])
        bank = maneuver.channels.get("bank")
        banked = float(np.max(np.abs(bank.y), initial=0.0)) if bank is not None else 0.0
        remedy = reasons[0].remedy if reasons else ""
        asked = 1.0 / BOLDER if reasons and reasons[0].code == "saturation" else 1.0
        if reasons and reasons[0].code == "amplitude" and reasons[0].value > 0.0:
            asked = reasons[0].limit / reasons[0].value
        return cls(control, moved[control], banked, remedy, estimate, asked)


def _amplitude(maneuver: Maneuver, name: str) -> float:
    """Return the largest deviation of a control from its level before the input, rad."""
    channel = maneuver.channels.get(name)
    if channel is None or not len(channel):
        return 0.0
    return float(np.max(np.abs(channel.y - channel.y[0])))


def next_lateral(
    control: str,
    percent: float,
    accepted: Sequence[AxisEstimate],
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
    travel = travel_of(getattr(aircraft, control).ends_deg)
    before = next((earlier for earlier in reversed(flown) if earlier.control == control), None)
    amplitude = GENTLE * travel if before is None else _larger(before, percent, aircraft, travel)
    refused = [x.estimate for x in flown if x.estimate is not None]
    unit_s = first_unit_s(control, aircraft, accepted, refused)
    wanted = StepInput("doublet", unit_s, min(amplitude, ALPHA_MARGIN * travel), True, control)
    wanted = wanted.rounded(travel)
    gently = ", to begin gently" if before is None else ""
    # A remedy belongs to the refused input, never to another control. Another amplitude is a remedy.
    repeated = before is not None and before is flown[-1] and before.asked == 1.0
    remedy = f"; {before.remedy}" if before is not None and repeated and before.remedy else ""
    still = f"hands and feet still for {4.0 * unit_s:.0f} s" if control == "rudder" else "stick still"
    said = f"{wanted.spoken(travel)}{gently}, then {still}{remedy}"
    return NextInput(f"next: {said}", None, holding_back, wanted)


def _larger(before: FlownInput, percent: float, aircraft: Aircraft, travel: float) -> float:
    """Return the amplitude that meets the tolerance with one more manoeuvre, within the bank limit.

    A refused input changes only as the refusal asks.
    """
    wanted = max(percent / INFORMATION_LIMIT_PERCENT, 1.0) if percent < inf else 1.0
    factor = min(before.asked if before.remedy else wanted, BOLDER)
    limit = ALPHA_MARGIN * max(BANK_DEG, aircraft.limits.bank_deg)
    if before.bank_rad > 0.0:
        factor = min(factor, limit / degrees(before.bank_rad))
    # A control that moves from one end to the other is no larger than its travel from trim.
    return factor * min(before.amplitude_rad, travel)


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


def shares_of(
    joint: AxisEstimate | None, tolerance_percent: float, judged: Mapping[str, str] = JUDGED
) -> Mapping[str, float]:
    """Return each judged derivative's 95 % half-width, % of its tolerance; infinite if unknown.

    Parameters
    ----------
    judged
        Control for each judged derivative of the aircraft, by the derivative's name.
    """
    shares = dict.fromkeys(judged, inf)
    if joint is None:
        return shares
    for name, control in judged.items():
        k = joint.names.index(name)
        size = 0.01 * SHARE * tolerance_percent * abs(float(joint.theta[k]))
        if control in joint.flown and name not in joint.not_identifiable and size > 0.0:
            shares[name] = 100.0 * NORMAL_95 * float(joint.std[k]) / size
    return shares


@dataclass(frozen=True)
class _SideTest:
    """The test of roll and yaw after its newest manoeuvre."""

    history: Sequence[AxisEstimate | None]
    joint: AxisEstimate | None
    aircraft: Aircraft
    flown: Sequence[FlownInput]
    controls: Sequence[str]

    @cached_property
    def accepted(self) -> list[AxisEstimate]:
        """Estimates of the accepted manoeuvres."""
        return [estimate for estimate in self.history if estimate is not None]

    @cached_property
    def judged(self) -> Mapping[str, str]:
        """Control for each judged derivative. If an aircraft lacks one control, the other control determines
        the derivatives of the motion.
        """
        absent = tuple(suffix for suffix, control in CONTROLS.items() if control not in self.controls)
        return {
            name: best if best in self.controls else self.controls[0]
            for name, best in JUDGED.items() if not name.endswith(absent)
        }  # fmt: skip

    @cached_property
    def shares(self) -> Mapping[str, float]:
        """Error of each judged derivative, % of its tolerance."""
        return shares_of(self.joint, self.aircraft.campaign.tolerance_percent, self.judged)

    @property
    def worst(self) -> str:
        """Derivative with the largest error relative to its tolerance."""
        return max(self.shares, key=lambda name: self.shares[name])

    @property
    def holds(self) -> bool:
        return self.shares[self.worst] < INFORMATION_LIMIT_PERCENT and not self.flown_fewer_than(CHECKED)

    def times(self, control: str) -> int:
        """Return the number of accepted manoeuvres that move a control."""
        return sum(control in estimate.flown for estimate in self.accepted)

    def flown_fewer_than(self, n: int) -> list[str]:
        """Return the controls that fewer accepted manoeuvres move."""
        return [name for name in self.controls if self.times(name) < n]

    def percent_of(self, control: str) -> float:
        """Return the error of the worst derivative of a control, % of its tolerance."""
        shares = (share for name, share in self.shares.items() if self.judged[name] == control)
        return max(shares, default=0.0)

    @property
    def hidden(self) -> str:
        """Reason why no input shows any judged derivative, with its remedy; empty if an input can."""
        untold = {} if self.joint is None else self.joint.not_identifiable
        reasons = {untold.get(name, "") for name in self.judged}
        return reasons.pop() if len(reasons) == 1 else ""

    def sentence(self, stop: bool) -> str:
        """Return the sentence about the criterion; an aircraft without a control is named as such."""
        if not self.history:
            return NOT_FLOWN
        without = "".join(
            f" No output is the {name}'s: this aircraft has no {name}, or {name}.output must name the output."
            for name in LATERAL.inputs if name not in self.controls
        )  # fmt: skip
        return f"{self._stands(stop)}{without}"

    def _stands(self, stop: bool) -> str:
        if stop:
            complete = "TEST COMPLETE: roll and yaw are known within their tolerance"
            return f"{complete} from {len(self.accepted)} accepted manoeuvres."
        missing, worst = self.flown_fewer_than(1), self.worst
        if missing:
            return f"CONTINUE: no accepted manoeuvre has moved the {' or the '.join(missing)}."
        if self.shares[worst] < INFORMATION_LIMIT_PERCENT:
            which = " and of the ".join(self.flown_fewer_than(CHECKED))
            return f"CONTINUE: one input of the {which} cannot show its own error; one more will."
        if self.hidden:
            return f"CONTINUE: {self.hidden}."
        share = self.shares[worst]
        said = times_its_tolerance(0.01 * share) if isfinite(share) else "unknown"
        return f"CONTINUE: the error of {symbol(worst)} is {said}."

    def next(self) -> NextInput:
        """Return the next input with the number of further manoeuvres, or the remedy that comes before."""
        if remedy := self.hidden.partition("; ")[2]:
            return NextInput(f"next: {remedy}", None, self.worst)
        missing = self.flown_fewer_than(1) or self.flown_fewer_than(CHECKED)
        newest = self.flown[-1] if self.flown else None
        control = missing[0] if missing else self.judged[self.worst]
        if newest and newest.remedy and (
            newest.control in missing or self.percent_of(newest.control) >= INFORMATION_LIMIT_PERCENT
        ):  # fmt: skip
            control = newest.control
        percent = self.percent_of(control)
        advised = next_lateral(control, percent, self.accepted, self.flown, self.aircraft, self.worst)
        return replace(advised, remaining=self._remaining())

    def _remaining(self) -> Remaining | None:
        """Return the expected number of further manoeuvres; None if no forecast is possible."""
        # The variance of a derivative falls with the number of manoeuvres that move its control.
        controls, accepted = sorted(set(self.judged.values())), len(self.accepted)
        times = np.array([self.times(control) for control in controls])
        worst = np.array([self.percent_of(control) for control in controls])
        if not np.all(times) or not np.all(np.isfinite(worst)):
            return None
        # The residuals of the first manoeuvres count as one comparison of each judged derivative.
        scale = variance_scale(max(len(controls) * (accepted - 1), len(self.judged)))[:, None]
        within = np.ceil(times * (worst / INFORMATION_LIMIT_PERCENT) ** 2 * scale)
        each = np.maximum(np.maximum(within, CHECKED) - times, 0.0)
        # Manoeuvres that move several controls at once count for each of them.
        needed = np.maximum(each.max(axis=1), np.ceil(each.sum(axis=1) * accepted / times.sum()))
        return until_usable(np.maximum(needed, 1.0), Share(accepted, len(self.history) - accepted))


def lateral_flight_test(
    history: Sequence[AxisEstimate | None],
    joint: AxisEstimate | None,
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
    test = _SideTest(history, joint, aircraft, flown, controls)
    percent = {name: share if isfinite(share) else None for name, share in test.shares.items()}
    now = percent[test.worst]
    before = tuple(earlier.percent.get(_RULE) for earlier in heard)
    progress = RuleProgress(
        first_stop(heard, _RULE) or (len(history) if test.holds else None),
        (*before, now) if len(before) < len(history) else before,
        INFORMATION_LIMIT_PERCENT,
        parameter_percent=percent,
        now_percent=now,
        holds=test.holds,
    )
    usable = {i for i, estimate in enumerate(history) if estimate is not None}
    criterion = Criterion(_RULE, {_RULE: progress}, test.sentence, test.next, len(history), usable)
    return concluded(criterion, heard, change, () if change is None else (change.sentence,))
