"""Residuals, sensitivities, noise and linear motions of a problem at one setting of all parameters."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple, Protocol, Self

import numpy as np

from advisor.model.response import Index
from advisor.oem.descent import Motion
from advisor.oem.driven_motion.kalman_filter import Gains, driven_filter, filtered_by_each, steps_of
from advisor.oem.extra import Extra, Parameter
from advisor.oem.prior import Priors
from advisor.oem.rows import Laid
from advisor.process.arrays import FloatArray


class Linear(NamedTuple):
    """Linearisation of a fitted motion with s states and o outputs."""

    matrix: FloatArray
    """Shape (s, s): rates of the states by the states."""
    seen: FloatArray
    """Shape (o, s): outputs by the states."""
    air: FloatArray
    """Shape (s,): rates of the states by the gust's angle of incidence, 1/s."""
    air_seen: FloatArray
    """Shape (o,): outputs by the gust's angle of incidence."""
    forced: Index
    """Indices of the states whose rates contain a force."""

    @property
    def all_seen(self) -> FloatArray:
        """Shape (o, s + 1): outputs by the states and by the gust's angle."""
        return np.column_stack([self.seen, self.air_seen])


class DrivenMotion(Motion, Protocol):
    """Interface of an axis whose motion unknown forces drive."""

    def linear(self, problem: Any, shared: FloatArray, m: int, /) -> Linear:
        """Return the linear motion of manoeuvre ``m`` at its mean air speed."""

    def unsure(self, laid: Any, y: FloatArray, /) -> FloatArray:
        """Return the change (N, k) of the outputs ``y`` by a standard deviation of each instrument quantity
        that is not estimated."""


RANGE = (1e-12, 1e3)
"""Range of every noise parameter, SI. Without a lower bound the likelihood of data without noise has no
maximum."""
_MEMORY_S, _GUST_MEMORY_S = (0.05, 5.0), (0.5, 5.0)
"""Ranges of the correlation times of coloured noise and of gusts, s. Dryden's lengths are 20 to 600 m near
the ground, and aircraft pass them at 20 to 130 m/s."""
GUST, MEMORY, GUST_MEMORY = -3, -2, -1
"""Indices of the gust and of both correlation times among the logarithms."""
LEAST_GUST_RAD = 0.0017
"""Least standard deviation of a reported gust angle, rad: 0.1 deg."""


@dataclass(frozen=True, slots=True)
class Noise:
    """Noise of the instruments and forces on the motion, as standard deviations and intensities, SI."""

    white: FloatArray
    """Shape (o,): white noise of each output."""
    coloured: FloatArray
    """Shape (o,): coloured noise of each output."""
    memory_s: float
    """Correlation time of the coloured noise, s."""
    drive: FloatArray
    """Shape (f,): root of the intensity of the white noise on each forced rate; (1,) for equal ones."""
    gust: float
    """Standard deviation of the gust's angle of incidence, rad."""
    gust_memory_s: float
    """Correlation time of the gust's angle, s."""

    @classmethod
    def still(cls, white: FloatArray) -> Self:
        """Return white noise of the instruments, shape (o,), without forces and gusts."""
        return cls(white, np.full(len(white), RANGE[0]), 0.3, np.array([RANGE[0]]), 0.0, 1.0)

    @property
    def logarithms(self) -> FloatArray:
        """Shape (2·o + f + 3,): logarithms of all parameters."""
        every = [*self.white, *self.coloured, *self.drive, self.gust, self.memory_s, self.gust_memory_s]
        return np.asarray(np.clip(np.log(np.maximum(every, RANGE[0])), *self.limits))

    @property
    def limits(self) -> FloatArray:
        """Shape (2, 2·o + f + 3): least and largest logarithms."""
        sizes = 2 * len(self.white) + len(self.drive) + 1
        return np.asarray(np.log(np.array([*[RANGE] * sizes, _MEMORY_S, _GUST_MEMORY_S])).T)

    def at(self, logarithms: FloatArray) -> "Noise":
        """Return the noise with other parameters, each within its range."""
        o, values = len(self.white), np.exp(np.clip(logarithms, *self.limits))
        memories = float(values[-2]), float(values[-1])
        return Noise(
            values[:o], values[o : 2 * o], memories[0], values[2 * o : -3], float(values[-3]), memories[1]
        )

    def driving(
        self, motion: Linear, start_variance: float = 0.0
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return rates, variances at the start and driving intensities of s states and of the gust's angle.

        The rates are by the states and by the gust's angle, shape (s + 1, s + 1); the others have (s + 1,).
        Every state has the variance ``start_variance`` at the start.
        """
        s = len(motion.matrix)
        matrix, begun, drive = np.zeros((s + 1, s + 1)), np.zeros(s + 1), np.zeros(s + 1)
        matrix[:s, :s], matrix[:s, s], matrix[s, s] = motion.matrix, motion.air, -1.0 / self.gust_memory_s
        begun[:s] = start_variance
        begun[s], drive[s] = self.gust**2, 2.0 * self.gust**2 / self.gust_memory_s
        drive[motion.forced] = self.drive**2
        return matrix, begun, drive


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
