"""Which: every effect is screened, the few worth it are fitted fully, and the best judgement comes first."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from advisor.gap.candidates.variant import Variant
from advisor.gap.fitting.belief import log_belief
from advisor.gap.fitting.fit import Fitted, fit
from advisor.gap.fitting.holdout import HeldOut
from advisor.gap.fitting.problem import Point, Problem, counts
from advisor.gap.fitting.uncertainty import belief_in, covariance, worth
from advisor.gap.search.merit import LEAST_BELIEF, LEAST_GAIN, Judged, size_of
from advisor.gap.search.score import addition, is_plain, predict_alike, smallest_of
from advisor.gap.search.screen import Screen, Screened, likeliest_first
from advisor.gap.simulator.layout import DERIVATIVES

_PROMISE = 0.7
"""Share of the least that the screening must promise before a full fit is spent on a candidate."""
_ITERATIONS = 8
_TO_THE_END = 25
"""Of a full fit of a candidate, and of the one that comes out first."""
_FITS = 5
"""Candidates that get a full fit after the screening."""
_RIVAL = 0.3
"""Share of the best promise below which a candidate is no rival."""
_LACKING = 0.5
"""Share of what the best explains that a candidate may lack and still be followed to its end."""
_GROSS = 300.0
"""Log likelihood promised by the best from which on the right model is far from where the screening looks."""
_LEFT = 2.0
"""How many times an instrument's white noise the best must leave, if its other starts are to be tried ..."""
_SEVERAL = 2
"""... and how many of them, and of numbers, it must have to have more than one optimum."""
_WILD = 4.0
"""Power that a manoeuvre leaves, beside the median of all, from which on it may nearly have diverged."""
_HIDES = frozenset({"actuator_deadband"})
"""Effects that are tried then, too, while nothing was named: where most of the motion is missing, other
numbers imitate it so well that no screening leads to them."""
_MISSING = 0.03
"""Share of each channel's peak that the best leaves where so much is missing."""
_GROSS_FITS = 8
_GROSS_RIVAL = 0.05
"""Full fits then, and the share of the best promise that earns one."""
_TELLS = 3.0
"""Log probability beforehand by which one effect must be likelier than another to be believed for that."""


def candidates_for(problem: Problem, fitted: Fitted, variants: Sequence[Variant]) -> list[Screened]:
    """The screening, without the effects the model has already."""
    present = {e.effect for e in fitted.point.effects}
    independent = counts(problem)
    known = covariance(problem, fitted, independent)[: len(DERIVATIVES), : len(DERIVATIVES)]
    plain = belief_in(problem, fitted, independent)

    def believed(point: Point) -> float:
        if problem.believed is None:
            return 0.0
        return log_belief(point.derivatives, known, problem.believed) - plain

    others = [v for v in variants if v.effect not in present]
    found = Screen(problem, fitted).try_all(others, believed)
    hidden = _beside_the_file(problem, fitted, others, believed)
    return likeliest_first([*found, *hidden], float(np.sum(independent))) if hidden else found


def _beside_the_file(
    problem: Problem, plain: Fitted, variants: Sequence[Variant], believed: Callable[[Point], float]
) -> list[Screened]:
    """Effects that fitted numbers hide, from where the aircraft file's are right; none where those are near.

    A wing that is stalled throughout has another lift slope, and next to nothing else to show for it.
    """
    if problem.believed is None or not is_plain(plain):
        return []
    file = replace(plain.point, derivatives=problem.believed)
    if believed(file) < LEAST_BELIEF:
        return []
    points = [file.with_effect(v, v.beside_the_file) for v in variants if v.beside_the_file is not None]
    fits = [fit(problem, point, plain.noise, _TO_THE_END, 0.5) for point in points]
    return [Screened(f.point.effects[-1], f.point, f.cost, f.noise, believed(f.point)) for f in fits]


def judge(
    problem: Problem, before: Fitted, held_before: HeldOut, candidates: Sequence[Screened]
) -> list[Judged]:
    """Full fits of the best variants of the best effects; the best judgement first."""
    fits: list[Fitted] = []
    for s in shortlist(problem, before, candidates):
        plainly, *otherwise = (
            fit(problem, point, s.noise, _ITERATIONS, 0.5, beaten_by=_no_rival(before, fits))
            for point in _described(s.point)
        )
        fits += [plainly, *(other for other in otherwise if other.cost < plainly.cost)]
    if not fits:
        return []
    independent = worth(problem, min(fits, key=lambda f: f.cost).innovations)
    judged = [
        addition(problem, before, held_before, f, f.point.effects[-1].effect, independent) for f in fits
    ]
    best: dict[str, Judged] = {}
    for one in evened(problem, judged):
        best.setdefault(one.effect, one)
    first, *rest = best.values()
    explained = 0.5 * (before.cost - first.fitted.cost)
    if explained > _GROSS and np.any(first.held_out.mean_square > (_LEFT * problem.flights.white) ** 2):
        left = np.sqrt(first.held_out.mean_square)
        missing = is_plain(before) and np.all(left > _MISSING * problem.flights.peaks)
        hidden = _HIDES if missing else frozenset()
        alike = _each_once([c.variant for c in candidates if c.variant.effect in {first.effect, *hidden}])
        same = [variant for variant in alike if variant.effect == first.effect]
        again = [
            addition(problem, before, held_before, f, f.point.effects[-1].effect, independent)
            for f in (
                *_restarted(problem, before, first.fitted, alike),
                *_led_by_the_calm(problem, before, first.fitted, same),
            )
        ]
        found, first = first, max((first, *again), key=lambda judged: judged.gain)
        rest = [j for j in (found, *rest) if j.effect != first.effect]
    if first.fitted.iterations == _ITERATIONS:
        # Far from the plain model the search is long; only what comes out first is followed to its end.
        ended = fit(problem, first.fitted.point, first.fitted.noise, iterations=_TO_THE_END, tolerance=0.5)
        first = addition(problem, before, held_before, ended, first.effect, independent)
    return [first, *rest]


