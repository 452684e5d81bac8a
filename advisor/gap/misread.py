"""An accelerometer or an attitude that reads in proportion: an error without a name in the catalogue.

α and q may be scaled by name, a_z and θ may not; yet two or three named effects together imitate a scale well
where the air moves. One number that explains as much as several is likelier than they are.
"""

import numpy as np

from advisor.gap.candidates.catalogue import BLOCK_OF
from advisor.gap.fit import fit
from advisor.gap.leftover import Leftover
from advisor.gap.problem import Problem
from advisor.gap.score import Judged, addition, belief_in, log_likelihood_gained, worth
from advisor.gap.screen import Screen
from advisor.gap.variant import Variant
from advisor.gap.waterfall import Stage

_SCALES = {
    channel: Variant(
        name, block, ("scale",), ((0.0,),), (0.002,), ((-0.8, 3.0),), 0.03, entries=(f"{channel}_scale",)
    )
    for channel, name, block in (
        ("a_z", "accelerometer_scale", "accelerometer"),
        ("theta", "attitude_scale", "attitude_sensor"),
    )
}
_CERTAIN = 30.0
"""Log likelihood that a scale must bring: most of what a scale of a_z does is the lift's own slope."""
_LIKELIER = 10.0
"""... and by how much it must beat all that was named together."""


def misread(problem: Problem, stages: list[Stage]) -> Leftover | None:
    """The instrument whose scale explains more than everything that was named; None where none does."""
    plain, held = stages[0].fitted, stages[0].held_out
    tried = [variant for channel, variant in _SCALES.items() if channel in problem.channels]
    found = Screen(problem, plain).quick_fits(tried)
    likeliest = min(found, key=lambda s: s.cost, default=None)
    if likeliest is None or 0.5 * (plain.cost - likeliest.cost) < _CERTAIN:
        return None
    fitted = fit(problem, likeliest.point, likeliest.noise, tolerance=0.5)
    independent = worth(problem, fitted.innovations)
    scaled = addition(problem, plain, held, fitted, likeliest.variant.effect, independent)
    named = _gain_of_all(problem, stages)
    if not scaled.worth_naming or scaled.gain < max(_CERTAIN, named + _LIKELIER):
        return None
    # Likelier though it removes less of the gap: it stands beside what was named, not in its place.
    if scaled.removed < sum(s.added.removed for s in stages if s.added is not None):
        return None
    left = scaled.held_out.mean_square / held.mean_square
    block = likeliest.variant.block
    rivals = {BLOCK_OF[j.effect]: _share(j, scaled) for j in reversed(stages[0].considered)}
    ranking = sorted(((b, s) for b, s in rivals.items() if b != block), key=lambda pair: -pair[1])
    return Leftover(block, float(np.clip(1.0 - np.mean(left), 0.0, 1.0)), ((block, 1.0), *ranking))


def _gain_of_all(problem: Problem, stages: list[Stage]) -> float:
    """What the named effects bring together, as ``Judged.gain`` counts; 0 without any."""
    first, last = stages[0], stages[-1]
    numbers = sum(len(s.added.variant.names) for s in stages if s.added is not None)
    if numbers == 0:
        return 0.0
    independent = worth(problem, last.fitted.innovations)
    likelihood = log_likelihood_gained(first.fitted, first.held_out, last.fitted, last.held_out, independent)
    belief = belief_in(problem, last.fitted, independent) - belief_in(problem, first.fitted, independent)
    return likelihood - 0.5 * numbers * float(np.log(np.sum(independent))) + belief


def _share(judged: Judged, best: Judged) -> float:
    """Gain beside the best's, 0 to 1."""
    return round(float(np.clip(judged.gain / best.gain, 0.0, 1.0)), 4)
