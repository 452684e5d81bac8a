"""Lift that was named as bent, and comes back another way than it went: a stall with a memory."""

from advisor.gap.fitting.fit import fit
from advisor.gap.fitting.problem import Problem
from advisor.gap.fitting.uncertainty import worth
from advisor.gap.search.score import addition
from advisor.gap.search.stage import Stage
from advisor.gap.unnamed.laws import lift_memory, said
from advisor.gap.unnamed.leftover import Leftover

_CERTAIN = 15.0
"""Log likelihood that a memory must bring: a deep stall leaves more than a few figures describe."""


def remembering(problem: Problem, stages: list[Stage]) -> Leftover | None:
    """The lift's memory beside all that was named; None where its bend needs none, or it does not bend."""
    if not any(s.added is not None and s.added.effect == "nonlinear_lift" for s in stages):
        return None
    last, law = stages[-1], lift_memory(problem.flights)
    points = (last.fitted.point.with_effect(law, start) for start in law.starts)
    fits = (fit(problem, point, last.fitted.noise, tolerance=0.5) for point in points)
    best = min(fits, key=lambda f: f.cost)
    independent = worth(problem, best.innovations)
    beside = addition(problem, last.fitted, last.held_out, best, law.effect, independent)
    if not beside.worth_naming or beside.gain < _CERTAIN:
        return None
    return Leftover(law.block, 1.0, ((law.block, 1.0),), note=said(beside))
