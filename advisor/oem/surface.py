"""From elevator command to surface: a servo with delay and first-order lag, exact for a linear command.

    τ·δ̇ = u(t - T) - δ

A command that is linear between its stamps gives δ(t + h) = u₁ - τ·u̇ + (δ(t) - u₀ + τ·u̇)·exp(-h/τ), so the
surface is exact at every stamp of the grid. Between two stamps the surface is taken as linear. The grid is
fine enough for an error of about 0.1 % of a step's height at a lag of 0.1 s.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.model.input_response import InputChange
from advisor.oem.lag import lag_changes, lagged
from advisor.oem.rows import Signal, padded
from advisor.process.arrays import FloatArray

LONGEST_STEP_S = 0.0105


@dataclass(frozen=True, slots=True)
class Servo:
    """Servo between command and surface, by default without delay and lag."""

    lag_s: float = 0.0
    delay_s: float = 0.0

    def grid(self, command_t: FloatArray) -> tuple[FloatArray, float]:
        """Return the times of corners in the surface's motion, and the longest step that resolves the
        motion."""
        return command_t + self.delay_s, LONGEST_STEP_S if self.lag_s > 0.0 else np.inf

    def move(
        self, command_t: FloatArray, command: FloatArray, t: FloatArray, held: bool = False
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the surface position at the stamps ``t`` (E,), which must contain the command's corners.

        Returns
        -------
        at the stamps (E,), just after the stamps (E,), and just before the next stamp (E - 1,);
        these differ only where a held command jumps.
        """
        run, start, arrival = self._driven(command_t, command, t, held)
        if self.lag_s <= 0.0:
            return start, start, arrival
        surface = lagged(np.diff(run), start[:-1], arrival, self.lag_s, start[0])[len(run) - len(t) :]
        return surface, surface, surface[1:]

    def signal(self, command: Signal) -> Signal:
        """Return the surface after a linear command, at the corners of its motion."""
        t, pace = self.grid(command.t)
        if not np.isfinite(pace) or len(t) < 2:
            return Signal(t, command.y)
        fine = np.union1d(t, np.arange(t[0], t[-1], pace))
        return Signal(fine, self.move(command.t, command.y, fine)[0])

    def course(
        self, command_t: FloatArray, command: FloatArray, t: FloatArray, held: bool = False
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the surface at the stamps and just after them, and its rates, each (E,), as ``move``
        does."""
        at, start, arrival = self.move(command_t, command, t, held)
        return at, start, padded((arrival - start[:-1]) / np.diff(t))

    def changes(
        self,
        command_t: FloatArray,
        command: FloatArray,
        t: FloatArray,
        held: bool = False,
        intervals: Sequence[int] | None = None,
    ) -> InputChange:
        """Return the derivatives of the surface by the delay and by the lag, as two columns.

        The derivative by the delay is minus the command's rate, filtered by the servo. The derivative by the
        lag is minus the surface's rate, lagged once more. The other arguments are those of ``move``.

        Parameters
        ----------
        intervals
            Indices of the command's intervals that are delayed, from 0. None for all parameters.
        """
        run, start, arrival = self._driven(command_t, command, t, held)
        step = np.diff(run)
        rate, jump = (arrival - start[:-1]) / step, np.append(0.0, start[1:] - arrival)
        if intervals is not None:
            interval = np.searchsorted(command_t + self.delay_s, run[:-1] + step / 2.0) - 1
            rate = np.where(np.isin(interval, intervals), rate, 0.0)
        if self.lag_s <= 0.0:
            late = np.column_stack([-rate, -rate])
            return _change(late, late, step, -jump)
        begin, end, slower = lag_changes(step, rate, jump, self.lag_s)
        first = len(run) - len(t)
        start, arrival = (
            np.column_stack([begin, slower])[first:-1],
            np.column_stack([end, slower])[first + 1 :],
        )
        return _change(start, arrival, step[first:], np.zeros(len(t)))

    def _driven(
        self, command_t: FloatArray, command: FloatArray, t: FloatArray, held: bool
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the stamps of the servo's run (n,), and the command after (n,) and before the next stamp (n
        - 1,).

        A servo with a lag rests at the first known command, where its run starts. The run ends with ``t``.
        """
        stamps = command_t + self.delay_s
        if held:
            before = command[np.clip(np.searchsorted(stamps, t - 1e-9) - 1, 0, len(command) - 1)]
            after = command[np.clip(np.searchsorted(stamps, t + 1e-9) - 1, 0, len(command) - 1)]
        else:
            before = after = np.interp(t, stamps, command)
        if self.lag_s <= 0.0:
            return t, after, before[1:]
        early = stamps[stamps < t[0] - 1e-9]
        start = np.concatenate([command[: len(early)], after])
        arrival = np.concatenate([command[: len(early)], before])[1:] if held else start[1:]
        return np.concatenate([early, t]), start, arrival


def _change(start: FloatArray, arrival: FloatArray, step: FloatArray, impulse: FloatArray) -> InputChange:
    """Return changes of the surface from ``start`` to ``arrival`` (n, k) in n steps, with impulses (n +
    1,)."""
    after, before = np.concatenate([start, arrival[-1:]]), np.concatenate([start[:1], arrival])
    slope = padded((arrival - start) / step[:, None])
    return InputChange(
        (after + before) / 2.0, after, slope, np.repeat(impulse[:, None], start.shape[1], axis=1)
    )
