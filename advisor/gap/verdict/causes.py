"""From judged candidates to readable causes: parameters, and indistinguishable effects."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.effects import EFFECTS
from advisor.gap.fitting.measure import whole_gap
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.kit.variant import Variant
from advisor.gap.result import Cause, Value
from advisor.gap.search.acceptance import JudgedAddition
from advisor.gap.search.indistinguishable import indistinguishable_from
from advisor.gap.search.score import TIME_ERROR_S, TIMES
from advisor.gap.search.stage import Stage

_SHAPE_ERROR = 0.03
"""Prior: relative error of a size for the low-order description of its effect."""


def causes_of(stages: Sequence[Stage], floor: FloatArray, channels: Sequence[str]) -> tuple[Cause, ...]:
    """Return the added effects in their order, then the alternatives to the first one.

    The probabilities are set later.
    """
    first = stages[0].considered
    named = [
        _cause(stage.added, stage.considered, floor, channels, True)
        for stage in stages
        if stage.added is not None
    ]
    taken = {c.effect for c in named}
    others = [
        _cause(j, first, floor, channels, False) for j in first if j.effect not in taken and j.gain > 0.0
    ]
    return (*named, *others)


def parameters_of(v: Variant, values: FloatArray, std: FloatArray) -> dict[str, Value]:
    """Return the parameters and their errors as the aircraft file spells them; both arrays have shape
    (names,)."""
    found = {n: Value(float(x), float(s)) for n, x, s in zip(v.names, values, std, strict=True)}
    if v.inverted:
        x = max(float(values[0]), 1e-9)
        found[v.names[0]] = Value(1.0 / x, float(std[0]) / x**2)
    if v.in_file:
        found = {
            key: Value(found[name].value * (1.0 / factor), found[name].std * (1.0 / factor))
            for key, (name, factor) in v.in_file.items()
        }
    for name, value in v.fixed.items():
        found[name] = Value(value, 0.0)
    return found


def with_model_errors(cause: Cause, problem: EffectProblem) -> Cause:
    """Return the cause with errors that no fit shows: of the low-order description and of the time grid."""
    widened = {
        name: Value(v.value, float(np.hypot(v.std, _model_error(name, v.value))))
        for name, v in cause.parameters.items()
        if v.std > 0.0
    }
    return _with_edge_error(replace(cause, parameters={**cause.parameters, **widened}), problem)


def _model_error(name: str, value: float) -> float:
    """Return the standard deviation of a size for model errors: a share of it, and for times part of a
    step."""
    return float(np.hypot(_SHAPE_ERROR * value, TIME_ERROR_S if name in TIMES else 0.0))


def _with_edge_error(cause: Cause, problem: EffectProblem) -> Cause:
    """Return a delay or lag with the error of steps that may lie anywhere between two stamps of the
    command."""
    intervals = [flight.edges[:, 2] for flight in problem.flights.flights if len(flight.edges)]
    section, name = EFFECTS[cause.effect].stated or ("", "")
    if problem.held or not intervals or section != "elevator":
        return cause
    edge_std = float(np.median(np.concatenate(intervals))) / np.sqrt(12.0)
    value = cause.parameters[name]
    parameters = {**cause.parameters, name: Value(value.value, float(np.hypot(value.std, edge_std)))}
    return replace(cause, parameters=parameters)


def _cause(
    judged: JudgedAddition,
    considered: Sequence[JudgedAddition],
    floor: FloatArray,
    channels: Sequence[str],
    present: bool,
) -> Cause:
    alike, way = indistinguishable_from(judged, considered, channels)
    gap_after = whole_gap(judged.held_out.mean_square, floor)
    sizes = parameters_of(judged.variant, judged.value, judged.std)
    return Cause(judged.effect, judged.block, 0.0, sizes, alike, way, gap_after, present)


def block_ranking(first: Stage, causes: Sequence[Cause]) -> tuple[tuple[str, float], ...]:
    """Return the blocks with the score of their best effect; the best block scores 1."""
    scores: dict[str, float] = {}
    for cause in causes:
        if cause.present:
            scores.setdefault(cause.block, 1.0)
    best = max((j.gain for j in first.considered), default=0.0)
    for j in first.considered:
        if best > 0.0 and j.gain > 0.0:
            scores[j.block] = max(scores.get(j.block, 0.0), round(j.gain / best, 4))
    return tuple(sorted(scores.items(), key=lambda item: -item[1]))
