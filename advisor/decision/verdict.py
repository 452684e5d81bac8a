"""What the crew is told: verdict, sentence, evidence."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from advisor.aircraft import CampaignPlan, Rule

INFORMATION_LIMIT_PERCENT = 100.0
"""The rule ``information`` counts in percent of the tolerance."""


def limit_percent(rule: Rule, plan: CampaignPlan) -> float:
    """What the criterion of ``rule`` must fall below."""
    return INFORMATION_LIMIT_PERCENT if rule == "information" else plan.limit_percent


UNTRUSTED = frozenset({"missing", "frozen", "contradiction"})
"""Codes of reasons that lie in a channel: whatever else the data seem to show is not worth a word."""
NO_CURE_BY_INPUT = UNTRUSTED | {"rate", "gap"}
"""Codes of reasons that no input cures: with them nobody is told to fly a larger or another one."""


@dataclass(frozen=True, slots=True)
class Reason:
    """Why a manoeuvre is not accepted: a number beside its limit, and what to do."""

    code: str
    """Stable: ``bank``, ``amplitude``, ``information``, ``fit``, ``rate``, ``gap``, ``cost``, ..."""
    text: str
    """A sentence for pilots, with what to do."""
    value: float
    limit: float


@dataclass(frozen=True, slots=True)
class RuleResult:
    """What one rule says of one manoeuvre."""

    accepted: bool
    limit: float | None
    """The cost J it was held against; None where the rule had nothing to compare with."""


@dataclass(frozen=True, slots=True)
class ManeuverVerdict:
    """Was that manoeuvre good."""

    accepted: bool
    sentence: str
    """One line a pilot can act on, e.g. ``REPEAT: too gentle, ...``."""
    reasons: tuple[Reason, ...]
    """Empty when accepted; the most telling first."""
    rules: Mapping[str, RuleResult]
    """What every rule would have said, by its name."""
    cautions: tuple[str, ...] = ()
    """What does not reject the manoeuvre but belongs on its verdict: provenance of alpha, lags, ..."""


@dataclass(frozen=True, slots=True)
class RuleProgress:
    """The stop criterion under one rule."""

    stopped_at: int | None
    """Number of manoeuvres flown when this rule said stop; None: not yet."""
    history_percent: tuple[float | None, ...]
    """The criterion after each manoeuvre; None while there are too few."""
    limit_percent: float = 25.0
    """What the criterion must fall below: 25 % of Eq. (12), 100 % of the tolerance for ``information``."""
    prediction_percent: Mapping[str, float | None] = field(default_factory=dict)
    """``information``: output to the 95 % band of its predicted response now, in percent of its peak; None:
    unknown."""
    parameter_percent: Mapping[str, float | None] = field(default_factory=dict)
    """``information``: named parameter to its 95 % half-width now, in percent of its own tolerance."""


@dataclass(frozen=True, slots=True)
class Remaining:
    """How many more manoeuvres are expected; None: no end in sight."""

    median: int | None
    p90: int | None

    @property
    def spoken(self) -> str:
        """As a pilot hears it: ``about 2 more, 9 times in 10 at most 4``."""
        if self.median is None:
            return "no end in sight"
        at_most = f", 9 times in 10 at most {self.p90}" if self.p90 is not None else ""
        return f"about {self.median} more{at_most}"


@dataclass(frozen=True, slots=True)
class NextInput:
    """What to fly next."""

    advice: str
    """As a pilot hears it: ``next: reverse 3-2-1-1, 0.4 s steps, 60 % stick``."""
    remaining: Remaining | None
    """None while no manoeuvre was usable: nothing foretells it."""
    holding_back: str | None = None
    """The parameter, or the output whose prediction, keeps the stop away."""

    @property
    def foretold(self) -> str:
        """How many more are expected, as a pilot hears it; empty while nothing foretells it."""
        return self.remaining.spoken if self.remaining is not None else ""


@dataclass(frozen=True, slots=True)
class FlightTestVerdict:
    """May we stop testing."""

    rule: Rule
    decision: Literal["stop", "continue"]
    sentence: str
    criterion_percent: float | None
    limit_percent: float
    stopped_at: int | None
    by_rule: Mapping[str, RuleProgress] = field(default_factory=dict)
    next: NextInput | None = None
    warnings: tuple[str, ...] = ()
    """Something changed between manoeuvres, the criterion cannot fall, ..."""
    evidence: tuple[str, ...] = ()
    """The numbers behind the rule ``information``, whichever rule decides, a line each."""
