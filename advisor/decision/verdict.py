"""Verdicts on manoeuvres and on the flight test, the next input, and the plan of both axes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf
from typing import TYPE_CHECKING, Literal

from advisor.aircraft.aircraft import CampaignPlan, Rule

if TYPE_CHECKING:
    from advisor.decision.inputs import StepInput


INFORMATION_LIMIT_PERCENT = 100.0
"""Limit of the rule ``information``, whose criterion is in percent of the tolerance."""


def limit_percent(rule: Rule, plan: CampaignPlan) -> float:
    """Return the limit below which the criterion of ``rule`` must fall."""
    return INFORMATION_LIMIT_PERCENT if rule == "information" else plan.limit_percent


UNTRUSTED = frozenset({"missing", "frozen"})
"""Codes of reasons for a faulty channel. No other finding from a faulty channel is reported."""
NO_TEST = "NO TEST INPUT"
"""Word for a movement before the first test input of its axis, such as a pilot's trimming."""
NO_CURE_BY_INPUT = UNTRUSTED | {"rate", "gap", "advisor_down", "clock"}
"""Codes of reasons that no input can remedy. With such a reason the advice names no other input."""


@dataclass(frozen=True, slots=True)
class Reason:
    """Reason against a manoeuvre: a number, its limit, and the remedy."""

    code: str
    """Stable identifier of the reason, such as ``bank``, ``amplitude``, ``information`` or ``fit``."""
    text: str
    """Sentence about the reason for pilots, with the remedy."""
    value: float
    limit: float
    by_instrument: bool = False
    """Whether an instrument is the cause, so that other flying is no remedy."""

    @property
    def fact(self) -> str:
        """Number and limit without the remedy."""
        return self.text.partition("; ")[0]

    @property
    def remedy(self) -> str:
        """Remedy after the number and its limit; empty for a reason without one."""
        return self.text.partition("; ")[2]


def with_one_remedy(reasons: Sequence[Reason]) -> tuple[Reason, ...]:
    """Return reasons of which only the first has a remedy.

    The first reason is the cause. A remedy for its consequences may contradict the remedy of the cause. Bank
    asks for less stick, and a poor fit for more.
    """
    return tuple(reason if k == 0 else replace(reason, text=reason.fact) for k, reason in enumerate(reasons))


@dataclass(frozen=True, slots=True)
class RuleResult:
    """Result of one rule for one manoeuvre."""

    accepted: bool
    limit: float | None
    """Limit of the cost J. None if the rule had no earlier manoeuvre for comparison."""


@dataclass(frozen=True, slots=True)
class ManeuverVerdict:
    """Verdict on one manoeuvre."""

    accepted: bool
    sentence: str
    """One line for a pilot, such as ``REPEAT: too gentle, ...``."""
    reasons: tuple[Reason, ...]
    """Reasons against the manoeuvre, the most important first; empty for an accepted one."""
    rules: Mapping[str, RuleResult]
    """Result of each rule for the manoeuvre, by the rule's name, whichever rule decides."""
    cautions: tuple[str, ...] = ()
    """Remarks that do not reject the manoeuvre, such as the provenance of alpha."""


@dataclass(frozen=True, slots=True)
class RuleProgress:
    """Progress of the stop criterion under one rule."""

    stopped_at: int | None
    """Number of manoeuvres at the first stop of this rule that the crew heard. None without a stop."""
    history_percent: tuple[float | None, ...]
    """Criterion after each manoeuvre, as the crew heard it. None with too few manoeuvres for the rule; for
    roll and yaw also after the stop."""
    limit_percent: float = 25.0
    """Limit of the criterion: 25 % of Eq. (12), or 100 % of the tolerance for ``information``."""
    prediction_percent: Mapping[str, float | None] = field(default_factory=dict)
    """Half-width of each output's 95 % band under ``information``, % of its peak, by the output's name. None
    if unknown."""
    parameter_percent: Mapping[str, float | None] = field(default_factory=dict)
    """95 % half-width of each named parameter under ``information``, % of its tolerance, by name."""
    now_percent: float | None = None
    """Present criterion from the newest estimates. None if the rule has no value yet."""
    hindsight_percent: tuple[float | None, ...] = ()
    """Criterion after each manoeuvre, recomputed from the newest estimates. Empty if earlier values are not
    recomputed."""
    hindsight_stopped_at: int | None = None
    """Number of manoeuvres at the first stop of the recomputed criterion. None without a stop."""
    holds: bool = False
    """Whether the stop criterion holds now."""

    @property
    def percent_of_limit(self) -> tuple[float | None, ...]:
        """Criterion after each manoeuvre as the crew heard it, in per cent of the rule's limit."""
        return tuple(map(self._of_limit, self.history_percent))

    @property
    def now_percent_of_limit(self) -> float | None:
        """Criterion from the newest estimates, in per cent of the rule's limit; None without a value."""
        return self._of_limit(self.now_percent)

    @property
    def hindsight(self) -> str:
        """Sentence about a recomputed criterion that differs from the heard one; empty if both agree."""
        again, heard = (
            tuple("–" if v is None else f"{v:.1f}" for v in values)
            for values in (self.hindsight_percent, self.history_percent)
        )
        if not again or again == heard:
            return ""
        enough = self.hindsight_stopped_at
        stop = "no stop" if enough is None else f"manoeuvre {enough} would have been the last"
        return f"by the newest estimates {' '.join(again)} %: {stop}"

    def _of_limit(self, value: float | None) -> float | None:
        return None if value is None else 100.0 * value / self.limit_percent


