"""From evidence to probabilities: one row for each way in which an alternative may be true."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.gap.alternative import Alternative, Probabilities
from advisor.gap.effects import EFFECTS
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.inference.explanation import Explanation, Row
from advisor.gap.inference.stage import Stage, misfit_of
from advisor.gap.judge.prior import FieldPrior

_RIGHT_MISFIT, _UNKNOWN_MISFIT = (np.log(0.006), 0.9), (np.log(0.04), 0.9)
"""Prior: mean and standard deviation of the log of the residual that a right model leaves, and a model that
lacks a law, as shares of the motion."""
_LEAST_MISFIT = 0.002
"""Numerical: share of the motion below which a residual is not told from none."""


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
    def probabilities(self) -> Probabilities:
        """Probabilities by kind and name."""
        each = self.by_alternative
        return Probabilities(
            none=sum(p for a, p in each.items() if a.kind == "none"),
            parameters=sum(p for a, p in each.items() if a.kind == "parameters"),
            unknown={a.block: p for a, p in each.items() if a.kind == "unknown"},
            effects={a.name: p for a, p in each.items() if a.is_effect},
        )

    @property
    def answer(self) -> Alternative:
        """The likeliest of nothing, wrong numbers, each effect, and all blocks of the unknown together."""
        together: dict[str, float] = {}
        for a, p in self.by_alternative.items():
            together[a.name] = together.get(a.name, 0.0) + p
        name = max(together, key=lambda n: together[n])
        return next(a for a in self.by_alternative if a.name == name)

    def explanation_of(self, alternative: Alternative) -> Explanation:
        """Return the likeliest explanation of an alternative."""
        mine = [row for row in self.rows if row.alternative == alternative]
        return max(mine, key=lambda row: row.weight).explanation


def stated_as(name: str) -> Alternative:
    """Return an effect of the catalogue as an alternative."""
    block = EFFECTS[name].block
    return Alternative("air" if block == "air" else "effect", name, block)


NONE, PARAMETERS = Alternative("none", "none"), Alternative("parameters", "parameters")


def rows_of(
    problem: EffectProblem,
    stage: Stage,
    names: Sequence[str],
    laws: Sequence[str],
    blocks: Mapping[str, float],
    prior: FieldPrior,
) -> list[Row]:
    """Return the rows of one stage.

    Parameters
    ----------
    names, laws
        Effects of the catalogue, and laws outside of it, that were tried.
    blocks
        Share of each block in an unknown law, summing to 1.
    prior
        How often each kind of answer is right before a flight is looked at.
    """
    each = prior.effect / max(len(names), 1)
    stated = stage.plain.problem.is_stated
    none = prior.none + (0.0 if stated else prior.parameters)
    rows = _told(problem, NONE, stage.plain, stage.plain.evidence.right, none)
    rows += _lacking(problem, stage.plain, stage.plain.evidence.right, 0.5 * prior.unknown, blocks)
    if stated:
        wrong = stage.plain.evidence.wrong
        rows += _told(problem, PARAMETERS, stage.plain, wrong, prior.parameters)
        rows += _lacking(problem, stage.plain, wrong, 0.5 * prior.unknown, blocks)
    forms = {name: sum(one.name == name for one in stage.effects) for name in names}
    for one in stage.effects:
        rows += _told(problem, stated_as(one.name), one, one.evidence.either, each / forms[one.name])
        share = 0.5 * prior.unknown / max(len(names), 1)
        rows += _lacking(problem, one, one.evidence.either, share, blocks)
    for one in stage.laws:
        assert one.variant is not None
        alternative = Alternative("unknown", "unknown", one.variant.block)
        rows += _told(problem, alternative, one, one.evidence.either, 0.5 * prior.unknown / len(laws))
    return rows


def posterior_of(rows: Iterable[Row]) -> Posterior:
    """Return the rows with their probabilities, the likeliest first."""
    ordered = sorted(rows, key=lambda row: -row.weight)
    weights = np.array([row.weight for row in ordered])
    shares = np.exp(weights - np.max(weights))
    return Posterior(tuple(ordered), tuple(map(float, shares / np.sum(shares))))


def _told(
    problem: EffectProblem, alternative: Alternative, one: Explanation, evidence: float, share: float
) -> list[Row]:
    """Return the row of an explanation that is right, so that it leaves little."""
    return [_row(problem, alternative, one, evidence, share, _RIGHT_MISFIT)]


def _lacking(
    problem: EffectProblem, one: Explanation, evidence: float, share: float, blocks: Mapping[str, float]
) -> list[Row]:
    """Return the rows of a law outside the table, which an explanation only resembles."""
    return [
        _row(problem, Alternative("unknown", "unknown", block), one, evidence, share * part, _UNKNOWN_MISFIT)
        for block, part in blocks.items()
        if part > 1e-12
    ]


def _row(
    problem: EffectProblem,
    alternative: Alternative,
    one: Explanation,
    evidence: float,
    share: float,
    misfit: tuple[float, float],
) -> Row:
    left = _log_normal(misfit_of(problem, one.fitted), misfit)
    numbers = evidence - one.likelihood - one.unseen - one.model_error
    return Row(
        alternative, one,
        {"prior": float(np.log(share)), "fit": one.likelihood, "numbers": numbers, "unseen": one.unseen,
         "model_error": one.model_error, "residual": left},
    )  # fmt: skip


def _log_normal(x: float, told: tuple[float, float]) -> float:
    mean, std = told
    return float(-0.5 * ((np.log(max(x, _LEAST_MISFIT)) - mean) / std) ** 2 - np.log(std))


def relabelled(row: Row, alternative: Alternative) -> Row:
    """Return the row as a way in which another alternative is true."""
    return replace(row, alternative=alternative)
