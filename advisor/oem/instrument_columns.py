"""Derivatives of a fit's outputs by instrument parameters and by the times of the command's steps.

A vane's arm or a delay changes how an output reads the motion. A servo's lag changes the surface. One pass
over the motion of a fit gives all derivatives (``model.input_response``).
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from advisor.model.input_response import (
    BY_ACCELEROMETER,
    BY_ALPHA_DELAY,
    BY_VANE,
    N_READING,
    InputChange,
    respond_to_change,
)
from advisor.model.outputs import N_PARAMETERS
from advisor.model.response import respond
from advisor.oem.known_instruments import InstrumentName
from advisor.oem.problem import Assembly, OutputErrorProblem, Record, assemble, steady_share
from advisor.oem.rows import padded
from advisor.process.arrays import FloatArray

READING = {"vane_arm_m": BY_VANE, "accelerometer_arm_m": BY_ACCELEROMETER, "alpha_delay_s": BY_ALPHA_DELAY}
"""Column index of each instrument of an output."""
STEP = 1e-4
"""Numerical: change of the rates, rad/s and rad/s², for the derivative by a term, which is nearly linear."""
OF_COMMAND = ("command_delay_s", "servo_lag_s", "steady_moment_rad")
"""Instruments that change the motion of the surface, or have the effect of such a change."""


def instrument_columns(
    problem: OutputErrorProblem,
    assembly: Assembly,
    shared: FloatArray,
    local: FloatArray,
    names: Sequence[InstrumentName],
) -> FloatArray:
    """Return the derivatives of the outputs by instruments, shape (N, k), with all other parameters fixed.

    Parameters
    ----------
    assembly
        Rows of ``problem``, laid out for the kernel.
    shared, local
        Shapes (7,) and (m, 7).
    """

    def of_command(m: int, record: Record, t: FloatArray) -> InputChange:
        servo = problem.servo.changes(*record.command, t, record.held)
        return stacked([servo, _steady(problem, assembly, m)], axis=1)

    columns = input_columns(problem, assembly, shared, local, of_command)
    places = {**READING, **{name: N_READING + i for i, name in enumerate(OF_COMMAND)}}
    parts = [
        _by_term(problem, assembly, shared, local, name)
        if name in problem.terms
        else columns[:, places[name]]
        for name in names
    ]
    return np.column_stack(parts)


def _by_term(
    problem: OutputErrorProblem, assembly: Assembly, shared: FloatArray, local: FloatArray, term: str
) -> FloatArray:
    """Return the derivative of the outputs by a term's coefficient, shape (N,)."""
    alone = assemble(replace(problem, terms={**dict.fromkeys(problem.terms, 0.0), term: 1.0})).grid
    none = assemble(replace(problem, terms={})).grid
    forced, turned = alone.known - none.known, alone.turned
    step = STEP / max(float(np.max(np.abs(forced))), float(np.max(np.abs(turned))), 1e-300)
    ends = []
    for share in (step, -step):
        ends.append(np.empty(len(assembly.z)))
        grid = assembly.grid._replace(
            known=assembly.grid.known + share * forced, turned=assembly.grid.turned + share * turned
        )
        respond(grid, shared, local, ends[-1], np.empty((0, N_PARAMETERS)))
    return (ends[0] - ends[1]) / (2.0 * step)


def input_columns(
    problem: OutputErrorProblem,
    assembly: Assembly,
    shared: FloatArray,
    local: FloatArray,
    change: Callable[[int, Record, FloatArray], InputChange],
) -> FloatArray:
    """Return the derivatives by the three output instruments, and by changes of the surface.

    Parameters
    ----------
    change
        Function that returns the changes of one record from its number, the record and its event stamps.

    Returns
    -------
    FloatArray
        Shape (N, 3 + k), manoeuvre by manoeuvre.
    """
    events = np.split(assembly.events, assembly.grid.first[1:-1])
    parts = [change(m, record, t) for m, (record, t) in enumerate(zip(problem.records, events, strict=True))]
    moved = stacked(parts, axis=0)
    columns = np.empty((len(assembly.z), N_READING + moved.at.shape[1]))
    respond_to_change(assembly.grid, shared, local, moved, columns)
    return columns


def stacked(changes: Sequence[InputChange], axis: int) -> InputChange:
    """Return changes one after the other (axis 0) or side by side (axis 1)."""
    return InputChange(*(np.concatenate(parts, axis=axis) for parts in zip(*changes, strict=True)))


def _steady(problem: OutputErrorProblem, assembly: Assembly, m: int) -> InputChange:
    grid, events = assembly.grid, slice(assembly.grid.first[m], assembly.grid.first[m + 1])
    share = steady_share(problem, grid.airspeed[events])
    slope = padded(np.diff(share) / np.diff(assembly.events[events]))
    return InputChange(*(x[:, None] for x in (share, share, slope, np.zeros(len(share)))))
