"""From evidence to probabilities: one row for each way in which an alternative may be true."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.gap.alternative import Alternative, together
from advisor.gap.effects import EFFECTS
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.inference.explanation import Explanation, Row
from advisor.gap.inference.prior import FieldPrior
from advisor.gap.inference.residual import Residual, if_lacking, if_right, residual_of
from advisor.gap.inference.stage import Stage

_ALWAYS = frozenset({"air"})
"""Blocks with a disturbance in most flights: such a residual is no law that the simulator lacks."""
_SEARCHED = 2
"""Numerical: number of models, the likeliest, whose residual is searched. Others count with the
residual of the likeliest."""


@dataclass(frozen=True)
class Posterior:
    """Probabilities of all alternatives of a stage, which sum to 1."""

    rows: tuple[Row, ...]
    """Rows of all alternatives, the likeliest first."""
    shares: tuple[float, ...]
    """Probability of each row."""

    def of(self, alternative: Alternative) -> float:
        """Return the probability of an alternative."""
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
        """The likeliest of nothing, wrong numbers, each effect, and all blocks of the unknown together."""
        return together(self.by_alternative.items())[0][0]

    def explanation_of(self, alternative: Alternative) -> Explanation:
        """Return the likeliest explanation of an alternative."""
        mine = [row for row in self.rows if row.alternative == alternative]
        return max(mine, key=lambda row: row.weight).explanation


def stated_as(name: str) -> Alternative:
    """Return an effect of the catalogue as an alternative."""
    block = EFFECTS[name].block
    return Alternative("air" if block == "air" else "effect", name, block)


def _unknown_in(law: Explanation) -> Alternative:
    assert law.variant is not None
    return Alternative("unknown", "unknown", law.variant.block)


NONE, PARAMETERS = Alternative("none", "none"), Alternative("parameters", "parameters")


def rows_of(
    problem: EffectProblem,
    stage: Stage,
    names: Sequence[str],
    laws: Sequence[str],
    prior: FieldPrior,
    lead: Explanation | None = None,
    second: Stage | None = None,
) -> list[Row]:
    """Return the rows of one stage.

    Parameters
    ----------
    names, laws
        Effects of the catalogue, and laws outside of it, that were tried.
    prior
        How often each kind of answer is right before a flight is looked at.
    lead, second
        An effect and the stage after it: with a second cause, the first one leaves another residual.
    """
    ways = [*_ways(stage, names, laws, prior)]
    if lead is not None and second is not None:
        ways += _pairs(ways, stage.plain, lead, second, len(names), len(laws), prior)
    ways.sort(key=lambda way: -way.weight)
    models = {id(way.model): way.model for way in ways}
    near = list(models.items())[:_SEARCHED]
    residuals = {key: residual_of(problem, one.fitted, stage.heat) for key, one in near}
    of_others = residuals[near[0][0]]
    return [
        row for way in ways for row in _with_residual(way, residuals.get(id(way.model), of_others), prior)
    ]


def _ways(stage: Stage, names: Sequence[str], laws: Sequence[str], prior: FieldPrior) -> Iterator[Row]:
    """Yield the ways in which each alternative may be true, without a look at the residual."""
    plain, each = stage.plain, prior.effect / max(len(names), 1)
    stated = plain.problem.is_stated
    none = prior.none + (0.0 if stated else prior.parameters)
    natural = 0.5 / max(len(names), len(stage.effects), 1)
    without = 1.0 - natural * len(stage.effects)
    yield _row(NONE, plain, plain.evidence.right, without * none)
    if stated:
        yield _row(PARAMETERS, plain, plain.evidence.wrong, without * prior.parameters)
    for one in stage.effects:
        # As little of an effect as every aircraft has is no finding.
        yield _row(NONE, one, one.natural.right, natural * none)
        if stated:
            yield _row(PARAMETERS, one, one.natural.wrong, natural * prior.parameters)
        forms = sum(other.name == one.name for other in stage.effects)
        yield _row(stated_as(one.name), one, one.evidence.either, each / forms)
    for one in stage.laws:
        yield _row(_unknown_in(one), one, one.evidence.either, 0.5 * prior.unknown / len(laws))


def _pairs(
    ways: Sequence[Row],
    plain: Explanation,
    lead: Explanation,
    second: Stage,
    names: int,
    laws: int,
    prior: FieldPrior,
) -> Iterator[Row]:
    """Yield the ways in which an effect is true together with a second one.

    Where a law outside the table is the second, both may be one law that the effect resembles. The more the
    effect leaves to the law, the likelier that is.
    """
    first = next(way for way in ways if way.explanation is lead and way.alternative.is_effect)
    of_first = max(lead.evidence.either - plain.evidence.either, 0.0)
    for one in (*second.effects, *second.laws):
        outside = any(one is law for law in second.laws)
        share = 0.5 * prior.unknown / laws if outside else prior.effect / max(names - 1, 1)
        gained = one.evidence.either - second.plain.evidence.either
        more = gained + float(np.log(share / (prior.none + prior.parameters)))
        way = replace(first, terms={**first.terms, "second": more}, pair=one)
        left = max(gained, 0.0) / max(of_first + max(gained, 0.0), 1e-12) if outside else 0.0
        if left > 0.0:
            yield replace(
                way, alternative=_unknown_in(one), terms={**way.terms, "second": more + float(np.log(left))}
            )
        if left < 1.0:
            yield replace(way, terms={**way.terms, "second": more + float(np.log1p(-left))})


def _row(alternative: Alternative, one: Explanation, evidence: float, share: float) -> Row:
    numbers = evidence - one.likelihood - one.unseen - one.model_error
    return Row(
        alternative, one,
        {"prior": float(np.log(share)), "fit": one.likelihood, "numbers": numbers, "unseen": one.unseen,
         "model_error": one.model_error},
    )  # fmt: skip


def _with_residual(way: Row, residual: Residual, prior: FieldPrior) -> Iterator[Row]:
    """Yield the way as right, and as one that only resembles a law outside the table.

    Such a law leaves a residual that a disturbance of free course explains, in one block.
    """
    yield replace(way, terms={**way.terms, "residual": if_right(residual.size)})
    lacking = float(np.log(0.5 * prior.unknown / (prior.none + prior.parameters + prior.effect)))
    as_lacking = if_lacking(residual.size)
    for block, share in residual.blocks.items():
        if block in _ALWAYS:
            yield replace(way, terms={**way.terms, "residual": as_lacking + float(np.log(0.5 * share))})
            continue
        told = {"prior": way.terms["prior"] + lacking + float(np.log(share)), "residual": as_lacking}
        yield replace(way, alternative=Alternative("unknown", "unknown", block), terms={**way.terms, **told})


def posterior_of(rows: Iterable[Row]) -> Posterior:
    """Return the rows with their probabilities, the likeliest first."""
    ordered = sorted(rows, key=lambda row: -row.weight)
    weights = np.array([row.weight for row in ordered])
    shares = np.exp(weights - np.max(weights))
    return Posterior(tuple(ordered), tuple(map(float, shares / np.sum(shares))))


def relabelled(row: Row, alternative: Alternative) -> Row:
    """Return the row as a way in which another alternative is true."""
    return replace(row, alternative=alternative)
