"""Input of the rules: the manoeuvres of a campaign in the order flown, and the criteria that the crew has
heard.

Every rule depends on the whole history, so the exclusion of a manoeuvre changes later decisions. The cache
between decisions (``CriterionCourse``) changes no decision.

A later estimate, such as one with a known servo lag, changes the criterion of earlier manoeuvres. The
criterion that a crew has heard is not changed. Screens and pages also show the criterion from the newest
estimates.
"""

from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field, replace
from math import inf

from advisor.decision.verdict import FlightTestVerdict, ManeuverVerdict, Reason, Remaining, RuleProgress
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.surface import Servo


@dataclass(frozen=True, slots=True)
class CandidateManeuver:
    """One manoeuvre before any rule judges it."""

    estimate: Estimate | NoEstimate
    reasons: tuple[Reason, ...] = ()
    """Objections to the manoeuvre itself (too gentle, banked, ...), the most important first."""
    cautions: tuple[str, ...] = ()
    """Remarks for the verdict that do not reject the manoeuvre."""
    excluded_because: str | None = None
    """Reason why an engineer excluded the manoeuvre; None for an included one."""
    maneuver: Maneuver | None = None
    """Flown data, for advice on the next input."""
    air_moved: bool = False
    """Whether the manoeuvre's residuals show moving air."""
    servo: Servo = field(default_factory=Servo)
    """Servo between command and surface, as the estimate uses it."""

    responses: tuple[str, ...] = ("alpha", "q")
    """Outputs that show the response to the input."""

    @property
    def usable(self) -> Estimate | None:
        """Estimate of a manoeuvre for the rules. None if the manoeuvre is excluded, rejected or without an
        estimate."""
        if isinstance(self.estimate, Estimate) and not self.reasons and self.excluded_because is None:
            return self.estimate
        return None


def usable_ones(history: Sequence[CandidateManeuver]) -> list[CandidateManeuver]:
    """Return all usable manoeuvres, in the order flown."""
    return [flown for flown in history if flown.usable]


def nothing_tested(history: Sequence[CandidateManeuver]) -> str:
    """Return the sentence about a history without a usable manoeuvre; empty if one is usable."""
    if usable_ones(history):
        return ""
    if not has_begun(history):
        return "No test input of the elevator has been flown."
    single = len(history) == 1
    which = "The one input" if single else f"None of the {len(history)} inputs"
    return f"{which} of the elevator can{'not' if single else ''} be used."


def has_begun(history: Sequence[CandidateManeuver]) -> bool:
    """Return whether the test of an axis has begun: by a named or marked input, or by a usable movement."""
    return any(
        flown.maneuver is None or flown.maneuver.span.is_test_input or flown.usable for flown in history
    )


def is_named(flown: CandidateManeuver) -> bool:
    """Return whether a crew can repeat the input, because its shape has a name."""
    return flown.maneuver is None or flown.maneuver.span.kind != "other"


def estimates_of(usable: Sequence[CandidateManeuver]) -> list[Estimate]:
    """Return the estimates of the usable manoeuvres, in the order flown."""
    return [estimate for flown in usable if (estimate := flown.usable)]


@dataclass(frozen=True, slots=True)
class Heard:
    """Stop criterion of every rule after one manoeuvre, from the estimates at that time."""

    percent: Mapping[str, float | None]
    """Stop criterion of each rule, per cent, by the rule's name. None if the rule has no value yet."""
    stops: frozenset[str]
    """Names of the rules whose stop criterion held."""
    usable: frozenset[int] = frozenset()
    """Indices of the usable manoeuvres among the flown ones."""
    remaining: Remaining | None = None
    """Forecast of further manoeuvres that the crew heard."""

    @classmethod
    def of(cls, verdict: FlightTestVerdict, usable: Sequence[int] = ()) -> "Heard":
        """Return the criterion of every rule in a verdict on the newest manoeuvre."""
        rules = verdict.by_rule.items()
        return cls(
            {rule: progress.now_percent for rule, progress in rules},
            frozenset(rule for rule, progress in rules if progress.holds),
            frozenset(usable),
            verdict.next.remaining if verdict.next is not None else None,
        )


