"""Conclusion from a stop criterion, for every axis: stop or continue, with a sentence."""

from collections.abc import Callable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, replace

from advisor.aircraft.aircraft import Rule
from advisor.decision.change import Change
from advisor.decision.heard import Heard, spoken_after, stays
from advisor.decision.verdict import FlightTestVerdict, NextInput, Remaining, RuleProgress

ENOUGH = NextInput("no further manoeuvre needed", Remaining(0, 0))
"""Advice after the stop."""


@dataclass(frozen=True, slots=True)
class Criterion:
    """The stop criterion of one axis after its newest manoeuvre."""

    rule: Rule
    by_rule: Mapping[str, RuleProgress]
    """Progress of each rule, by its name, with the history that the crew heard."""
    sentence: Callable[[bool], str]
    """Function that returns the sentence about the criterion, given whether the test stops."""
    next: Callable[[], NextInput]
    """Function that returns the next input if the test continues."""
    flown: int
    """Number of manoeuvres flown."""
    usable: AbstractSet[int]
    """Indices of the usable manoeuvres among the flown ones."""

    @property
    def chosen(self) -> RuleProgress:
        """Progress of the rule that decides."""
        return self.by_rule[self.rule]


def concluded(
    criterion: Criterion,
    heard: Sequence[Heard],
    change: Change | None = None,
    warnings: tuple[str, ...] = (),
    evidence: tuple[str, ...] = (),
) -> FlightTestVerdict:
    """Return the verdict on a flight test.

    A test stops if the criterion of the chosen rule holds now. A stop that the crew has heard remains valid.
    The stop is withdrawn after a change of the aircraft, or if one of its manoeuvres is no longer usable.
    """
    chosen = criterion.chosen
    changed = change.sentence if change is not None and change.confirmed else ""
    stop = chosen.holds or (not changed and stays(heard, criterion.rule, criterion.usable))
    if stop and not chosen.holds:
        said = (
            f"TEST COMPLETE since manoeuvre {chosen.stopped_at}: no change of the aircraft was found since."
        )
    elif not stop and changed and chosen.stopped_at is not None:
        said = f"CONTINUE: {changed}"
    else:
        said = criterion.sentence(stop)
    following = ENOUGH if stop else criterion.next()
    before = heard[criterion.flown - 2] if 1 < criterion.flown <= len(heard) + 1 else None
    return FlightTestVerdict(
        rule=criterion.rule,
        decision="stop" if stop else "continue",
        sentence=said,
        criterion_percent=chosen.now_percent,
        limit_percent=chosen.limit_percent,
        stopped_at=chosen.stopped_at,
        by_rule=criterion.by_rule,
        next=replace(following, remaining=spoken_after(before, following.remaining)),
        warnings=warnings,
        evidence=evidence,
    )
