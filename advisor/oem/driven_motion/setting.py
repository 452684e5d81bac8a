"""Residuals, sensitivities and linear motions of a problem at one setting of all parameters."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from advisor.model.response import Index
from advisor.oem.driven_motion.kalman_filter import driven_filter
from advisor.oem.driven_motion.linear import DrivenMotion, Linear
from advisor.oem.driven_motion.noise import RANGE, Noise
from advisor.oem.extra import Extra, Parameter
from advisor.oem.prior import Priors
from advisor.oem.rows import Laid
from advisor.process.arrays import FloatArray

STAMP_S = 1e-3 / 12.0**0.5
"""Standard deviation of a stamp in whole milliseconds, s."""
_GRID_S = 1e-4
"""Numerical: grid of the time steps, s, of which equal ones share their matrices. Residuals hardly move in
half of it."""


@dataclass(frozen=True, slots=True)
class Setting:
    """One setting of all parameters, with its residuals, sensitivities and linear motions."""

    problem: Any
    assembly: Laid
    shared: FloatArray
    local: FloatArray
    residual: FloatArray
    sensitivities: FloatArray
    extra: Extra
    motions: Sequence[Linear]
    orders: Sequence[Index]
    """Rows of each manoeuvre in order of time."""
    steps: Sequence[tuple[FloatArray, Index, Index]]
    """Distinct lengths of each manoeuvre's time steps, s, and two indices of each row in order of time. They
    are those of the step before the row, and of the row's output in ``measured``."""
    measured: Index
    """Indices of the measured outputs."""
    floor: FloatArray
    """Shape (o,): least white noise of each output."""

    @property
    def columns(self) -> FloatArray:
        """Shape (N, k): residual, sensitivities to each manoeuvre's parameters and to the common ones, and to
        servos and clocks."""
        own, common = self.sensitivities[:, self.assembly.own], self.sensitivities[:, self.assembly.common]
        return np.column_stack([self.residual, own, common, self.extra.columns])

    def whitened(self, columns: FloatArray, noise: Noise, newest: int = 0) -> tuple[FloatArray, float]:
        """Return the whitened ``columns`` (N, k) and the log determinant, of the ``newest`` manoeuvres or of
        all. Rows of other manoeuvres stay zero."""
        white, volume = np.zeros(columns.shape), 0.0
        measured = self.measured
        instruments = np.maximum(noise.white, self.floor)[measured], noise.coloured[measured], noise.memory_s
        for motion, order, steps in list(zip(self.motions, self.orders, self.steps, strict=True))[-newest:]:
            s = len(motion.matrix)
            matrix = np.zeros((s + 1, s + 1))
            matrix[:s, :s], matrix[:s, s], matrix[s, s] = (
                motion.matrix,
                motion.air,
                -1.0 / noise.gust_memory_s,
            )
            begun, drive = np.zeros(s + 1), np.zeros(s + 1)
            begun[s], drive[s] = noise.gust**2, 2.0 * noise.gust**2 / noise.gust_memory_s
            drive[motion.forced] = noise.drive**2
            white[order], own = driven_filter(
                *steps,
                matrix,
                np.column_stack([motion.seen, motion.air_seen])[measured],
                begun,
                drive,
                *instruments,
                np.ascontiguousarray(columns[order]),
            )
            volume += own
        return white, volume

    def cost(self, noise: Noise, newest: int = 0) -> float:
        """Return -2 log likelihood of the residual, up to a constant."""
        white, volume = self.whitened(self.residual[:, None], noise, newest)
        return volume + float(np.sum(white**2))


@dataclass(frozen=True, slots=True)
class Model:
    """An axis' motion with the parameters that a search moves."""

    motion: DrivenMotion
    parameters: Sequence[Parameter]
    """Servos and clocks that are estimated with the derivatives."""
    priors: Callable[[Any, FloatArray], Priors]
    """Function that returns the priors of the derivatives for a problem and shared parameters."""

    def prior(self, setting: Setting) -> Priors:
        """Return the priors of the derivatives at a setting."""
        return self.priors(setting.problem, setting.shared)

    def at(self, problem: Any, shared: FloatArray, local: FloatArray) -> Setting | None:
        """Return a setting of all parameters; None on numerical overflow."""
        laid = self.motion.laid(problem)
        response = self.motion.respond(problem, laid, shared, local, self.parameters)
        if response is None:
            return None
        measured = np.unique(laid.channel)
        orders = [rows.start + np.argsort(laid.t[rows], kind="stable") for rows in laid.blocks]
        return Setting(
            problem,
            laid,
            shared,
            local,
            laid.z - response.y,
            response.g,
            Extra.of(response.columns(), problem, self.parameters),
            [self.motion.linear(problem, shared, m) for m in range(laid.maneuvers)],
            orders,
            [(*_distinct(laid.t[order]), np.searchsorted(measured, laid.channel[order])) for order in orders],
            measured,
            _floor(laid, response.y),
        )


def _floor(laid: Laid, y: FloatArray) -> FloatArray:
    """Return the least white noise of each output, shape (o,): its change within the error of a stamp."""
    floor = np.full(len(laid.names.outputs), RANGE[0])
    for c in np.unique(laid.channel):
        parts = [rows for named in laid.rows if (rows := named.get(laid.names.outputs[c])) is not None]
        pace = np.concatenate(
            [np.diff(y[rows]) / np.maximum(np.diff(laid.t[rows]), STAMP_S) for rows in parts]
        )
        floor[c] = max(floor[c], STAMP_S * float(np.sqrt(np.mean(pace**2))) if len(pace) else 0.0)
    return floor


def _distinct(t: FloatArray) -> tuple[FloatArray, Index]:
    """Return the distinct lengths (u,) of the steps between times, and the index (n,) of the step before each
    time."""
    lengths, kind = np.unique(np.rint(np.diff(t, prepend=t[0]) / _GRID_S), return_inverse=True)
    return lengths * _GRID_S, kind.astype(np.int64)