def _each_once(variants: Sequence[Variant]) -> list[Variant]:
    """Without what comes again: descriptions sought beside the aircraft file's numbers, too."""
    return [v for k, v in enumerate(variants) if all(v is not other for other in variants[:k])]


def _restarted(problem: Problem, before: Fitted, best: Fitted, variants: Sequence[Variant]) -> list[Fitted]:
    """Full fits from every start: of a kink, a screening with the plain model sees little.

    What is gross has bent the plain model's derivatives: searches begin with the aircraft file's, too.
    """
    fits: list[Fitted] = []
    several = [v for v in variants if min(len(v.starts), len(v.names)) >= _SEVERAL and v.sides is None]
    for variant in (described for v in several for described in (v, *v.likewise)):
        same = variant.effect == best.point.effects[-1].effect
        for start in variant.starts:
            point = before.point.with_effect(variant, start)
            lost = _no_rival(before, [best, *fits])
            fits.append(fit(problem, point, before.noise, _TO_THE_END, 0.5, beaten_by=lost))
            if same and problem.believed is not None and is_plain(before):
                # Far from the plain model: that the search begins with more left than there says nothing.
                there = replace(point, derivatives=problem.believed)
                fits.append(fit(problem, there, before.noise, _TO_THE_END, 0.5))
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
    calm = [fit(problem, point, before.noise, _TO_THE_END, 0.5, aside=wild) for point in points]
    led = min(calm, key=lambda f: f.cost)
    return [fit(problem, led.point, before.noise, _TO_THE_END, 0.5)]


def _no_rival(before: Fitted, fits: Sequence[Fitted]) -> float:
    """Cost of one that explains a fraction of what another does: no rival, wherever its search would end."""
    best = min((before.cost, *(f.cost for f in fits)))
    return best + _LACKING * (before.cost - best)


def _described(point: Point) -> list[Point]:
    """The point, and the same with its last effect described in other ways, where there are any."""
    last, values = point.effects[-1], point.values[-1]
    before = replace(point, effects=point.effects[:-1], values=point.values[:-1])
    return [
        point,
        *(
            before.with_effect(other, values if other.carried is None else other.carried(values))
            for other in last.likewise
        ),
    ]


def evened(problem: Problem, judged: Sequence[Judged]) -> list[Judged]:
    """The best judgement first; what predicts the same motion has its likelihood, if likelier beforehand.

    No description to low order is better than some share of the motion: where two differ by less, what the
    likelihood prefers is which of them takes up more of the description's own error. What is known
    beforehand decides: above all, which of them leaves the aircraft file's derivatives alone.
    """
    best = max(judged, key=lambda j: j.gain)

    def at_its_worth(j: Judged) -> Judged:
        likelier = j.beforehand > best.beforehand + _TELLS
        if not (likelier and j.worth_naming and predict_alike(problem, best.held_out, j.held_out)):
            return j
        return replace(j, gain=best.gain - best.beforehand + j.beforehand)

    return sorted((at_its_worth(j) for j in judged), key=lambda j: -j.gain)


def shortlist(problem: Problem, before: Fitted, candidates: Sequence[Screened]) -> list[Screened]:
    """Candidates worth a full fit; ``candidates`` come best first.

    One too small to be named is no rival of the others. Where the gap is gross the order and the sizes that
    the screening finds are worth less: more effects are fitted then, and two variants of each.
    """

    def promise(c: Screened) -> float:
        return 0.5 * (before.cost - c.cost)

    def best_of(some: Sequence[Screened]) -> float:
        return max((promise(c) + c.belief for c in some), default=0.0)

    gross = best_of(candidates) > _GROSS
    if not gross:
        candidates = [
            c for c in candidates
            if size_of(c.variant, c.point.values[-1]) >= smallest_of(problem, c.variant, promise(c))
        ]  # fmt: skip
    least = (_GROSS_RIVAL if gross else _RIVAL) * best_of(candidates)
    chosen: list[Screened] = []
    for c in candidates:
        worth_it = promise(c) >= _PROMISE * LEAST_GAIN or c.belief >= _PROMISE * LEAST_BELIEF
        same = sum(c.variant.effect == other.variant.effect for other in chosen)
        if worth_it and promise(c) + c.belief >= least and same < (2 if gross else 1):
            chosen.append(c)
    chosen = chosen[: _GROSS_FITS if gross else _FITS]
    # A twin of wrong numbers is as far from the plain model as they are: there the screening's sensitivities
    # are another model's, and say little of how well it fits.
    twins = [c for c in candidates if c.variant.twin is not None and c.belief >= LEAST_BELIEF]
    return [*chosen, *(c for c in twins if c not in chosen)]
