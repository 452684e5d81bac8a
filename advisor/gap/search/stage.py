"""One stage of the waterfall: a model, the candidates for an addition, and the addition."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from advisor.gap.decision import BEYOND_DOUBT
from advisor.gap.fitting.fit import EffectFit, fit
from advisor.gap.fitting.holdout import HeldOut
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.fitting.uncertainty import effective_samples
from advisor.gap.search.acceptance import JudgedAddition
from advisor.gap.search.score import addition
from advisor.gap.search.screen import Screened


@dataclass(frozen=True)
class Stage:
    """The model at one stage, with the candidates for its next addition."""

    fitted: EffectFit
    held_out: HeldOut
    considered: tuple[JudgedAddition, ...]
    """Candidates for the next addition, best first. A reordered stage has those of its own addition. The last
    of ``MOST_EFFECTS`` stages has none."""
    added: JudgedAddition | None
    """Effect whose addition leads to the next stage; None at the last stage."""
    screened: tuple[Screened, ...] = ()
    """Quick fits of all effects in the first stage, one for each effect; empty in the others."""

    @property
    def disputed(self) -> JudgedAddition | None:
        """The likeliest candidate, where nothing was added and held-out manoeuvres alone reject it."""
        first = next(iter(self.considered), None)
        return first if first is not None and self.added is None and first.is_disputed else None

    def slight_in(self, block: str) -> JudgedAddition | None:
        """Return the effect of a block that is beyond doubt and only too small to be named."""
        found = (j for j in self.considered if j.block == block and j.gain >= BEYOND_DOUBT)
        return next((j for j in found if not j.large_enough and not j.at_its_bounds), None)


FoundSets = Mapping[tuple[str, str], tuple[JudgedAddition, JudgedAddition]]
"""Sets of two effects that the search fitted together, the main effect first: their additions in order."""


def added_in(stages: Sequence[Stage]) -> list[JudgedAddition]:
    """Return the added effects, stage by stage."""
    return [stage.added for stage in stages if stage.added is not None]


def sets_in(search: Sequence[Stage], settled: Sequence[Stage]) -> FoundSets:
    """Return the first two effects of the settled model, and those that the search added first.

    The main effect is the one that the settled model has first.
    """
    order = [
        *(judged.effect for judged in added_in(settled)),
        *(judged.effect for judged in added_in(search)),
    ]
    found: dict[tuple[str, str], tuple[JudgedAddition, JudgedAddition]] = {}
    for pair in (added_in(stages)[:2] for stages in (search, settled)):
        if len(pair) == 2:
            main, second = sorted((judged.effect for judged in pair), key=order.index)
            found[main, second] = pair[0], pair[1]
    return found


def rebuilt(
    problem: EffectProblem,
    first: Stage,
    names: Sequence[str],
    full: EffectFit,
    considered: Mapping[str, tuple[JudgedAddition, ...]],
    last: tuple[JudgedAddition, ...],
) -> list[Stage]:
    """Return the stages with the effects in another order."""
    effective = effective_samples(problem, full.innovations)
    before, held = first.fitted, first.held_out
    stages = []
    for n, name in enumerate(names, 1):
        fitted = full if n == len(names) else fit_with_effects(problem, full, names[:n])
        added = addition(problem, before, held, fitted, name, effective)
        stages.append(Stage(before, held, considered[name], added, first.screened if n == 1 else ()))
        before, held = fitted, added.held_out
    return [*stages, Stage(before, held, last, None)]


def fit_with_effects(problem: EffectProblem, full: EffectFit, names: Sequence[str]) -> EffectFit:
    """Return the fitted model with some of the effects."""
    return fit(problem, full.point.with_only(names), full.noise, iterations=8, tolerance=0.5)
