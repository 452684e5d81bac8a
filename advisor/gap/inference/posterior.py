"""From evidence to probabilities, with one row for each model of an alternative."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Generic

import numpy as np

from advisor.gap.alternative import Alternative, together
from advisor.gap.effects import EFFECTS
from advisor.gap.inference.explanation import E, Row
from advisor.gap.inference.prior import FieldPrior
from advisor.gap.inference.residual import MOST_NATS, Residual
from advisor.gap.inference.stage import Flight, Stage
from advisor.gap.inference.with_motion import WITNESSES

_ALWAYS = frozenset({"air"})
"""Blocks with a disturbance in most flights, whose residual indicates no missing law."""
_NO_RESIDUAL = Residual(0.0, {})


@dataclass(frozen=True)
class Posterior(Generic[E]):
    """Probabilities of all alternatives after one stage, which sum to 1."""

    rows: tuple[Row[E], ...]
    """Rows of all alternatives, the likeliest first."""
    shares: tuple[float, ...]
    """Probability of each row."""

    def of(self, alternative: Alternative) -> float:
        """Return the probability of an alternative, over all its rows."""
        return self.by_alternative.get(alternative, 0.0)

    @property
    def by_alternative(self) -> Mapping[Alternative, float]:
        """Probability of every alternative, the likeliest first."""
        each: dict[Alternative, float] = {}
        for row, share in zip(self.rows, self.shares, strict=True):
            each[row.alternative] = each.get(row.alternative, 0.0) + share
        return dict(sorted(each.items(), key=lambda item: -item[1]))

    @property
    def answer(self) -> Alternative:
        """Likeliest alternative, with all blocks of an effect without a name taken together."""
        return together(self.by_alternative.items())[0][0]

    def explanation_of(self, alternative: Alternative) -> E:
        """Return the likeliest model of an alternative."""
        mine = [row for row in self.rows if row.alternative == alternative]
        return max(mine, key=lambda row: row.weight).explanation


def stated_as(name: str) -> Alternative:
    """Return the alternative for an effect of the catalogue."""
    block = EFFECTS[name].block
    return Alternative("air" if block == "air" else "effect", name, block)


NONE, PARAMETERS = Alternative("none", "none"), Alternative("parameters", "parameters")
UNKNOWN = Alternative("unknown", "unknown")
"""Effect without a name, in any block."""


def rows_of(
    flight: Flight[E], stage: Stage[E], prior: FieldPrior, second: tuple[E, Stage[E]] | None = None
) -> list[Row[E]]:
    """Return the rows of all alternatives after one stage.

    Parameters
    ----------
    second
        First effect, and the stage that adds a second cause to it, which leaves another residual.
    """
    ways = [*_ways(flight, stage, prior)]
    if second is not None:
        ways += _pairs(flight, ways, stage.plain, *second, prior)
    moving = flight.in_moving_air(stage)
    if moving is not None:
        # Moving air is as likely before the flight as any one effect.
        odds = float(np.log(prior.effect / max(flight.tried[0], 1) / prior.none))
        ways += [
            replace(way, terms={**way.terms, "air": odds}, in_moving_air=True)
            for way in _ways(flight, moving, prior)
        ]
    ways.sort(key=lambda way: -way.weight)
    # An effect without a name must repeat, which fewer manoeuvres do not show.
    repeats = flight.maneuvers >= WITNESSES
    ways = [way for way in ways if repeats or way.alternative.kind != "unknown"]
    rows: list[Row[E]] = []
    searched: dict[int, Residual] = {}
    named: dict[tuple[Alternative, bool], Residual] = {}
    for way in ways:
        name, model = (way.alternative, way.in_moving_air), id(way.model)
        if name not in named:
            best = max((row.weight for row in rows), default=-np.inf)
            if model not in searched and way.weight + MOST_NATS > best:
                searched[model] = flight.residual(way.model, stage.heat) if repeats else _NO_RESIDUAL
            # An alternative that no residual makes the answer gets the residual of the likeliest model.
            named[name] = searched.get(model, next(iter(searched.values())))
        rows += _with_residual(way, named[name], prior)
    return rows


def _ways(flight: Flight[E], stage: Stage[E], prior: FieldPrior) -> Iterator[Row[E]]:
    """Yield the models of each alternative, without evidence from the residual."""
    names, laws = flight.tried
    plain, each = stage.plain, prior.effect / max(names, 1)
    natural = 0.5 / max(names, len(stage.effects), 1)
    without = 1.0 - natural * len(stage.effects)
    for answer, side, chance in _without_effect(flight, prior):
        yield _row(answer, plain, getattr(plain.evidence, side), without * chance)
        # As little of an effect as every aircraft has is no finding.
        for e in stage.effects:
            yield _row(answer, e, getattr(e.natural, side), natural * chance)
    for e in (*stage.effects, *stage.mirrored):
        assert e.alternative is not None
        forms = max(sum(other.name == e.name for other in stage.effects), 1)
        yield _row(e.alternative, e, e.evidence.either, each * e.chance / forms)
    for e in stage.laws:
        assert e.alternative is not None
        yield _row(e.alternative, e, e.evidence.either, 0.5 * prior.unknown / laws)


def _without_effect(flight: Flight[E], prior: FieldPrior) -> list[tuple[Alternative, str, float]]:
    """Return each answer without an effect, the evidence that it needs, and its prior probability."""
    if not flight.is_stated:
        return [(NONE, "right", prior.none + prior.parameters)]
    return [(NONE, "right", prior.none), (PARAMETERS, "wrong", prior.parameters)]


def _pairs(
    flight: Flight[E], ways: Sequence[Row[E]], plain: E, lead: E, second: Stage[E], prior: FieldPrior
) -> Iterator[Row[E]]:
    """Yield the models in which an effect acts together with a second effect."""
    # A law without a name may look like both causes, the likelier the more motion it explains.
    first = next(way for way in ways if way.explanation is lead and way.alternative.is_effect)
    of_first, tried = max(lead.evidence.either - plain.evidence.either, 0.0), flight.tried
    for e in (*second.effects, *second.laws):
        outside = any(e is law for law in second.laws)
        share = 0.5 * prior.unknown / tried[1] if outside else prior.effect / max(tried[0] - 1, 1)
        gained = e.evidence.either - second.plain.evidence.either
        more = gained + float(np.log(share / (prior.none + prior.parameters)))
        way = replace(first, terms={**first.terms, "second": more}, pair=e)
        left = max(gained, 0.0) / max(of_first + max(gained, 0.0), 1e-12) if outside else 0.0
        if left > 0.0 and e.alternative is not None:
            terms = {**way.terms, "second": more + float(np.log(left))}
            yield replace(way, alternative=e.alternative, terms=terms)
        # As little of the first effect as every aircraft has is no finding: the second effect is.
        small = {**first.terms, "natural": flight.natural_nats(lead, e)}
        natural = 0.5 / max(tried[0], 1)
        same = (w.explanation for w in ways if w.alternative == e.alternative)
        alone = e if outside else next(same, None)
        if e.alternative is not None and alone is not None:
            odds = float(np.log(natural * (prior.none + prior.parameters)))
            terms = {**small, "prior": odds, "second": more}
            yield replace(way, alternative=e.alternative, explanation=alone, terms=terms)
        # Natural amounts of both are no finding either.
        for answer, side, chance in () if outside else _without_effect(flight, prior):
            as_small = getattr(e.natural, side) - second.plain.evidence.either
            terms = small | {"prior": float(np.log(natural**2 * chance)), "second": as_small}
            yield replace(way, alternative=answer, terms=terms)
        if left < 1.0:
            yield replace(way, terms={**way.terms, "second": more + float(np.log1p(-left))})


def _row(alternative: Alternative, e: E, evidence: float, share: float) -> Row[E]:
    numbers = evidence - e.likelihood - e.unseen - e.model_error
    return Row(
        alternative, e,
        {"prior": float(np.log(share)), "fit": e.likelihood, "numbers": numbers, "unseen": e.unseen,
         "model_error": e.model_error},
    )  # fmt: skip


def _with_residual(way: Row[E], residual: Residual, prior: FieldPrior) -> Iterator[Row[E]]:
    """Yield the row for a right model, and the row for a model that only resembles an effect
    without a name.
    """
    as_right, as_lacking = residual.nats(way.in_moving_air)
    yield replace(way, terms={**way.terms, "residual": as_right})
    lacking = float(np.log(0.5 * prior.unknown / (prior.none + prior.parameters + prior.effect)))
    for block, share in residual.blocks.items():
        if block in _ALWAYS:
            yield replace(way, terms={**way.terms, "residual": as_lacking + float(np.log(0.5 * share))})
            continue
        terms = {"prior": way.terms["prior"] + lacking + float(np.log(share)), "residual": as_lacking}
        yield replace(way, alternative=replace(UNKNOWN, block=block), terms={**way.terms, **terms})


def posterior_of(rows: Iterable[Row[E]]) -> Posterior[E]:
    """Return the rows with their probabilities, the likeliest first."""
    ordered = sorted(rows, key=lambda row: -row.weight)
    weights = np.array([row.weight for row in ordered])
    shares = np.exp(weights - np.max(weights))
    return Posterior(tuple(ordered), tuple(map(float, shares / np.sum(shares))))


def relabelled(row: Row[E], alternative: Alternative) -> Row[E]:
    """Return the row as a model of another alternative."""
    return replace(row, alternative=alternative)
