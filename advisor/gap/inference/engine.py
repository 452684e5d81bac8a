"""Posterior of a flight's explanations, computed from the plain model, for any axis."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic

from advisor.gap.inference.explanation import E, Row
from advisor.gap.inference.posterior import Posterior, posterior_of, rows_of
from advisor.gap.inference.prior import FieldPrior
from advisor.gap.inference.stage import Flight, Stage, stage_of
from advisor.process.parts import FailedPart

Progress = Callable[[str, float], None]
"""Function that receives a sentence about the work, and the completed share, 0 to 1."""
_EFFECTS, _SECOND = 6, 3
"""Numerical: number of effects that are fully fitted as first cause, and as second cause."""
_LEADS = 4
"""Numerical: number of effects that are paired with all other effects."""


@dataclass(frozen=True)
class Decided(Generic[E]):
    """Posterior of all explanations of a flight."""

    posteriors: tuple[Posterior[E], ...]
    """Posterior of the first effect, then that of a second effect in addition."""
    chosen: tuple[E, ...]
    """The plain model, then the model of each added effect."""
    failed: tuple[FailedPart, ...]
    """Explanations that a numerical fault of the advisor ended."""
    heat: float
    """Number of nats of white-noise likelihood that count as one nat."""


def first_stage(flight: Flight[E]) -> Stage[E]:
    """Return the plain model of a flight, and all effects and laws that may be added."""
    return stage_of(flight, None, _EFFECTS)


def decided(
    flight: Flight[E], stage: Stage[E], prior: FieldPrior, beyond: Callable[[list[Row[E]]], list[Row[E]]]
) -> Decided[E]:
    """Return the posterior after the first stage, with a second cause if the answer is an effect.

    Parameters
    ----------
    beyond
        Function that adds explanations outside the models to the rows of the first stage.
    """
    lead = _lead(flight, stage)
    pair = None if lead is None else (lead, stage_of(flight, lead, _SECOND))
    posteriors = [posterior_of(beyond(rows_of(flight, stage, prior, pair)))]
    answer, chosen = posteriors[0].answer, [stage.plain]
    first = posteriors[0].explanation_of(answer)
    if first.name and any(e.alternative == answer for e in stage.effects):
        chosen.append(first)
        second = pair[1] if pair is not None and first is lead else stage_of(flight, first, _SECOND)
        posteriors.append(posterior_of(rows_of(flight, second, prior)))
        also = posteriors[-1].answer
        if any(e.alternative == also for e in second.effects):
            chosen.append(posteriors[-1].explanation_of(also))
    return Decided(tuple(posteriors), tuple(chosen), flight.parts.failed, stage.heat)


def _lead(flight: Flight[E], stage: Stage[E]) -> E | None:
    """Return the likely effect that explains most together with a second effect, from quick fits of every
    pair.
    """
    likely: dict[str, E] = {}
    for e in sorted(stage.effects, key=lambda e: -e.evidence.either):
        likely.setdefault(e.name, e)
    _, *best = min(flight.pairs(stage, list(likely.values())[:_LEADS]), default=(0.0, "", ""))
    return next((lead for name, lead in likely.items() if name in best), None)
