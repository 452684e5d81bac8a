"""Causes of an answer, including moving air, with sizes from the answer's own model."""

from collections.abc import Sequence
from dataclasses import replace
from math import hypot

import numpy as np

from advisor.flight.instruments.kinematics import KinematicCheck
from advisor.gap.candidates.distinguish import imitations, way_to_distinguish
from advisor.gap.effects import EFFECTS
from advisor.gap.fitting.measure import whole_gap
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.fitting.uncertainty import covariance_of
from advisor.gap.inference.diagnose import Inference
from advisor.gap.inference.findings import Findings
from advisor.gap.inference.offset import OFFSET, cause_of_offset
from advisor.gap.inference.pitch import PitchModel
from advisor.gap.inference.posterior import Posterior, stated_as
from advisor.gap.kit.effect import Variant
from advisor.gap.result import Cause, Gap, Value
from advisor.gap.verdict.holdout_numbers import without_air
from advisor.process.arrays import FloatArray

MOST_CAUSES = 5
"""Words: largest number of causes that are stated."""
_CREDIBLE = 0.05
"""Words: least probability of an effect that is listed as not distinguished from the answer."""


def causes_of(
    inference: Inference,
    posterior: Posterior[PitchModel],
    e: Findings,
    kinematics: KinematicCheck,
    gap: Gap,
    named: Sequence[PitchModel],
) -> tuple[Cause, ...]:
    """Return the named causes in the order of the model, then the alternatives to the first cause."""
    answer = posterior.answer
    present: list[Cause] = []
    together = 1.0
    for stage, model in zip(inference.posteriors, named, strict=False):
        judged = posterior if stage is inference.posteriors[0] else stage
        together *= judged.of(stated_as(model.name))
        present.append(_cause(inference, e, model, named[-1], judged, together, True))
    if e.without is not None:
        first, *rest = posterior.explanation_of(answer).taken_out
        present += [replace(first, probability=posterior.of(answer)), *rest]
    if answer.kind == "air" and (air := moving_air_of(e)) is not None:
        present.append(replace(air, probability=posterior.of(answer)))
    if answer == OFFSET:
        present.append(cause_of_offset(kinematics, posterior.of(OFFSET), gap.after, True))
    taken = {c.effect for c in present}
    left = 1.0 - sum(c.probability for c in present)
    others: list[Cause] = []
    for alternative, p in posterior.by_alternative.items():
        if not alternative.is_effect or alternative.name in taken or len(others) + len(taken) >= MOST_CAUSES:
            continue
        model = posterior.explanation_of(alternative)
        p, left = min(p, left), left - min(p, left)
        if model.name == alternative.name:
            others.append(_cause(inference, e, model, model, posterior, p, False))
        elif alternative == OFFSET:
            others.append(cause_of_offset(kinematics, posterior.of(OFFSET), gap.after, False))
    return (*present, *others)


def _cause(
    inference: Inference,
    e: Findings,
    pitch_model: PitchModel,
    model: PitchModel,
    posterior: Posterior[PitchModel],
    probability: float,
    present: bool,
) -> Cause:
    """Return an effect with its sizes from a model, whose posterior gives their errors."""
    point = model.fitted.point
    k = point.index_of(pitch_model.name)
    std = np.sqrt(np.maximum(np.diag(covariance_of(model.problem, model.fitted, inference.heat)), 0.0))
    sizes = parameters_of(point.effects[k], np.asarray(point.values[k]), std[point.place(k)])
    alike, way = _not_told_from(pitch_model.name, posterior, e.problem.channels)
    gap_after = whole_gap(pitch_model.held_out.mean_square, e.floor)
    block = EFFECTS[pitch_model.name].block
    cause = Cause(pitch_model.name, block, probability, sizes, alike, way, gap_after, present)
    return with_model_errors(cause, inference.problem)


def _not_told_from(
    name: str, posterior: Posterior[PitchModel], channels: Sequence[str]
) -> tuple[tuple[str, ...], str]:
    """Return the effects that the evidence does not exclude, and the measurement that would."""
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


