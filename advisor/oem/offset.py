"""The time at which the command acts between its stamps, common to all manoeuvres.

A digital command is held, and telemetry reads it at a fixed time after it was set. A command from a stick is
nearer to lines between the stamps. Either way the acting command may be up to half an interval from the
recorded one. Large steps get their own times (``edges``). For a smooth input the likelihood decides on the
reading (held or linear) and on one offset. That needs a known servo, because an estimated lag absorbs an
offset.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.model.response import N_PARAMETERS, respond
from advisor.oem.edges import CLOSE_ENOUGH, DIFFERENCE_S, large_steps
from advisor.oem.gauss_newton import CONVERGED, Optimum
from advisor.oem.problem import Assembly, OutputErrorProblem, assemble
from advisor.oem.solution import Solution, evaluate, search
from advisor.oem.surface import Servo
from advisor.oem.weighing import Weighing

ROUNDS = 4
SETTLED_S = 1e-5
CLEARLY = 10.0
"""Least gain in twice the log likelihood for another reading of the input."""
PARAMETERS_BEFORE = 8
"""Number of influence rows before the offset's own."""


class Shifted(NamedTuple):
    """The optimum at one offset."""

    problem: OutputErrorProblem
    assembly: Assembly
    optimum: Optimum
    slope: FloatArray
    """(N, 1) derivative of the outputs by the offset."""
    misfit: float
    """Twice the negative log likelihood up to a constant, by ``Weighing``."""


def with_offset(plain: Solution) -> Solution:
    """Return the solution with the reading and offset of the input that the data clearly prefer, else
    ``plain``.

    Columns of instruments in ``plain.extra`` are kept; the column of the offset is not.
    """
    records = plain.problem.records
    if all(large_steps(record.elevator).interval for record in records):
        return plain
    half = float(np.median(np.concatenate([np.diff(record.elevator.t) for record in records]))) / 2.0
    weighing = Weighing.by(plain.noise, plain.assembly)
    found = [
        _best(plain, weighing, held=False, middle=0.0, half=half),
        _best(plain, weighing, held=True, middle=-half, half=half),
    ]
    usable = [shifted for shifted in found if shifted is not None]
    if not usable:
        return plain
    best = min(usable, key=lambda shifted: shifted.misfit)
    if weighing.misfit(plain.residual, plain.sensitivities) - best.misfit < CLEARLY:
        return plain
    own = np.empty((len(plain.residual), 0)) if plain.extra is None else plain.extra
    columns = np.column_stack([own, best.slope])
    final = evaluate(best.problem, best.assembly, best.optimum, columns, kept=own.shape[1])
    return final if isinstance(final, Solution) else plain


def _best(plain: Solution, weighing: Weighing, *, held: bool, middle: float, half: float) -> Shifted | None:
    """Minimise the cost over the offset by Gauss-Newton within ``half`` of the ``middle``, with everything
    else refitted."""
    records = tuple(replace(record, held=held) for record in plain.problem.records)
    near, offset, best = plain.optimum, middle, None
    for _ in range(ROUNDS):
        problem = replace(plain.problem, records=records, servo=_later(plain.problem.servo, offset))
        assembly, optimum = search(problem, begin=(near.shared, near.local), flat=CLOSE_ENOUGH)
        if optimum.status != CONVERGED:
            break
        residual, g = assembly.z - optimum.fitted, optimum.sensitivities
        misfit = weighing.misfit(residual, g)
        if best is not None and misfit >= best.misfit:
            break
        slope = _by_offset(problem, assembly, optimum)
        near, best = optimum, Shifted(problem, assembly, optimum, slope, misfit)
        rows = weighing.influence(g, slope)
        if rows is None:
            return None
        step = float(rows[:, PARAMETERS_BEFORE] @ residual)
        moved = float(np.clip(offset + step, middle - half, middle + half))
        if abs(moved - offset) < SETTLED_S:
            break
        offset = moved
    return best


def _by_offset(problem: OutputErrorProblem, assembly: Assembly, optimum: Optimum) -> FloatArray:
    sides = []
    for sign in (-1.0, 1.0):
        grid = assemble(replace(problem, servo=_later(problem.servo, sign * DIFFERENCE_S))).grid
        y = np.empty(len(assembly.z))
        respond(grid, optimum.shared, optimum.local, y, np.empty((0, N_PARAMETERS)))
        sides.append(y)
    slope: FloatArray = ((sides[1] - sides[0]) / (2.0 * DIFFERENCE_S))[:, None]
    return slope


def _later(servo: Servo, seconds: float) -> Servo:
    return replace(servo, delay_s=servo.delay_s + seconds)
