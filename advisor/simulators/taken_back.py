"""Corrections that make the gap worse on manoeuvres kept apart: they leave the answer and its simulator."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Protocol, TypeVar

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.diagnose import Examined
from advisor.gap.result import VISIBLE, spelled
from advisor.simulators.unseen import UnseenManeuvers, by_the_file, resaid, shrink_on


class _Gap(Protocol):
    """The gap of the manoeuvres kept apart."""

    @property
    def gap_before(self) -> float:
        """Gap of the simulator as given."""

    @property
    def gap_after(self) -> float:
        """Gap with the corrections."""


Measured = TypeVar("Measured", bound=_Gap)


def without_worse(
    whole: Examined, unseen: UnseenManeuvers, measure: Callable[[UnseenManeuvers], Measured]
) -> tuple[Examined, Measured]:
    """Return the diagnosis without effects that raise the gap visibly, and the measurement without them.

    The sets are those of the search: its numbers, then one effect more at a time. The set with the least gap
    on the manoeuvres kept apart stays, and the sentence names each effect that was taken back.

    Parameters
    ----------
    whole
        Diagnosis of all manoeuvres.
    unseen
        Manoeuvres kept apart, with the diagnosis of the others.
    measure
        Measures the gap of the manoeuvres kept apart with the answer of the others.
    """
    found = unseen.found
    every = best = measure(unseen)
    stay = len(found.named)
    for most in reversed(range(stay)):
        tried = measure(replace(unseen, found=found.with_most(most)))
        if tried.gap_after < best.gap_after - VISIBLE:
            best, stay = tried, most
    numbers = [flight.number for flight in whole.findings.problem.flights.flights]
    kept = [numbers[i] for i in unseen.kept]
    if best.gap_after > best.gap_before + VISIBLE:
        said = taken_back_said(["every correction"], kept, every.gap_after, best.gap_before)
        told = replace(whole.diagnosis, effects={}, taken_back=(said,), is_left_as_given=True)
        return replace(whole, diagnosis=told), best
    taken = [k for k, name in enumerate(whole.named) if name in found.named[stay:]]
    if not taken:
        return whole, every
    effects = [spelled(effect) for effect in whole.named[taken[0] :]]
    said = taken_back_said(effects, kept, every.gap_after, best.gap_after)
    stays = whole.with_most(taken[0])
    return replace(stays, diagnosis=replace(stays.diagnosis, taken_back=(said,))), best


def with_unseen_shrink(whole: Examined, unseen: UnseenManeuvers, aircraft: Aircraft) -> Examined:
    """Return the diagnosis against an aircraft file's model, with the shrink on the manoeuvres kept apart."""
    if whole.findings.problem.prior_derivatives is None:
        return whole
    stays, flown = without_worse(whole, unseen, partial(by_the_file, whole))
    shrink = shrink_on(stays, unseen, flown.before, flown.after)
    return replace(stays, diagnosis=resaid(stays.diagnosis, shrink, aircraft))


def taken_back_said(parts: Sequence[str], maneuvers: Sequence[int], worse: float, better: float) -> str:
    """Return the sentence on corrections that raise the gap of manoeuvres kept apart."""
    flown = f"manoeuvre{'s' if len(maneuvers) > 1 else ''} {', '.join(map(str, maneuvers))}"
    return (
        f"Taken back: {' and '.join(parts)}, with which the gap is {worse:.3g} instead of {better:.3g} on "
        f"{flown}, which no fit has used."
    )
