"""Manoeuvres prepared for the diagnosis: the command, slow inputs on a grid, and outputs at their stamps."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.gap.simulator.layout import ALPHA_TRIM, REFERENCE, SCALED, SPEED
from advisor.oem.rows import Signal
from advisor.process.arrays import FloatArray

_QUIET_AFTER = 0.6
"""Record: share of the free response after which the motion has decayed."""
_QUIET_AFTER_S = 1.5
"""Record: least time in s after the last step before the motion has decayed. A mode change may cut the free
response short."""


@dataclass(frozen=True, slots=True)
class PreparedManeuver:
    """One manoeuvre prepared for the diagnosis. Times are relative to the start of its record."""

    number: int
    started_s: float
    """Vehicle time of the start of the record, s."""
    first_step_s: float
    last_step_s: float
    h: float
    n: int
    t_u: FloatArray
    t_held: FloatArray
    """Time after which each command value was held: its stamp, or the middle of the lost stamps before it."""
    u: FloatArray
    """Elevator command at its stamps, rad."""
    before: Signal
    """Elevator command before the record, which still moves the servo at its begin, rad."""
    u_trim: float
    slow: FloatArray
    """Shape (8, n) on the grid: speed, a_x, bank, throttle, height, (thrust − drag)/weight and r sin φ. The
    last row is the rate of α by rolling in sideslip."""
    trim: FloatArray
    """Shape (4,): initial α and θ, reference speed, and 1 where derivatives scale with the air speed."""
    outputs: Mapping[str, Signal]
    """Measurements of each output channel, in seconds since the start of the record."""
    edges: FloatArray
    """Shape (m, 4). Edges of the command: middle of the interval between stamps (s), jump times length (rad
    s), length (s), lost part (s)."""
    stamps: FloatArray = field(default_factory=lambda: np.empty(0))
    """Shape (rows,): stamps of all compared outputs, one channel after another."""
    output: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    """Shape (rows,), int64: index of each row's output in ``OUTPUTS``."""
    speed_error_factor: FloatArray = field(default_factory=lambda: np.empty((0, 0)))
    """Factor of the covariance of the air speed's error, m/s: shape (3, 3) from
    ``airspeed.speed_error_factors``, (1, 1) for the level alone, (0, 0) where unknown."""

    def command(self, held: bool) -> Signal:
        """Return the elevator command with its samples before the record; ``held`` between its stamps?"""
        return Signal(self.t_held if held else self.t_u, self.u).after(self.before)

    @property
    def alpha_trim(self) -> float:
        """Angle of attack at the start, rad."""
        return float(self.trim[ALPHA_TRIM])

    @property
    def reference_m_s(self) -> float:
        """Air speed to which the derivatives refer, m/s."""
        return float(self.trim[REFERENCE])

    @property
    def level_lift(self) -> float:
        """Trim term of Eq. (1) for level flight at the mean speed, at the reference speed."""
        return -GRAVITY_M_S2 * self.reference_m_s / float(np.mean(self.slow[SPEED])) ** 2

    def at_constant_speed(self) -> "PreparedManeuver":
        """Return the manoeuvre with derivatives that do not scale with the air speed."""
        trim = self.trim.copy()
        trim[SCALED] = 0.0
        return replace(self, trim=trim)

    def coarser(self) -> "PreparedManeuver":
        """Return the manoeuvre on a time grid of twice the step."""
        n = (self.n + 1) // 2
        even = np.pad(self.slow, ((0, 0), (0, 2 * n - self.n)), mode="edge")
        return replace(self, h=2.0 * self.h, n=n, slow=even.reshape(len(even), n, 2).mean(axis=2))

    @property
    def duration_s(self) -> float:
        """Length of the record, s."""
        return self.n * self.h

    def is_quiet(self, t: FloatArray) -> np.ndarray:
        """Return whether each time ``t`` lies before the first step or late in the free response, shape
        (n,)."""
        free = self.duration_s - self.last_step_s
        died_down = self.last_step_s + max(_QUIET_AFTER * free, _QUIET_AFTER_S)
        return np.asarray((t < self.first_step_s) | (t > died_down))

    def quiet_stretches(self, channel: str) -> list[FloatArray]:
        """Return the measurements of a channel before the first step and late in the free response."""
        t, y = self.outputs[channel].t, self.outputs[channel].y
        quiet, before = self.is_quiet(t), t < self.first_step_s
        return [y[quiet & before], y[quiet & ~before]]


@dataclass(frozen=True, slots=True)
class PreparedManeuvers:
    """All manoeuvres of a diagnosis, with their common properties."""

    flights: tuple[PreparedManeuver, ...]
    channels: tuple[str, ...]
    """Outputs that every manoeuvre of the diagnosis has."""
    speed_measured: bool
    reference_m_s: float
    speed_moves: float
    """Largest relative deviation of the speed from its mean over all manoeuvres."""
    alpha_is_derived: bool
    """Whether α is an autopilot's estimate from inertial sensors, which does not show gusts."""
    alpha_is_smoothed: bool
    """Whether α was filtered before it was stored. The roughness of a filtered α does not show its noise."""
    has: frozenset[str]
    """Slow channels that all manoeuvres have, such as airspeed, a_x, bank and throttle."""
    white: FloatArray
    """Shape (channels,): standard deviation of the white noise, robust against steps of the motion."""
    peaks: FloatArray
    """Shape (channels,): median over the manoeuvres of the largest departure from the starting value."""
    chord_m: float | None = None
    """Mean chord of the wing, m, from the aircraft file or from the mass; None without both."""

    def __len__(self) -> int:
        return len(self.flights)

    @property
    def shows_air(self) -> bool:
        """Whether the outputs show moving air, by a measured angle of attack or by the specific force."""
        return "alpha" in self.channels or "a_z" in self.channels

    @property
    def telling(self) -> list[int]:
        """Indices of the channels that identify a cause: channels that an instrument measures.

        The error of an autopilot's α estimate depends on the motion, so that estimate identifies no cause.
        """
        return [c for c, name in enumerate(self.channels) if name != "alpha" or not self.alpha_is_derived]
