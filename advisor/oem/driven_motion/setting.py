"""Residuals, sensitivities and linear motions of a problem at one setting of all parameters."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from advisor.model.response import Index
from advisor.oem.driven_motion.kalman_filter import Gains, driven_filter, filtered_by_each, steps_of
from advisor.oem.driven_motion.linear import DrivenMotion, Linear
from advisor.oem.driven_motion.noise import RANGE, Noise
from advisor.oem.extra import Extra, Parameter
from advisor.oem.prior import Priors
from advisor.oem.rows import Laid
from advisor.process.arrays import FloatArray

STAMP_S = 1e-3 / 12.0**0.5
"""Standard deviation of a stamp in whole milliseconds, s."""


class Record(NamedTuple):
    """Rows of a manoeuvre in order of time, with its linear motion."""

    motion: Linear
    seen: FloatArray
    """Shape (c, s + 1): measured outputs by the states and by the gust's angle."""
    order: Index
    """Indices of the rows among the rows of all manoeuvres."""
    steps: tuple[FloatArray, Index]
    """Distinct lengths of the time steps, s, and the index of the step before each row."""
    channel: Index
    """Index of each row's output in ``measured``."""


@dataclass(frozen=True, slots=True)
class Setting:
    """One setting of all parameters, with its residuals, sensitivities and linear motions."""

    problem: Any
    assembly: Laid
    shared: FloatArray
    local: FloatArray
    residual: FloatArray
    sensitivities: FloatArray
    columns_of: Callable[[], FloatArray]
    """Function that returns the derivatives by servos and clocks. A rejected trial step does not call it."""
    parameters: Sequence[Parameter]
    records: Sequence[Record]
    measured: Index
    """Indices of the measured outputs."""
    floor: FloatArray
    """Shape (o,): least white noise of each output."""

    @property
    def extra(self) -> Extra:
        """Servos and clocks at their present values."""
        return Extra.of(self.columns_of(), self.problem, self.parameters)

    @property
    def penalty(self) -> float:
        """-2 log of the density of the priors of servos and clocks, up to a constant."""
        return Extra.of(np.empty((0, 0)), self.problem, self.parameters).penalty

    @property
    def columns(self) -> FloatArray:
        """Shape (N, k): residual, sensitivities to each manoeuvre's parameters and to the common ones, and to
        servos and clocks."""
        own, common = self.sensitivities[:, self.assembly.own], self.sensitivities[:, self.assembly.common]
        return np.column_stack([self.residual, own, common, self.extra.columns])

    def gains(self, record: Record, noise: Noise) -> Gains:
        """Return the Kalman gains of a record's rows in order of time."""
        white = np.maximum(noise.white, self.floor)[self.measured] ** 2
        at = record.steps, record.channel, record.seen, noise.driving(record.motion)
        return driven_filter(*at, white[record.channel], noise.coloured[self.measured], noise.memory_s)

    def whitened(self, columns: FloatArray, noise: Noise) -> tuple[FloatArray, float]:
        """Return the whitened ``columns`` (N, k) and the log determinant."""
        out, volume = np.empty(columns.shape), 0.0
        for record in self.records:
            gains = self.gains(record, noise)
            out[record.order] = gains.innovations(columns[record.order])
            volume += 2.0 * float(np.sum(np.log(gains.std)))
        return out, volume

    def terms(self, noises: Sequence[Noise], newest: int = 0) -> tuple[FloatArray, FloatArray]:
        """Return the whitened residual and the log variance of its innovations with each noise, (n, k) both.

        Only the ``newest`` manoeuvres count; 0 means all.
        """
        white = np.maximum([noise.white for noise in noises], self.floor)[:, self.measured] ** 2
        coloured = np.array([noise.coloured for noise in noises])[:, self.measured]
        memory_s, parts = np.array([noise.memory_s for noise in noises]), []
        for record in self.records[-newest:]:
            at = record.steps, record.channel, record.seen, [noise.driving(record.motion) for noise in noises]
            parts.append(filtered_by_each(*at, white, coloured, memory_s, self.residual[record.order]))
        out, std = np.concatenate(parts, axis=1)
        return out, 2.0 * np.log(std)

    def cost(self, noise: Noise, newest: int = 0) -> float:
        """Return -2 log likelihood of the residual, up to a constant."""
        white, volume = self.terms([noise], newest)
        return float(np.sum(volume) + np.sum(white**2))


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
        records, measured = records_of(self.motion, problem, laid, shared)
        return Setting(
            problem,
            laid,
            shared,
            local,
            laid.z - response.y,
            response.g,
            cache(response.columns),
            self.parameters,
            records,
            measured,
            _floor(laid, response.y),
        )


def records_of(
    motion: DrivenMotion, problem: Any, laid: Laid, shared: FloatArray
) -> tuple[list[Record], Index]:
    """Return the rows of each manoeuvre in order of time, and the indices of the measured outputs."""
    measured, records = np.unique(laid.channel), []
    for m, rows in enumerate(laid.blocks):
        linear = motion.linear(problem, shared, m)
        order = rows.start + np.argsort(laid.t[rows], kind="stable")
        channel = np.searchsorted(measured, laid.channel[order])
        records.append(Record(linear, linear.all_seen[measured], order, steps_of(laid.t[order]), channel))
    return records, measured


def _floor(laid: Laid, y: FloatArray) -> FloatArray:
    """Return the least white noise of each output, shape (o,): the output's change within the error of a
    stamp.
    """
    floor = np.full(len(laid.names.outputs), RANGE[0])
    for c in np.unique(laid.channel):
        parts = [rows for named in laid.rows if (rows := named.get(laid.names.outputs[c])) is not None]
        pace = np.concatenate(
            [np.diff(y[rows]) / np.maximum(np.diff(laid.t[rows]), STAMP_S) for rows in parts]
        )
        floor[c] = max(floor[c], STAMP_S * float(np.sqrt(np.mean(pace**2))) if len(pace) else 0.0)
    return floor
