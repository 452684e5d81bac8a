"""Stop criterion as heard by the crew after each manoeuvre, from the estimates at that time.

A later estimate, such as one with a known servo lag, changes the criterion of earlier manoeuvres. The
criterion that a crew has heard is not changed. Screens and pages also show the criterion from the newest
estimates.
"""

from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, replace

from advisor.decision.verdict import FlightTestVerdict, Remaining, RuleProgress


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
            {rule: one.now_percent for rule, one in rules},
            frozenset(rule for rule, one in rules if one.holds),
            frozenset(usable),
            verdict.next.remaining if verdict.next is not None else None,
        )


def first_stop(heard: Sequence[Heard], rule: str) -> int | None:
    """Return the number of manoeuvres at the first stop of a rule that the crew heard; None without a
    stop."""
    return next((n for n, one in enumerate(heard, start=1) if rule in one.stops), None)


def stays(heard: Sequence[Heard], rule: str, usable: AbstractSet[int]) -> bool:
    """Return whether all manoeuvres behind a stop that the crew has heard are still ``usable``."""
    stopped = first_stop(heard, rule)
    return stopped is not None and heard[stopped - 1].usable <= usable


def as_heard(found: RuleProgress, rule: str, heard: Sequence[Heard]) -> RuleProgress:
    """Return the progress of a rule with the history that the crew heard.

    Parameters
    ----------
    heard
        Criterion that the crew heard after each of the first manoeuvres. All other fields are equal to those
        of ``found``.
    """
    n, flown = len(heard), len(found.hindsight_percent)
    stopped = first_stop(heard, rule)
    if stopped is None and found.hindsight_stopped_at is not None:
        # A stop that only the newest estimates show is heard now, after the newest manoeuvre.
        stopped = found.hindsight_stopped_at if found.hindsight_stopped_at > n else None
        stopped = flown if stopped is None and found.holds else stopped
    told = tuple(one.percent.get(rule) for one in heard)
    return replace(found, stopped_at=stopped, history_percent=(*told, *found.hindsight_percent[n:]))


def spoken_after(before: Heard | None, found: Remaining | None) -> Remaining | None:
    """Return a forecast; None if it differs from the last one by more than the last one's band.

    A forecast that jumps has no value for the crew. The next forecast is announced again.

    Parameters
    ----------
    before
        Criterion that the crew heard after the manoeuvre before the newest one.
    """
    last = before.remaining if before is not None else None
    if found is None or last is None or last.median is None or last.p90 is None:
        return found
    if found.median is None:
        return None
    return found if abs(found.median - (last.median - 1)) <= last.p90 - last.median else None
