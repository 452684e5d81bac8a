"""Elevator samples that a link lost at a step of the command, estimated from the aircraft's response.

A lost output sample costs only its own information. A lost input sample costs far more, because every later
output is simulated wrongly. With a straight line across the gap, a step lies up to an interval from its true
place. The outputs determine the true place of the step. Missing samples across a change of the command become
parameters, bounded by their neighbours. Gauss-Newton estimates the missing samples together with the
aircraft.
"""

from dataclasses import replace

import numpy as np

from advisor.model.outputs import N_PARAMETERS
from advisor.model.response import Index, respond
from advisor.oem.estimate import NoEstimate
from advisor.oem.problem import OutputErrorProblem, Record, assemble
from advisor.oem.rows import Signal
from advisor.oem.solution import Solution, solve
from advisor.process.arrays import FloatArray

LOST_INTERVAL = 1.5
"""Interval between two stamps, in usual intervals, above which a sample was lost."""
LONGEST_GAP_S = 0.25
"""Longest gap, s, that is restored. A longer gap is an outage, and not a sample lost at a step."""
STEP_SHARE = 0.05
"""Least change of the command across the gap, as a share of the input's range."""
MOST_ROUNDS = 6
_SETTLED = 1e-3
"""Numerical: change of the lost samples, as a share of the input's range, below which the search ends."""


def restored(problem: OutputErrorProblem) -> OutputErrorProblem:
    """Return the problem with restored input samples at steps, record by record.

    A record without lost samples, or whose fit does not converge, stays unchanged.
    """
    return replace(problem, records=tuple(_restored(problem, record) for record in problem.records))


def _restored(problem: OutputErrorProblem, record: Record) -> Record:
    stamps, where = _lost(record.elevator)
    if len(stamps) == 0:
        return record
    completed, at = _completed(record, stamps)
    low = np.minimum(record.elevator.y[where], record.elevator.y[where + 1])
    high = np.maximum(record.elevator.y[where], record.elevator.y[where + 1])
    alone = replace(problem, records=(completed,))
    solution = solve(alone)
    for _ in range(MOST_ROUNDS):
        if isinstance(solution, NoEstimate):
            return record
        values = completed.elevator.y[at]
        better = np.clip(values + _correction(solution, at), low, high)
        completed = _with_values(completed, at, better)
        solution = solve(
            replace(problem, records=(completed,)), begin=(solution.optimum.shared, solution.optimum.local)
        )
        if np.max(np.abs(better - values)) <= _SETTLED * float(np.ptp(record.elevator.y)):
            break
    return completed


def _lost(elevator: Signal) -> tuple[FloatArray, Index]:
    """Return the stamps of lost samples at steps, and the index of the last sample before each."""
    intervals = np.diff(elevator.t)
    usual = float(np.median(intervals))
    moved = np.abs(np.diff(elevator.y)) > STEP_SHARE * float(np.ptp(elevator.y))
    gaps = (intervals > LOST_INTERVAL * usual) & (intervals <= LONGEST_GAP_S) & moved
    stamps, where = [], []
    for i in np.flatnonzero(gaps):
        parts = round(float(intervals[i]) / usual)
        for k in range(1, parts):
            stamps.append(elevator.t[i] + k * intervals[i] / parts)
            where.append(int(i))
    return np.array(stamps), np.array(where, dtype=np.int64)


def _completed(record: Record, stamps: FloatArray) -> tuple[Record, Index]:
    """Return the record with samples on a straight line at these stamps, and the samples' indices."""
    t = np.sort(np.concatenate([record.elevator.t, stamps]))
    return replace(record, elevator=Signal(t, record.elevator.at(t))), np.searchsorted(t, stamps)


def _with_values(record: Record, at: Index, values: FloatArray) -> Record:
    y = record.elevator.y.copy()
    y[at] = values
    return replace(record, elevator=Signal(record.elevator.t, y))


def _correction(solution: Solution, at: Index) -> FloatArray:
    """Return the change of each lost sample that explains the residuals best, together with the
    parameters."""
    (record,) = solution.problem.records
    step = 0.1 * float(np.ptp(record.elevator.y))
    answers = np.empty((len(solution.fitted), len(at)))
    for j, index in enumerate(at):
        moved = _with_values(record, np.array([index]), record.elevator.y[[index]] + step)
        assembly = assemble(replace(solution.problem, records=(moved,)))
        y = np.empty(len(solution.fitted))
        respond(
            assembly.grid, solution.optimum.shared, solution.optimum.local, y, np.empty((0, N_PARAMETERS))
        )
        answers[:, j] = (y - solution.fitted) / step
    weight = 1.0 / solution.optimum.noise[solution.assembly.channel]
    free = solution.sensitivities[:, solution.assembly.free]
    system = np.column_stack([free, answers]) * weight[:, None]
    scale = np.linalg.norm(system, axis=0)
    scale[scale == 0.0] = 1.0
    change = np.linalg.lstsq(system / scale, solution.residual * weight, rcond=1e-10)[0] / scale
    return np.asarray(change[free.shape[1] :])
