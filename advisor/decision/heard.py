"""Stop criterion as heard by the crew after each manoeuvre, from the estimates at that time.

A later estimate, such as one with a known servo lag, changes the criterion of earlier manoeuvres. The
criterion that a crew has heard is not changed. Screens and pages also show the criterion from the newest
estimates.
"""

from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, replace
from math import inf

from advisor.decision.verdict import FlightTestVerdict, ManeuverVerdict, Remaining, RuleProgress


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