_GUST_ERROR = 0.25
"""Prior: relative error of a gust's strength, because its course is a low-order estimate."""
_TURBULENCE_ERROR = 0.5
"""Prior: relative error of the strength of turbulence. Waves longer than a record are absorbed by its trim.
If Dryden's scale length takes at least three seconds to fly through, 0.5 to 0.7 of the strength is found. If
the scale length takes one second, 1.2 of the strength is found."""
_GUST_TIME_ERROR_S = 0.1
"""Prior: error of a gust's time, s: the distance between two knots of its course."""


def moving_air_of(e: Findings) -> Cause | None:
    """Return turbulence or a gust with its strength; None if the air is not the answer."""
    if e.air is None:
        return None
    reference = e.problem.flights.reference_m_s
    gust, stays = e.air.gust, without_air(e.last.held_out, e.air).mean_square
    gap_after = whole_gap(stays, np.minimum(e.floor, np.sqrt(e.air.mean_square_beyond_air)))
    peak, spread = e.air.gust_angle * reference, e.air.angle_std * reference
    parameters = {"sigma_w_m_s": Value(spread, _TURBULENCE_ERROR * spread)}
    if gust:
        parameters = {
            "amplitude_m_s": Value(peak, _GUST_ERROR * abs(peak)),
            "at_s": Value(e.air.gust_at_s, _GUST_TIME_ERROR_S),
        }
    name, other = ("gust", "turbulence") if gust else ("turbulence", "gust")
    return Cause(
        name, "air", 0.0, parameters, (other,), way_to_distinguish(name, other), gap_after, True,
    )  # fmt: skip


_TIMES = frozenset({"delay_s", "lag_s", "skew_s"})
"""Names of the parameters that are times."""
_TIME_ERROR_S = 0.0006
"""Prior: error of a delay, lag or skew in s, from the simulation's grid and the stamps' resolution."""
_SHAPE_ERROR = 0.03
"""Prior: relative error of a size due to the effect's low-order description."""


def parameters_of(v: Variant, values: FloatArray, std: FloatArray) -> dict[str, Value]:
    """Return the parameters and their errors as the aircraft file spells them; both arrays have shape
    (names,)."""
    sizes = {n: Value(float(x), float(s)) for n, x, s in zip(v.names, values, std, strict=True)}
    if v.inverted:
        x = max(float(values[0]), 1e-9)
        sizes[v.names[0]] = Value(1.0 / x, float(std[0]) / x**2)
    if v.in_file:
        sizes = {
            key: Value(sizes[name].value * (1.0 / factor), sizes[name].std * (1.0 / factor))
            for key, (name, factor) in v.in_file.items()
        }
    for name, value in v.fixed.items():
        sizes[name] = Value(value, 0.0)
    return sizes


def with_model_errors(cause: Cause, problem: EffectProblem) -> Cause:
    """Return the cause with errors that no fit shows: those of the low-order description and of the time
    grid."""
    widened = {
        name: Value(v.value, hypot(v.std, _SHAPE_ERROR * v.value, _TIME_ERROR_S * (name in _TIMES)))
        for name, v in cause.parameters.items()
        if v.std > 0.0
    }
    return _with_edge_error(replace(cause, parameters={**cause.parameters, **widened}), problem)


def _with_edge_error(cause: Cause, problem: EffectProblem) -> Cause:
    """Return a delay or lag with the error of steps that lie anywhere between two command stamps."""
    intervals = [flight.edges[:, 2] for flight in problem.flights.flights if len(flight.edges)]
    section, name = EFFECTS[cause.effect].stated or ("", "")
    if problem.held or not intervals or section != "elevator":
        return cause
    edge_std = float(np.median(np.concatenate(intervals))) / np.sqrt(12.0)
    value = cause.parameters[name]
    parameters = {**cause.parameters, name: Value(value.value, float(np.hypot(value.std, edge_std)))}
    return replace(cause, parameters=parameters)
