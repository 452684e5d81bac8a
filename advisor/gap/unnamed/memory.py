"""Lift that was named as bent, and comes back another way than it went: a stall with a memory."""

from dataclasses import replace

from advisor.gap.candidates.force import CURVED_LIFT
from advisor.gap.candidates.variant import Variant
from advisor.gap.fitting.fit import fit
from advisor.gap.fitting.problem import Problem
from advisor.gap.fitting.uncertainty import worth
from advisor.gap.search.merit import Judged
from advisor.gap.search.score import addition
from advisor.gap.search.stage import Stage, added_in
from advisor.gap.unnamed.laws import said
from advisor.gap.unnamed.leftover import Leftover
from advisor.gap.unnamed.stalls import lift_memory

_CERTAIN = 15.0
"""Log likelihood that a memory must bring, and bring beyond another bend: a deep stall leaves more than a few
figures describe, and the first law of it that comes by takes that up."""
_BENT_MORE = replace(CURVED_LIFT, effect="lift_bent_more")


def remembering(problem: Problem, stages: list[Stage]) -> Leftover | None:
    """The lift's memory beside all that was named; None where its bend needs none, or it does not bend."""
    if not any(j.effect == "nonlinear_lift" for j in added_in(stages)):
        return None
    last = stages[-1]

    def beside(law: Variant) -> Judged:
        points = (last.fitted.point.with_effect(law, start) for start in law.starts)
        fits = (fit(problem, point, last.fitted.noise, tolerance=0.5) for point in points)
        best = min(fits, key=lambda f: f.cost)
        independent = worth(problem, best.innovations)
        return addition(problem, last.fitted, last.held_out, best, law.effect, independent)

    memory = beside(lift_memory(problem.flights))
    if not memory.worth_naming or memory.gain < _CERTAIN + max(beside(_BENT_MORE).gain, 0.0):
        return None
    return Leftover(memory.variant.block, 1.0, ((memory.variant.block, 1.0),), note=said(memory))
