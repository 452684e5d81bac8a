"""From the plain model of a flight to the posterior of its explanations, whatever the axis."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic

from advisor.gap.inference.explanation import E, Row
from advisor.gap.inference.posterior import Posterior, posterior_of, rows_of
from advisor.gap.inference.prior import FieldPrior
from advisor.gap.inference.stage import Flight, Stage, stage_of

Progress = Callable[[str, float], None]
"""Function that receives a sentence about the work and the share done, 0 to 1."""
_EFFECTS, _SECOND = 6, 3
"""Numerical: number of effects that are fitted in full, as a first and as a second cause."""
_LEADS = 4
"""Numerical: number of effects that are paired with all others."""


@dataclass(frozen=True)
class Decided(Generic[E]):
    """The posterior of all explanations."""

    posteriors: tuple[Posterior[E], ...]
    """Posterior of the first effect, and of a second one in addition to it."""
    chosen: tuple[E, ...]
    """The plain model, then the model of each added effect."""
    heat: float
    """Nats of white noise that count as one."""


def first_stage(flight: Flight[E]) -> Stage[E]:
    """Return the plain model of a flight, and all that may be added to it."""
    return stage_of(flight, None, _EFFECTS)


def decided(
    flight: Flight[E], stage: Stage[E], prior: FieldPrior, beyond: Callable[[list[Row[E]]], list[Row[E]]]
) -> Decided[E]:
    """Return the posterior after the first stage, and the second cause where the answer is an effect.

    Parameters
    ----------
    beyond
        Function that returns the rows of the first stage with what the axis knows beyond the models.
    """
    lead = _lead(flight, stage)
    pair = None if lead is None else (lead, stage_of(flight, lead, _SECOND))
    posteriors = [posterior_of(beyond(rows_of(flight, stage, prior, pair)))]
    answer, chosen = posteriors[0].answer, [stage.plain]
    if any(one.alternative == answer for one in stage.effects):
        first = posteriors[0].explanation_of(answer)
        chosen.append(first)
        second = pair[1] if pair is not None and first is lead else stage_of(flight, first, _SECOND)
        posteriors.append(posterior_of(rows_of(flight, second, prior)))
        also = posteriors[-1].answer
        if any(one.alternative == also for one in second.effects):
            chosen.append(posteriors[-1].explanation_of(also))
    return Decided(tuple(posteriors), tuple(chosen), stage.heat)


def _lead(flight: Flight[E], stage: Stage[E]) -> E | None:
    """Return the likely effect that explains most together with a second one, by a quick look at every pair.

    Two effects may hide each other: neither alone explains anything.
    """
    likely: dict[str, E] = {}
    for one in sorted(stage.effects, key=lambda one: -one.evidence.either):
        likely.setdefault(one.name, one)
    leads = list(likely.values())[:_LEADS]
    _, *best = min(flight.pairs(stage, leads), default=(0.0, "", ""))
    return next((lead for lead in leads if lead.name in best), None)
