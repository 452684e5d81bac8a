"""From elevator command to surface: a servo's delay and first-order lag, exact for a linear command.

    τ·δ̇ = u(t - T) - δ

A command that is linear between its stamps gives δ(t + h) = u₁ - τ·u̇ + (δ(t) - u₀ + τ·u̇)·exp(-h/τ), so the
surface is exact at every stamp of the grid. Between two stamps it is taken as linear. The grid is fine enough
for an error of about 0.1 % of a step's height at a lag of 0.1 s.
"""

from dataclasses import dataclass

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.process.compiled import kernel

LONGEST_STEP_S = 0.0105


@dataclass(frozen=True, slots=True)
class Servo:
    """The servo between command and surface; by default it has neither delay nor lag."""

    lag_s: float = 0.0
    delay_s: float = 0.0

    def grid(self, command_t: FloatArray) -> tuple[FloatArray, float]:
        """Return the times of corners in the surface's motion, and the longest step that follows the
        motion."""
        return command_t + self.delay_s, LONGEST_STEP_S if self.lag_s > 0.0 else np.inf

    def move(
        self, command_t: FloatArray, command: FloatArray, t: FloatArray, held: bool = False
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the surface position at the grid ``t`` (E,), which must contain the command's corners.

        Returns
        -------
        at the stamps (E,), just after the stamps (E,), and just before the next stamp (E - 1,);
        these differ only where a held command jumps.
        """
        stamps = command_t + self.delay_s
        if held:
            before = command[np.clip(np.searchsorted(stamps, t - 1e-9) - 1, 0, len(command) - 1)]
            after = command[np.clip(np.searchsorted(stamps, t + 1e-9) - 1, 0, len(command) - 1)]
        else:
            before = after = np.interp(t, stamps, command)
        if self.lag_s <= 0.0:
            return after, after, before[1:]
        # The servo is at rest at the first known command, where the recursion starts.
        early = stamps[stamps < t[0] - 1e-9]
        run = np.concatenate([early, t])
        if held:
            start = np.concatenate([command[: len(early)], after])
            arrival = np.concatenate([command[: len(early)], before])[1:]
        else:
            start = np.concatenate([command[: len(early)], after])
            arrival = start[1:]
        surface = lagged(np.diff(run), start[:-1], arrival, self.lag_s, start[0])[len(early) :]
        return surface, surface, surface[1:]


@kernel()
def lagged(
    step: FloatArray, start: FloatArray, arrival: FloatArray, lag: float, initial: float
) -> FloatArray:
    """Return the first-order lag of a command that moves linearly from ``start`` to ``arrival`` in each
    ``step``."""
    surface = np.empty(len(step) + 1)
    surface[0] = initial
    for i in range(len(step)):
        trailing = lag * (arrival[i] - start[i]) / step[i]
        surface[i + 1] = arrival[i] - trailing + (surface[i] - start[i] + trailing) * np.exp(-step[i] / lag)
    return surface