@dataclass(frozen=True, slots=True)
class Remaining:
    """Expected number of further manoeuvres. None if no end is in sight."""

    median: int | None
    p90: int | None
    why: str = ""
    """Reason why the forecast is no narrower than the last one; empty if it is."""

    @property
    def spoken(self) -> str:
        """Forecast as spoken to a pilot: ``about 2 more, 9 times in 10 at most 4``."""
        why = f" ({self.why})" if self.why else ""
        if self.median is None:
            return f"no end in sight{why}"
        at_most = f", 9 times in 10 at most {self.p90}" if self.p90 is not None else ""
        return f"about {self.median} more{at_most}{why}"


@dataclass(frozen=True, slots=True)
class NextInput:
    """Next input to fly."""

    advice: str
    """Advice as spoken to a pilot: ``next: reverse 3-2-1-1, 0.4 s steps, 60 % stick``."""
    remaining: Remaining | None
    """Expected number of further manoeuvres; None before a usable manoeuvre."""
    holding_back: str | None = None
    """Name of the parameter or predicted output that delays the stop."""
    input: "StepInput | None" = None
    """Input in the advice; None if the advice names none."""

    @property
    def foretold(self) -> str:
        """Expected number of further manoeuvres as spoken to a pilot; empty without a forecast."""
        return self.remaining.spoken if self.remaining is not None else ""


@dataclass(frozen=True, slots=True)
class FlightTestVerdict:
    """Verdict on the flight test: whether testing may stop."""

    rule: Rule
    decision: Literal["stop", "continue"]
    sentence: str
    criterion_percent: float | None
    limit_percent: float
    stopped_at: int | None
    by_rule: Mapping[str, RuleProgress] = field(default_factory=dict)
    next: NextInput | None = None
    warnings: tuple[str, ...] = ()
    """Warnings, such as a change between manoeuvres or a criterion that cannot fall."""
    evidence: tuple[str, ...] = ()
    """Numbers of the rule ``information``, one line each, whichever rule decides."""


_IS = {"pitch": "is", "roll and yaw": "are"}
"""Verb that follows the name of each axis in a sentence."""


@dataclass(frozen=True, slots=True)
class CrewPlan:
    """Plan of a flight that tests the elevator and also the aileron or the rudder."""

    done: tuple[str, ...]
    """Axes with a complete test, ``pitch`` or ``roll and yaw``."""
    open: tuple[str, ...]
    """Axes with an open test, the one farthest from its limit first."""
    next: NextInput | None
    """Next input of the first open axis; None without advice."""

    @property
    def sentence(self) -> str:
        """Sentence about the plan: ``Pitch is complete, roll and yaw are open.``."""
        clauses = [f"{axis} {_IS[axis]} complete" for axis in self.done]
        clauses += [f"{axis} {_IS[axis]} open" for axis in self.open]
        said = ", ".join(clauses)
        return f"{said[0].upper()}{said[1:]}."

    @property
    def advice(self) -> str:
        """Next input as spoken to a pilot; empty without advice."""
        return self.next.advice if self.next is not None else ""

    @property
    def announced(self) -> str:
        """Text of the plan for a ground station; empty until an axis is complete."""
        if not self.done:
            return ""
        return f"TEST COMPLETE: {self.sentence}" if self.is_complete else self.sentence

    @property
    def is_complete(self) -> bool:
        return not self.open


def crew_plan(pitch: FlightTestVerdict, roll_and_yaw: FlightTestVerdict) -> CrewPlan:
    """Return the plan of a flight on which both axes are tested."""
    verdicts = {"pitch": pitch, "roll and yaw": roll_and_yaw}
    going_on = {axis: verdict for axis, verdict in verdicts.items() if verdict.decision != "stop"}
    still = sorted(going_on, key=lambda axis: -_share_of_limit(going_on[axis]))
    return CrewPlan(
        done=tuple(axis for axis in verdicts if axis not in going_on),
        open=tuple(still),
        next=going_on[still[0]].next if still else pitch.next,
    )


def _share_of_limit(verdict: FlightTestVerdict) -> float:
    """Return the criterion over its limit; infinite without a criterion."""
    now = verdict.criterion_percent
    return inf if now is None else now / verdict.limit_percent
