"""A setting of all parameters in a fit, with its residuals and sensitivities."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.model.response import N_PARAMETERS, SHARED, Index, respond
from advisor.oem.extra import Extra
from advisor.oem.instruments import Instrument, extra_of
from advisor.oem.problem import Assembly, OutputErrorProblem, assemble

ASSUMED_M_S = 20.0
"""Air speed assumed where none is known, m/s. The gust angle and the weight's part of α̇ depend on it."""


@dataclass(frozen=True, slots=True)
class Linearization:
    """A setting of all parameters, with its residuals and sensitivities."""

    problem: OutputErrorProblem
    assembly: Assembly
    shared: FloatArray
    local: FloatArray
    residual: FloatArray
    """(N,) residuals."""
    sensitivities: FloatArray
    """(N, 14) sensitivities."""
    extra: Extra
    """Instrument parameters."""


def at(
    problem: OutputErrorProblem, shared: FloatArray, local: FloatArray, instruments: Sequence[Instrument]
) -> Linearization | None:
    """Return the residuals at ``shared`` (7,) and ``local`` (m, 7) parameters; None where the model
    overflows."""
    assembly = assemble(problem)
    y, g = np.empty(len(assembly.z)), np.empty((len(assembly.z), N_PARAMETERS))
    if not respond(assembly.grid, shared, local, y, g):
        return None
    extra = extra_of(problem, assembly, shared, local, instruments)
    return Linearization(problem, assembly, shared, local, assembly.z - y, g, extra)


def in_time(assembly: Assembly, m: int) -> Index:
    """Return the rows of manoeuvre ``m`` in order of time, shape (n,)."""
    rows = assembly.blocks[m]
    return np.asarray(rows.start + np.argsort(assembly.t[rows], kind="stable"))


def speeds_of(problem: OutputErrorProblem) -> list[float]:
    """Return the mean air speed of each manoeuvre, m/s."""
    speeds = [record.airspeed for record in problem.records]
    return [ASSUMED_M_S if speed is None else float(np.mean(speed.y)) for speed in speeds]


def system_of(shared: FloatArray, ratio: float) -> FloatArray:
    """Return Z_α, Z_q, M_α, M_q at an air speed of ``ratio`` times the reference, shape (4,)."""
    z_a, z_q, m_a, m_q = (shared[SHARED.index(n)] for n in ("Z_alpha", "Z_q", "M_alpha", "M_q"))
    return np.array([ratio * z_a, z_q, ratio**2 * m_a, ratio * m_q])
