"""Names found one after the other, where others would have been better from the first.

A single effect fitted to the sum of two may be neither.
"""

from collections.abc import Sequence
from dataclasses import replace

from advisor.gap.candidates.variant import Variant
from advisor.gap.fitting.fit import Fitted, fit
from advisor.gap.fitting.holdout import hold_out
from advisor.gap.fitting.problem import Problem
from advisor.gap.fitting.uncertainty import worth
from advisor.gap.search.merit import LEAST_GAIN
from advisor.gap.search.ranking import candidates_for, judge
from advisor.gap.search.score import addition
from advisor.gap.search.stage import Stage, only, rebuilt

_CLEARLY = 20.0
"""Cost by which a pair of names must beat those that were found first."""
_PROMISING = 0.5
"""Share of what the first effect brings that the screening must promise of another companion."""
_SEVERAL = 2
"""Streams that are late, from which on the command may be, and another stream early."""


def other_companion(problem: Problem, stages: list[Stage], variants: Sequence[Variant]) -> list[Stage]:
    """With two effects in the model, is the first still the best companion of the second?

    A single effect fitted to the sum of two may be neither; once one of them is right the other shows.
    """
    if len(stages) != 3:
        return stages
    first, second = stages[0].added, stages[1].added
    if first is None or second is None:
        return stages
    alone = only(problem, second.fitted, [second.effect])
    held = hold_out(problem, alone)
    independent = worth(problem, second.fitted.innovations)
    same = addition(problem, alone, held, second.fitted, first.effect, independent)
    others = candidates_for(problem, alone, [v for v in variants if v.effect != first.effect])
    near = [c for c in others if 0.5 * (alone.cost - c.cost) + c.belief > _PROMISING * same.gain]
    companions = judge(problem, alone, held, near)
    best = next((j for j in companions if j.worth_naming), None)
    if best is None:
        return stages
    # What one sample is worth depends on the fit that says so: both are held against the same.
    likewise = addition(problem, alone, held, best.fitted, best.effect, independent)
    if likewise.gain < same.gain + LEAST_GAIN:
        return stages
    independent = worth(problem, best.fitted.innovations)
    only_second = addition(problem, stages[0].fitted, stages[0].held_out, alone, second.effect, independent)
    after = judge(problem, best.fitted, best.held_out, candidates_for(problem, best.fitted, variants))
    return [
        # Its rivals were those beside the first, which the companion has replaced.
        Stage(stages[0].fitted, stages[0].held_out, stages[1].considered, only_second),
        Stage(alone, held, (*companions, same), best),
        Stage(best.fitted, best.held_out, tuple(after), None),
    ]


def one_early(problem: Problem, stages: list[Stage], variants: Sequence[Variant]) -> list[Stage]:
    """A late command and one stream that is early, where several streams seemed late.

    To the data they are the same but for the command's edges; two causes are likelier than three.
    """
    named = [s.added for s in stages if s.added is not None]
    late = {j.effect: float(j.value[0]) for j in named if j.variant.names[0] == "skew_s" and j.value[0] > 0.0}
    delay = next((v for v in variants if v.effect == "transport_delay"), None)
    if len(late) < _SEVERAL or delay is None:
        return stages
    first, last, by_s = stages[0], stages[-1].fitted, max(late.values())
    early = [v for v in variants if v.names[0] == "skew_s" and v.effect not in late and not v.fixed]
    pairs: list[Fitted] = []
    for skew in early:
        point = first.fitted.point.with_effect(delay, (by_s,)).with_effect(skew, (-by_s,))
        pairs.append(fit(problem, point, last.noise, tolerance=0.5, beaten_by=last.cost))
    best = min(pairs, key=lambda f: f.cost, default=last)
    if best.cost > last.cost - _CLEARLY:
        return stages
    names = [effect.effect for effect in best.point.effects[-2:]]
    # What was thought of beside the names that these replace is refuted with them.
    again = rebuilt(problem, first, names, best, dict.fromkeys(names, ()), ())
    return [replace(s, considered=(s.added,) if s.added is not None else ()) for s in again]