def first_stop(heard: Sequence[Heard], rule: str) -> int | None:
    """Return the number of manoeuvres at the first stop of a rule that the crew heard; None without a
    stop."""
    return next((n for n, earlier in enumerate(heard, start=1) if rule in earlier.stops), None)


def stays(heard: Sequence[Heard], rule: str, usable: AbstractSet[int]) -> bool:
    """Return whether all manoeuvres behind a stop that the crew has heard are still ``usable``."""
    stopped = first_stop(heard, rule)
    return stopped is not None and heard[stopped - 1].usable <= usable


def as_heard(progress: RuleProgress, rule: str, heard: Sequence[Heard]) -> RuleProgress:
    """Return the progress of a rule with the history that the crew heard.

    Parameters
    ----------
    heard
        Criterion that the crew heard after each of the first manoeuvres. All other fields are equal to those
        of ``progress``.
    """
    n, flown = len(heard), len(progress.hindsight_percent)
    stopped = first_stop(heard, rule)
    if stopped is None and progress.hindsight_stopped_at is not None:
        # A stop that only the newest estimates show is heard now, after the newest manoeuvre.
        stopped = progress.hindsight_stopped_at if progress.hindsight_stopped_at > n else None
        stopped = flown if stopped is None and progress.holds else stopped
    said = tuple(earlier.percent.get(rule) for earlier in heard)
    return replace(progress, stopped_at=stopped, history_percent=(*said, *progress.hindsight_percent[n:]))


def spoken_after(
    before: Heard | None, forecast: Remaining | None, rule: str, now: float | None
) -> Remaining | None:
    """Return the forecast to announce. Once a number was announced, every later forecast has a number.

    A forecast is a distribution over the number of manoeuvres still needed. A further manoeuvre narrows the
    distribution, or the forecast gives the reason why not.

    Parameters
    ----------
    before
        Criterion that the crew heard after the manoeuvre before the newest one.
    forecast
        Forecast from the present estimates; None without one.
    rule, now
        Rule that decides, and its present criterion, per cent.
    """
    last = before.remaining if before is not None else None
    if before is None or last is None or last.median is None:
        return forecast
    expected = max(last.median - 1, 1)
    most = None if last.p90 is None else max(last.p90 - 1, 1)
    if forecast is None:
        return Remaining(expected, most, "the newest manoeuvre does not change the number")
    if forecast.median is not None and (most is None or _most(forecast) <= most):
        return forecast
    return replace(forecast, why=_why(before.percent.get(rule), now))


def _most(forecast: Remaining) -> float:
    """Return the number that nine of ten forecasts do not exceed; infinite without one."""
    return inf if forecast.p90 is None else forecast.p90


def _why(before: float | None, now: float | None) -> str:
    """Return the reason for a forecast that does not narrow, from the criterion before and now, per cent."""
    if before is None or now is None or now <= before:
        return "the newest manoeuvre gave less information than forecast"
    return f"the criterion rose from {before:.0f} to {now:.0f} %"


def revision(before: ManeuverVerdict, after: ManeuverVerdict, newest: int) -> str:
    """Return a sentence about a verdict that changed; empty where the manoeuvre is judged as before.

    Parameters
    ----------
    before, after
        Verdict that the crew heard, and the present verdict on the same manoeuvre.
    newest
        Number of the newest manoeuvre, whose data changed the verdict.
    """
    if before.accepted == after.accepted:
        return ""
    if after.accepted:
        return f"refused before, accepted since manoeuvre {newest}: it no longer {_fault(before)}"
    return f"accepted before, refused since manoeuvre {newest}: {_objection(after)}"


def _objection(refused: ManeuverVerdict) -> str:
    return refused.reasons[0].text if refused.reasons else refused.sentence


def _fault(refused: ManeuverVerdict) -> str:
    """Return the former objection without its remedy, as a clause."""
    said = _objection(refused).partition("; ")[0]
    return said if said.startswith("contradicts") else f"counts against it that {said}"
