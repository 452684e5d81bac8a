"""What came first, sought from other starts: of a kink, a screening with the plain model sees little."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.gap.candidates.traits import HIDES
from advisor.gap.candidates.variant import Variant
from advisor.gap.fitting.fit import Fitted, fit
from advisor.gap.fitting.holdout import HeldOut
from advisor.gap.fitting.problem import Problem
from advisor.gap.fitting.uncertainty import worth
from advisor.gap.search.merit import Judged
from advisor.gap.search.ranking import GROSS, TO_THE_END, no_rival
from advisor.gap.search.score import addition, is_plain
from advisor.gap.search.screen import Screened

_LEFT = 2.0
"""How many times the noise of some channel the best must leave, if its other starts are to be tried: what an
instrument's white noise is, or else an innovation's standard deviation ..."""
_SEVERAL = 2
"""... and how many of them, and of numbers, it must have to have more than one optimum."""
_WILD = 4.0
"""Power that a manoeuvre leaves, beside the median of all, from which on it may nearly have diverged."""
_MISSING = 0.03
"""Share of each channel's peak that the best leaves where so much is missing."""


def from_every_start(
    problem: Problem,
    before: Fitted,
    held_before: HeldOut,
    judged: list[Judged],
    candidates: Sequence[Screened],
) -> list[Judged]:
    """The judgements of ``ranking.judge``, the first sought again where it leaves much of a gross gap.

    Parameters
    ----------
    before, held_before
        The model to which an effect is added.
    judged, candidates
        The judgements, the best first, and the screening that they come from.
    """
    if not judged:
        return judged
    first = judged[0]
    explained = 0.5 * (before.cost - first.fitted.cost)
    left = np.sqrt(first.held_out.mean_square)
    loud = (
        np.sqrt(first.held_out.innovation_square) if problem.knows_the_noise else left / problem.flights.white
    )
    if explained <= GROSS or np.all(loud <= _LEFT):
        return judged
    missing = is_plain(before) and np.all(left > _MISSING * problem.flights.peaks)
    asked = [
        variant
        for variant in (c.variant for c in candidates)
        if variant.effect == first.effect or (missing and variant.effect in HIDES)
    ]
    alike = _each_once(asked)
    same = [variant for variant in alike if variant.effect == first.effect]
    fits = [
        *_restarted(problem, before, first.fitted, alike),
        *_led_by_the_calm(problem, before, first.fitted, same),
    ]
    if not fits:
        return judged
    independent = worth(problem, first.fitted.innovations)
    again = [
        addition(problem, before, held_before, f, f.point.effects[-1].effect, independent)
        for f in (first.fitted, *fits)
    ]
    best = max(again, key=lambda one: one.gain)
    if best.fitted is first.fitted:
        return judged
    return [best, *(j for j in judged if j.effect != best.effect)]


def _each_once(variants: Sequence[Variant]) -> list[Variant]:
    """Without what comes again: descriptions sought beside the aircraft file's numbers, too."""
    return [v for k, v in enumerate(variants) if all(v is not other for other in variants[:k])]


def _restarted(problem: Problem, before: Fitted, best: Fitted, variants: Sequence[Variant]) -> list[Fitted]:
    """Full fits from every start.

    What is gross has bent the plain model's derivatives: searches begin with the aircraft file's, too.
    """
    fits: list[Fitted] = []
    several = [v for v in variants if min(len(v.starts), len(v.names)) >= _SEVERAL and v.sides is None]
    for variant in (described for v in several for described in (v, *v.likewise)):
        same = variant.effect == best.point.effects[-1].effect
        for start in variant.starts:
            point = before.point.with_effect(variant, start)
            lost = no_rival(before, [best, *fits])
            fits.append(fit(problem, point, before.noise, TO_THE_END, 0.5, beaten_by=lost))
            if same and problem.believed is not None and is_plain(before):
                # Far from the plain model: that the search begins with more left than there says nothing.
                there = replace(point, derivatives=problem.believed)
                fits.append(fit(problem, there, before.noise, TO_THE_END, 0.5))
    return fits


def _led_by_the_calm(
    problem: Problem, before: Fitted, best: Fitted, variants: Sequence[Variant]
) -> list[Fitted]:
    """A full fit that begins without the manoeuvres of which the best leaves by far most.

    Where a response nearly diverges, it does so at the next step of any search, which gets no further: the
    other manoeuvres lead to where it does not.
    """
    power = np.array([float(np.mean(e**2)) for e in best.innovations])
    wild = np.flatnonzero(power > _WILD * np.median(power)).tolist()
    points = [before.point.with_effect(v, start) for v in variants if v.sides is None for start in v.starts]
    if not wild or not points:
        return []
    calm = [fit(problem, point, before.noise, TO_THE_END, 0.5, aside=wild) for point in points]
    led = min(calm, key=lambda f: f.cost)
    return [fit(problem, led.point, before.noise, TO_THE_END, 0.5)]
