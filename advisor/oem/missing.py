"""Benefit of an unmeasured a_z, as a factor on each parameter's error.

The channel is assumed at the stamps of the pitch rate, with an equal noise-to-motion ratio and its own bias.
The sensitivities of the present fit give the Cramér-Rao bound with a_z.
"""

from dataclasses import replace

import numpy as np

from advisor.aircraft.reference import PARAMETERS
from advisor.model.outputs import N_PARAMETERS, OUTPUTS
from advisor.model.response import respond
from advisor.oem.covariance import cramer_rao, influence
from advisor.oem.problem import Assembly, assemble
from advisor.oem.rows import Signal
from advisor.oem.solution import Solution
from advisor.process.arrays import FloatArray
from advisor.words.quantities import symbol

WORTH_NAMING = 1.05
"""Least factor on an error for which the report names the parameter."""


def price(solution: Solution) -> FloatArray | None:
    """Return the ratio of each parameter's error without a_z to its error with a_z, shape (8,), as in
    ``PARAMETERS``.

    Returns
    -------
    array or None
        None if the factors are unknown, because a_z needs an air speed and an informative input.
    """
    records, output = solution.problem.records, "a_z"
    if any(record.airspeed is None for record in records):
        return None
    imagined = tuple(
        replace(record, outputs={**record.outputs, output: Signal(t, np.zeros(len(t)))})
        for record in records
        for t in [record.outputs["q"].t[np.isfinite(record.outputs["q"].y)]]
    )
    assembly = assemble(replace(solution.problem, records=imagined))
    y, g = np.empty(len(assembly.z)), np.empty((len(assembly.z), N_PARAMETERS))
    if not respond(assembly.grid, solution.optimum.shared, solution.optimum.local, y, g):
        return None
    noise = solution.optimum.noise.copy()
    noise[OUTPUTS.index(output)] = (
        noise[OUTPUTS.index("q")] * _spread(assembly, y, output) / _spread(assembly, y, "q")
    )
    with_it = _errors(assembly, g, noise)
    without = _errors(solution.assembly, solution.sensitivities, solution.optimum.noise)
    if with_it is None or without is None:
        return None
    return np.asarray(without / np.maximum(with_it, 1e-300))


def in_words(factors: FloatArray | None) -> str:
    """Return the sentence about a_z for the notes; empty if the factors are unknown."""
    if factors is None:
        return ""
    named = [
        f"{symbol(name)} {factor:.2f}"
        for name, factor in zip(PARAMETERS, factors, strict=True)
        if factor > WORTH_NAMING
    ]
    if not named:
        return f" No error is more than {100.0 * (WORTH_NAMING - 1.0):.0f} % larger without it."
    listed = ", ".join(named)
    return f" With an a_z as free of noise as the pitch rate, errors would be smaller by factors: {listed}."


def _spread(assembly: Assembly, y: FloatArray, output: str) -> float:
    """Return the root mean square of an output's simulated motion within the manoeuvres."""
    return float(np.sqrt(np.mean([np.var(y[rows[output]]) for rows in assembly.rows])))


def _errors(assembly: Assembly, g: FloatArray, noise: FloatArray) -> FloatArray | None:
    effect = influence(assembly, g, noise)
    return None if effect is None else np.sqrt(np.diag(cramer_rao(assembly, effect.rows, noise)))
