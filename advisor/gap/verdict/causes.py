"""The causes of an answer, with the sizes of the answer's own model."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.flight.instruments.kinematics import KinematicCheck
from advisor.gap.candidates.distinguish import imitations, way_to_distinguish
from advisor.gap.effects import EFFECTS
from advisor.gap.fitting.measure import whole_gap
from advisor.gap.inference.diagnose import Inference
from advisor.gap.inference.evidence import covariance_of
from advisor.gap.inference.explanation import Explanation
from advisor.gap.inference.findings import Findings
from advisor.gap.inference.posterior import Posterior, stated_as
from advisor.gap.result import Cause, Gap, Value
from advisor.gap.verdict.air_cause import moving_air_of
from advisor.gap.verdict.sizes import parameters_of, with_model_errors

MOST_CAUSES = 5
"""Words: most causes that are stated."""
_CREDIBLE = 0.05
"""Words: least probability of an effect that is listed as not told from the answer."""


def causes_of(
    found: Inference,
    posterior: Posterior,
    e: Findings,
    kinematics: KinematicCheck,
    gap: Gap,
    named: Sequence[Explanation],
) -> tuple[Cause, ...]:
    """Return the named causes in the order of the model, then the alternatives to the first, likeliest
    first."""
    answer = posterior.answer
    present: list[Cause] = []
    together = 1.0
    for stage, one in zip(found.posteriors, named, strict=False):
        told = posterior if stage is found.posteriors[0] else stage
        together *= told.of(stated_as(one.name))
        present.append(_cause(found, e, one, named[-1], told, together, True))
    if answer.kind == "air" and (air := moving_air_of(e)) is not None:
        present.append(replace(air, probability=posterior.of(answer)))
    if answer.name == "alpha_bias":
        present.append(_offset(kinematics, posterior, gap, True))
    taken = {c.effect for c in present}
    left = 1.0 - sum(c.probability for c in present)
    others: list[Cause] = []
    for alternative, p in posterior.by_alternative.items():
        if not alternative.is_effect or alternative.name in taken or len(others) + len(taken) >= MOST_CAUSES:
            continue
        one = posterior.explanation_of(alternative)
        p, left = min(p, left), left - min(p, left)
        if one.name == alternative.name:
            others.append(_cause(found, e, one, one, posterior, p, False))
        elif alternative.name == "alpha_bias":
            others.append(_offset(kinematics, posterior, gap, False))
    return (*present, *others)


def _cause(
    found: Inference,
    e: Findings,
    one: Explanation,
    model: Explanation,
    posterior: Posterior,
    probability: float,
    present: bool,
) -> Cause:
    """Return an effect with its sizes in a model, whose posterior gives their errors."""
    point = model.fitted.point
    k = point.index_of(one.name)
    std = np.sqrt(np.maximum(np.diag(covariance_of(model.problem, model.fitted, found.heat)), 0.0))
    sizes = parameters_of(point.effects[k], np.asarray(point.values[k]), std[point.place(k)])
    alike, way = _not_told_from(one.name, posterior, e.problem.channels)
    gap_after = whole_gap(one.held_out.mean_square, e.floor)
    block = EFFECTS[one.name].block
    cause = Cause(one.name, block, probability, sizes, alike, way, gap_after, present)
    return with_model_errors(cause, found.problem)


def _offset(kinematics: KinematicCheck, posterior: Posterior, gap: Gap, present: bool) -> Cause:
    offset = kinematics.offset
    return Cause(
        "alpha_bias", "alpha_sensor", posterior.of(stated_as("alpha_bias")),
        {"bias_rad": Value(offset.rad, offset.std_rad)},
        ("an offset of the attitude's zero", "steady up- or downwash"),
        "level the attitude reference on the ground; fly in still air", gap.after, present,
    )  # fmt: skip


def _not_told_from(name: str, posterior: Posterior, channels: Sequence[str]) -> tuple[tuple[str, ...], str]:
    """Return the effects that the evidence does not exclude, and what would distinguish them."""
    names = [
        a.name
        for a, p in posterior.by_alternative.items()
        if a.is_effect and a.name != name and p >= _CREDIBLE
    ]
    ways = [way for other in names if (way := way_to_distinguish(name, other))]
    for looks, way in imitations(name, channels):
        names.append(looks)
        ways.append(way)
    if names and not ways:
        ways.append("fly more manoeuvres, with another time unit and another amplitude")
    return tuple(names), "; ".join(dict.fromkeys(ways))
