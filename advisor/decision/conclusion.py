"""Conclusion from a stop criterion, for every axis: stop or continue, with a sentence."""

from collections.abc import Callable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, replace

from advisor.aircraft.aircraft import Rule
from advisor.decision.change import Change
from advisor.decision.heard import Heard, first_stop, spoken_after, stays
from advisor.decision.verdict import FlightTestVerdict, NextInput, Remaining, RuleProgress

ENOUGH = NextInput("no further manoeuvre needed", Remaining(0, 0))
"""Advice after a stop that no later data contradict."""


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
    If later data deny the stop, the verdict names the input that closes the criterion again.
    """
    chosen = criterion.chosen
    changed = change.sentence if change is not None and change.confirmed else ""
    stop = chosen.holds or (not changed and stays(heard, criterion.rule, criterion.usable))
    if chosen.holds or chosen.stopped_at is None:
        said = criterion.sentence(stop)
    elif stop:
        said = f"TEST COMPLETE since manoeuvre {chosen.stopped_at}{_since(criterion)}"
    elif changed:
        said = f"CONTINUE: {changed}"
    else:
        said = f"CONTINUE: {_denied(criterion, heard)}; {_open_now(criterion)}"
    is_denied = stop and not chosen.holds and chosen.now_percent is not None
    following = criterion.next() if is_denied or not stop else ENOUGH
    before = heard[criterion.flown - 2] if 1 < criterion.flown <= len(heard) + 1 else None
    return FlightTestVerdict(
        rule=criterion.rule,
        decision="stop" if stop else "continue",
        sentence=said,
        criterion_percent=chosen.now_percent,
        limit_percent=chosen.limit_percent,
        stopped_at=chosen.stopped_at,
        by_rule=criterion.by_rule,
        next=replace(following, remaining=_foretold(stop, before, following.remaining, criterion)),
        warnings=warnings,
        evidence=evidence,
    )


def _open_now(criterion: Criterion) -> str:
    """Return a clause on the part of the criterion that does not hold now."""
    return criterion.sentence(False).removeprefix("CONTINUE: ")


def _since(criterion: Criterion) -> str:
    """Return the end of the sentence about a stop that was heard and whose criterion does not hold now."""
    if criterion.chosen.now_percent is None:
        return ": no change of the aircraft was found since."
    return f"; later data open it again: {_open_now(criterion)}"


def _denied(criterion: Criterion, heard: Sequence[Heard]) -> str:
    """Return a clause about a withdrawn stop, with the reason."""
    stopped_at = criterion.chosen.stopped_at
    if first_stop(heard, criterion.rule) is not None:
        return f"a manoeuvre behind the stop after manoeuvre {stopped_at} does not count any more"
    return f"later manoeuvres contradict the stop after manoeuvre {stopped_at}"


def _foretold(
    stop: bool, before: Heard | None, forecast: Remaining | None, criterion: Criterion
) -> Remaining | None:
    return forecast if stop else spoken_after(before, forecast, criterion.rule, criterion.chosen.now_percent)
