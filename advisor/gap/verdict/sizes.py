"""The sizes of a cause, as the aircraft file spells them, with errors that no fit shows."""

from dataclasses import replace

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.effects import EFFECTS
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.kit.variant import Variant
from advisor.gap.result import Cause, Value

_TIMES = frozenset({"delay_s", "lag_s", "skew_s"})
"""Parameters that are times."""
_TIME_ERROR_S = 0.0006
"""Prior: error of a delay, lag or skew in s, for the simulation's grid and the resolution of the stamps."""
_SHAPE_ERROR = 0.03
"""Prior: relative error of a size for the low-order description of its effect."""


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
    return float(np.hypot(_SHAPE_ERROR * value, _TIME_ERROR_S if name in _TIMES else 0.0))


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
