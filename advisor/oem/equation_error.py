"""Equation error: derivatives by linear regression of the integrated equations, with their errors.

The regression compares integrated motion with measured motion and simulates nothing (Klein & Morelli,
*Aircraft System Identification*, Ch. 5). The servo's lag, the delays and the vane's place are those of the
output-error estimate. Noise in a regressor biases the regression, and its errors do not show this bias.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from advisor.oem.colour import Stretch, find_colour, product
from advisor.oem.estimate import Regressed
from advisor.oem.problem import OutputErrorProblem, Record
from advisor.oem.regression import Equations, regressed
from advisor.oem.rows import Signal, finite
from advisor.oem.start import equations
from advisor.process.arrays import FloatArray

CAVEAT = (
    "Equation error regresses the measured motion, with the servo lag and the delays of output error. Noise "
    "in α and q biases these values, and their intervals leave the bias out: decide by output error."
)
_OF_PITCH = {"alpha": ("Z_alpha", "Z_q", "Z_delta_e"), "q": ("M_alpha", "M_q", "M_delta_e")}
"""Derivatives of each equation, by the output on its left side."""


def equation_error(problem: OutputErrorProblem) -> Mapping[str, Regressed]:
    """Return the derivatives of the short period by equation error, empty without an angle of attack.

    The servo, the delays and the vane's place are those of ``problem``.
    """
    if any("alpha" not in record.outputs for record in problem.records):
        return {}
    problem = replace(problem, records=tuple(_at_centre(record, problem) for record in problem.records))
    by_name: dict[str, Regressed] = {}
    for output, names in _OF_PITCH.items():
        values, std = _with_errors(equations(problem, output))
        if output == "alpha":
            values[1] -= 1.0  # the pitch rate's own part of Eq. (1)
        by_name |= _by_name(names, values, std)
    return by_name


def _at_centre(record: Record, problem: OutputErrorProblem) -> Record:
    """Return the record with the angle of attack at the centre of gravity, at the time of its measurement."""
    t = record.alpha.t - problem.alpha_delay_s
    speed = np.inf if record.airspeed is None else record.airspeed.at(t)
    turning = problem.vane_arm_m / speed * finite(record.outputs["q"]).at(t)
    return replace(record, outputs={**record.outputs, "alpha": Signal(t, record.alpha.y + turning)})


def _by_name(names: Sequence[str], values: FloatArray, std: FloatArray) -> dict[str, Regressed]:
    numbers = zip(names, values.tolist(), std.tolist(), strict=True)
    return {name: Regressed(value, error) for name, value, error in numbers if error > 0.0}


def _with_errors(parts: Sequence[Equations]) -> tuple[FloatArray, FloatArray]:
    """Return the common coefficients (k,) and their standard deviations for coloured residuals; 0 where a
    column is empty."""
    theta, own = regressed(parts)
    kept = [p.common - p.own @ (np.linalg.pinv(p.own) @ p.common) for p in parts]
    influence = np.linalg.pinv(np.concatenate(kept)).T
    colour = find_colour(
        [
            Stretch(p.side - p.common @ theta - p.own @ mine, np.column_stack([p.common, p.own]))
            for p, mine in zip(parts, own, strict=True)
        ]
    )
    ends = np.cumsum([len(p.side) for p in parts])[:-1]
    covariance = sum(product(rows, colour) for rows in np.split(influence, ends))
    return theta, np.sqrt(np.maximum(np.diag(covariance), 0.0))
