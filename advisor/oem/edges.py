"""Time of a command's step, which lies between two stamps.

A step between two stamps is drawn as a ramp over the interval, equivalent to a step in its middle. The true
time of a step lies anywhere in the interval, and at the later stamp for a held digital command. An error of
half an interval is a false delay of many standard deviations in a joint estimate. Each large step therefore
gets its own time, estimated with all other parameters, if the data require it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtri

from advisor.aircraft.reference import PARAMETERS
from advisor.model.input_response import N_READING, InputChange
from advisor.oem.extra import Extra, Prior
from advisor.oem.gauss_newton import CONVERGED, Optimum
from advisor.oem.instrument_columns import input_columns, stacked
from advisor.oem.problem import Assembly, OutputErrorProblem, Record
from advisor.oem.rows import Signal
from advisor.oem.solution import Solution, evaluate, search
from advisor.oem.weighing import Weighing
from advisor.process.arrays import FloatArray

LARGE = 0.25
"""Least share of the command's range that a large step covers within one interval."""
ISOLATED = 0.3
"""Largest change in the neighbouring intervals, as a share of the step, for an isolated step."""
WIDTH_S = 1e-4
"""Duration of a sharpened step, s."""
ROUNDS = 2
CHANCE = 1e-3
"""Largest probability of a likelihood gain by chance with which steps are sharpened."""
GAIN_UPRIGHT = 3.0
"""Least gain in twice the log likelihood of vertical steps in the middle of their intervals. A ramp and a
step in its middle look alike but give different M_δe."""
MOST_MANEUVERS = 20
CLOSE_ENOUGH = 1e-9
"""Promised change of log J per sample at which an intermediate search ends."""


@dataclass(frozen=True, slots=True)
class Edges:
    """Large steps of one record's command, and their times."""

    interval: tuple[int, ...]
    """Index of the stamp before each step."""
    stamps: FloatArray
    """Shape (2, k): stamps before and after each step, s."""
    time: FloatArray
    """Shape (k,): time of each step, between its stamps, s."""


def large_steps(command: Signal) -> Edges:
    """Return the isolated large steps of a command, each placed in the middle between two stamps."""
    change = np.abs(np.diff(command.y))
    next_to_it = np.maximum(np.append(change[1:], 0.0), np.append(0.0, change[:-1]))
    span = float(np.ptp(command.y))
    interval = tuple(
        int(i) for i in np.flatnonzero((change > LARGE * span) & (next_to_it < ISOLATED * change))
    )
    stamps = np.array([command.t[: len(change)], command.t[1:]])[:, list(interval)]
    return Edges(interval, stamps, stamps.mean(axis=0))


def sharpened(command: Signal, edges: Edges) -> Signal:
    """Return the command with vertical large steps at the given times."""
    t, y = list(command.t), list(command.y)
    for i, when in sorted(zip(edges.interval, edges.time, strict=True), reverse=True):
        t[i + 1 : i + 1] = [when - WIDTH_S / 2.0, when + WIDTH_S / 2.0]
        y[i + 1 : i + 1] = [command.y[i], command.y[i + 1]]
    return Signal(np.array(t), np.array(y))


def with_edges(plain: Solution) -> Solution:
    """Return the solution with a time for every large step; ``plain`` if the gain is too small.

    The additional parameters of ``plain`` keep their values and errors, and the step times follow them. A
    step is equally likely everywhere between its two stamps."""
    records = plain.problem.records
    edges = [large_steps(record.elevator) for record in records]
    count = sum(len(e.interval) for e in edges)
    if count == 0 or len(records) > MOST_MANEUVERS or any(record.held for record in records):
        return plain
    own = plain.extra or Extra.none(len(plain.fitted))
    near, problem, assembly, optimum = plain.optimum, plain.problem, plain.assembly, plain.optimum
    weighing = Weighing.by(plain.noise.colours, plain.assembly)
    before = weighing.misfit(plain.residual, plain.sensitivities)
    extra, gain, upright = own, 0.0, 0.0
    for round_ in range(ROUNDS + 1):
        problem = _edged(plain.problem, edges, records)
        assembly, optimum = search(problem, begin=(near.shared, near.local), flat=CLOSE_ENOUGH)
        if optimum.status != CONVERGED:
            return plain
        near = optimum
        residual, g = assembly.z - optimum.fitted, optimum.sensitivities
        gain = before - weighing.misfit(residual, g)
        if round_ == 0:
            upright = gain
        columns = _by_edges(problem, assembly, optimum, edges)
        extra = own.joined(_within_intervals(edges, columns))
        if round_ == ROUNDS:
            break
        effect = weighing.influence(g, extra)
        if effect is None:
            return plain
        edges = _moved(edges, effect.step(residual, extra)[len(PARAMETERS) + len(own) :])
    if gain < chdtri(count, CHANCE) and upright < GAIN_UPRIGHT:
        return plain
    final = evaluate(problem, assembly, optimum, extra, kept=len(own))
    return replace(final, modes=plain.modes, alike=plain.alike) if isinstance(final, Solution) else plain


def _edged(
    problem: OutputErrorProblem, edges: Sequence[Edges], records: Sequence[Record]
) -> OutputErrorProblem:
    """Return the problem with the commands of ``records`` sharpened."""
    return replace(
        problem,
        records=tuple(
            replace(record, elevator=sharpened(record.elevator, e))
            for record, e in zip(records, edges, strict=True)
        ),
    )


def _within_intervals(edges: Sequence[Edges], columns: FloatArray) -> Extra:
    """Return the step times as parameters, with a uniform prior over their intervals."""
    first, last = np.concatenate([e.stamps for e in edges], axis=1)
    time = np.concatenate([e.time for e in edges])
    priors = [Prior((a + b) / 2.0, (b - a) / np.sqrt(12.0)) for a, b in zip(first, last, strict=True)]
    return Extra.at(columns, time, priors)


def _moved(edges: Sequence[Edges], steps: FloatArray) -> list[Edges]:
    """Return the steps with moved times, each within its interval."""
    ends = np.cumsum([len(e.interval) for e in edges])
    return [
        replace(e, time=np.clip(e.time + by, e.stamps[0] + WIDTH_S, e.stamps[1] - WIDTH_S))
        for e, by in zip(edges, np.split(steps, ends[:-1]), strict=True)
    ]


def _by_edges(
    problem: OutputErrorProblem, assembly: Assembly, optimum: Optimum, edges: Sequence[Edges]
) -> FloatArray:
    """Return the derivatives of the outputs by the step times, shape (N, k), manoeuvre by manoeuvre.

    The j-th steps of all manoeuvres are moved together, because each affects its own manoeuvre only.
    """
    counts = [len(e.interval) for e in edges]
    most = max(counts)

    def changes(m: int, record: Record, t: FloatArray) -> InputChange:
        # Two samples that draw an edge upright stand behind those of each edge before.
        upright = [i + 1 + 2 * j for j, i in enumerate(edges[m].interval)]
        late = [
            problem.servo.changes(record.elevator.t, record.elevator.y, t, intervals=upright[j : j + 1])
            for j in range(most)
        ]
        return InputChange(*(rows[:, ::2] for rows in stacked(late, axis=1)))

    together = input_columns(problem, assembly, optimum.shared, optimum.local, changes)[:, N_READING:]
    columns = np.zeros((len(assembly.z), sum(counts)))
    first = np.cumsum([0, *counts])
    for m, count in enumerate(counts):
        mine = assembly.owner == m
        columns[mine, first[m] : first[m + 1]] = together[mine, :count]
    return columns
