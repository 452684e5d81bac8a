"""Stop criterion as the crew heard it: after each manoeuvre, by the estimates of that moment.

A later estimate, such as one that knows the servo's lag, changes the criterion of earlier manoeuvres. What a
crew has heard stays. The faces also show the criterion by the newest estimates.
"""

from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, replace

from advisor.decision.verdict import FlightTestVerdict, Remaining, RuleProgress


@dataclass(frozen=True, slots=True)
class Heard:
    """Stop criterion of every rule after one manoeuvre, by the estimates of that moment."""

    percent: Mapping[str, float | None]
    """Rule to its stop criterion, per cent. None: the rule has no value yet."""
    stops: frozenset[str]
    """Rules whose stop criterion held."""
    usable: frozenset[int] = frozenset()
    """Positions of the usable manoeuvres among those flown."""
    remaining: Remaining | None = None
    """Forecast of further manoeuvres that was spoken."""

    @classmethod
    def of(cls, verdict: FlightTestVerdict, usable: Sequence[int] = ()) -> "Heard":
        """Return what a verdict says of the newest manoeuvre."""
        rules = verdict.by_rule.items()
        return cls(
            {rule: one.now_percent for rule, one in rules},
            frozenset(rule for rule, one in rules if one.holds),
            frozenset(usable),
            verdict.next.remaining if verdict.next is not None else None,
        )


def first_stop(heard: Sequence[Heard], rule: str) -> int | None:
    """Return the number of manoeuvres at the first stop of a rule that a crew has heard; None without one."""
    return next((n for n, one in enumerate(heard, start=1) if rule in one.stops), None)


def stays(heard: Sequence[Heard], rule: str, usable: AbstractSet[int]) -> bool:
    """Return whether a stop that the crew has heard still rests on manoeuvres that are ``usable``."""
    stopped = first_stop(heard, rule)
    return stopped is not None and heard[stopped - 1].usable <= usable


def as_heard(found: RuleProgress, rule: str, heard: Sequence[Heard]) -> RuleProgress:
    """Return the progress of a rule with the history that the crew heard.

    Parameters
    ----------
    found
        Progress of the rule by the newest estimates.
    heard
        What was heard after each of the first manoeuvres. All other fields are equal to those of ``found``.
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
    """Return a forecast; None where it is further from the last one than the last one's own band.

    A forecast that jumps foretells nothing. The next one is spoken again.

    Parameters
    ----------
    before
        What was heard after the manoeuvre before the newest.
    """
    last = before.remaining if before is not None else None
    if found is None or last is None or last.median is None or last.p90 is None:
        return found
    if found.median is None:
        return None
    return found if abs(found.median - (last.median - 1)) <= last.p90 - last.median else None
