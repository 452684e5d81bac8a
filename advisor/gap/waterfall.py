"""One effect after another, until nothing more helps on manoeuvres kept out of the fit."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from advisor.gap.fit import Fitted, fit
from advisor.gap.holdout import HeldOut, hold_out
from advisor.gap.problem import Problem
from advisor.gap.score import Judged, candidates_for, judge
from advisor.gap.variant import Variant

MOST_EFFECTS = 3

Progress = Callable[[str, float], None]
"""Called with what is being done and the share done, 0 to 1."""


@dataclass(frozen=True)
class Stage:
    """The model at one stage, and what was thought of adding to it."""

    fitted: Fitted
    held_out: HeldOut
    considered: tuple[Judged, ...]
    """Candidates for the next addition, best first."""
    added: Judged | None
    """What was added to this stage's model to reach the next one."""


def build_up(
    problem: Problem, baseline: Fitted, variants: Sequence[Variant], progress: Progress = lambda *_: None
) -> list[Stage]:
    """Stages from the plain model to the last addition; the last stage adds nothing."""
    stages: list[Stage] = []
    fitted, held = baseline, hold_out(problem, baseline)
    for n in range(MOST_EFFECTS + 1):
        progress(f"trying {len(variants)} ways to explain what is left", 0.2 + 0.15 * n)
        considered = judge(problem, fitted, held, candidates_for(problem, fitted, variants))
        added = next((j for j in considered if j.worth_naming), None) if n < MOST_EFFECTS else None
        stages.append(Stage(fitted, held, tuple(considered), added))
        if added is None:
            break
        fitted, held = added.fitted, added.held_out
    return stages


def reconsider(problem: Problem, stages: list[Stage], variants: Sequence[Variant]) -> list[Stage]:
    """With two effects in the model, is the first still the best companion of the second?

    A single effect fitted to the sum of two may be neither; once one of them is right the other shows.
    """
    if len(stages) != 3:
        return stages
    first, second = stages[0].added, stages[1].added
    if first is None or second is None:
        return stages
    start = stages[0].fitted.point.with_effect(second.variant, second.value, second.fitted.point.sides)
    alone = fit(problem, start, second.fitted.noise, iterations=8)
    held = hold_out(problem, alone)
    companions = judge(problem, alone, held, candidates_for(problem, alone, variants))
    best = next((j for j in companions if j.worth_naming), None)
    if best is None or best.effect == first.effect or best.fitted.cost > second.fitted.cost - 20.0:
        return stages
    only_second = next((j for j in stages[0].considered if j.effect == second.effect), None)
    if only_second is None:
        only_second = Judged(
            second.variant, alone, held, second.gain, second.removed, alone.point.values[-1], second.std
        )
    after = judge(problem, best.fitted, best.held_out, candidates_for(problem, best.fitted, variants))
    return [
        Stage(stages[0].fitted, stages[0].held_out, stages[0].considered, only_second),
        Stage(alone, held, tuple(companions), best),
        Stage(best.fitted, best.held_out, tuple(after), None),
    ]
