"""When the command acts between its stamps, common to all manoeuvres.

A digital command is held, and the telemetry reads it some fixed time after it was set; a command
from a stick is nearer to lines between the stamps. Either way what acts may lie up to half an interval
from what was recorded. Large steps get times of their own (``edges``); a smooth input has none, so
here the reading (held or linear) and one offset are decided by the likelihood. Only with a known servo:
a lag that is estimated takes an offset along.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.model.response import N_PARAMETERS, respond
from advisor.oem.edges import CLOSE_ENOUGH, DIFFERENCE_S, large_steps
from advisor.oem.gauss_newton import CONVERGED, Optimum
from advisor.oem.problem import Assembly, Problem, assemble
from advisor.oem.solution import Solution, evaluate, search
from advisor.oem.surface import Servo
from advisor.oem.weighing import Weighing

ROUNDS = 4
SETTLED_S = 1e-5
CLEARLY = 10.0
"""Twice the log-likelihood that another reading of the input must bring."""
PARAMETERS_BEFORE = 8
"""Rows of the influence ahead of the offset's own."""


class Shifted(NamedTuple):
    """The optimum at one offset."""

    problem: Problem
    assembly: Assembly
    optimum: Optimum
    slope: FloatArray
    """(N, 1) derivative of the outputs by the offset."""
    misfit: float
    """Twice the negative log-likelihood but for a constant, as ``Weighing`` has it."""


def with_offset(plain: Solution) -> Solution:
    """Return the solution with the reading and offset of the input that the data clearly prefer, else
    ``plain``.

    Columns of instruments in ``plain.extra`` are kept; that of the offset is not.
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
    """Return Gauss-Newton on the offset with everything else refitted, within ``half`` of the ``middle``."""
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


def _by_offset(problem: Problem, assembly: Assembly, optimum: Optimum) -> FloatArray:
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
