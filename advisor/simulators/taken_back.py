"""Corrections that increase the gap on held-out manoeuvres, which the improved simulator does not get.

The posterior gives the answer. A withdrawn correction shortens the improved simulator and changes no
probability.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.diagnose import Examined
from advisor.gap.fitting.measure import whole_gap
from advisor.gap.result import VISIBLE, spelled
from advisor.simulators.unseen import Flown, UnseenManeuvers, by_the_file, floor_of, resaid, shrink_on


def without_worse(
    whole: Examined, unseen: UnseenManeuvers, measure: Callable[[UnseenManeuvers], Flown]
) -> tuple[Examined, Flown]:
    """Return the diagnosis without further effects that visibly increase the gap, and the measurement without
    them.

    The candidate sets are the first effect alone, then one more effect each, in the order of the search.
    First the set with the least gap on manoeuvres held out in turn is kept. Then the set with the least gap
    on held-out manoeuvres is kept. A sentence names each withdrawn effect. If the whole correction increases
    the gap, the diagnosis offers no improved simulator.
    """
    whole = without_raised(whole)
    examined = unseen.examined
    every = best = measure(unseen)
    if every.on_paper:
        return whole, every
    stay = len(examined.named)
    for most in reversed(range(1, stay)):
        tried = measure(replace(unseen, examined=_shortened(examined, most)))
        if tried.gap_after < best.gap_after - VISIBLE:
            best, stay = tried, most
    numbers = [flight.number for flight in whole.findings.problem.flights.flights]
    kept = unused([numbers[i] for i in unseen.kept])
    if best.gap_after > best.gap_before + VISIBLE:
        said = taken_back_said(["every correction"], kept, best.gap_after, best.gap_before)
        diagnosis = replace(
            whole.diagnosis, taken_back=(*whole.diagnosis.taken_back, said), shrink=None, corrects=False
        )
        return replace(whole, diagnosis=diagnosis), best
    taken = [k for k, name in enumerate(whole.named) if name in examined.named[stay:]]
    if not taken:
        return whole, every
    return _without(whole, taken[0], kept, every.gap_after, best.gap_after), best


def _shortened(asked: Examined, most: int) -> Examined:
    """Return a diagnosis with at most the first ``most`` effects, measured with their model."""
    gone, models = asked.named[most:], asked.findings.models[: most + 1]
    left = {effect: sizes for effect, sizes in asked.diagnosis.effects.items() if effect not in gone}
    causes = tuple(
        replace(cause, present=cause.present and cause.effect not in gone) for cause in asked.diagnosis.causes
    )
    return replace(
        asked,
        diagnosis=replace(asked.diagnosis, effects=left, causes=causes),
        findings=replace(asked.findings, models=(*models[:-1], replace(models[-1], added=None))),
    )


def without_raised(whole: Examined) -> Examined:
    """Return a diagnosis without the further effects that increase the gap on manoeuvres held out in turn."""
    gaps = [whole_gap(model.held_out.mean_square, floor_of(whole)) for model in whole.findings.models]
    stay = len(whole.named)
    for most in reversed(range(1, stay)):
        if gaps[most] < gaps[stay] - VISIBLE:
            stay = most
    if stay == len(whole.named):
        return whole
    return _without(whole, stay, "manoeuvres held out in turn", gaps[-1], gaps[stay])


def _without(whole: Examined, most: int, flown: str, worse: float, better: float) -> Examined:
    """Return a diagnosis with at most the first ``most`` effects, which names the others and their gap."""
    effects = [spelled(effect) for effect in whole.named[most:]]
    said = (*whole.diagnosis.taken_back, taken_back_said(effects, flown, worse, better))
    stays = whole.with_most(most)
    return replace(stays, diagnosis=replace(stays.diagnosis, taken_back=said), fewer=whole.fewer)


def with_unseen_shrink(whole: Examined, unseen: UnseenManeuvers, aircraft: Aircraft) -> Examined:
    """Return the diagnosis against an aircraft file's model, with the shrink on held-out manoeuvres."""
    if whole.findings.problem.prior_derivatives is None:
        return whole
    stays, flown = without_worse(whole, unseen, partial(by_the_file, whole))
    if not stays.diagnosis.improves:
        return stays
    shrink = shrink_on(stays, unseen, flown.before, flown.after)
    return replace(stays, diagnosis=resaid(stays.diagnosis, shrink, aircraft))


def unused(maneuvers: Sequence[int]) -> str:
    """Return in words the manoeuvres that no fit has used."""
    plural = "s" if len(maneuvers) > 1 else ""
    return f"manoeuvre{plural} {', '.join(map(str, maneuvers))}, which no fit has used"


def taken_back_said(parts: Sequence[str], flown: str, worse: float, better: float) -> str:
    """Return the sentence about corrections that increase the gap of the manoeuvres ``flown``."""
    gap = f"the gap is {worse:.3g} instead of {better:.3g}"
    return f"Taken back: {' and '.join(parts)}, with which {gap} on {flown}."
