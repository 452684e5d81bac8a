"""Manoeuvres as the diagnosis compares them: the command, slow inputs on a grid, outputs untouched."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.simulator.layout import ALPHA_TRIM, REFERENCE, SCALED, SPEED
from advisor.standard_gravity import GRAVITY_M_S2

SPEED_CHANGE = 0.03
"""Relative change of air speed from which on it is looked at."""
_QUIET_AFTER = 0.6
"""Share of the free response after which the motion has died down ..."""
_QUIET_AFTER_S = 1.5
"""... but not before this: a mode change may have cut the response short."""


@dataclass(frozen=True, slots=True)
class Measured:
    """One output channel of one manoeuvre."""

    t: FloatArray
    """Shape (n,). Seconds since the record's start."""
    y: FloatArray


@dataclass(frozen=True, slots=True)
class Flight:
    """One manoeuvre made ready. Times count from the start of its record."""

    number: int
    started_s: float
    """Vehicle time of the record's start."""
    first_step_s: float
    last_step_s: float
    h: float
    n: int
    t_u: FloatArray
    t_held: FloatArray
    """From when on each value was held: its stamp, or in the middle of those that were lost before it."""
    u: FloatArray
    """The elevator command at its stamps, rad."""
    u_trim: float
    slow: FloatArray
    """Shape (7, n) on the grid: speed, a_x, bank, throttle, height, thrust less drag over weight, r sin φ."""
    trim: FloatArray
    """Shape (4,): α and θ at the start, reference speed, 1 when derivatives scale with speed."""
    outputs: Mapping[str, Measured]
    edges: FloatArray
    """Shape (m, 4). Jumps of the command: middle of the interval between stamps, jump × length, length, and
    how much of that is for stamps that were lost."""
    stamps: FloatArray = field(default_factory=lambda: np.empty(0))
    """Shape (rows,): times of all outputs that are compared, one channel after another."""
    output: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    """Shape (rows,), int64: index into ``OUTPUTS`` of each row."""
    speed_error_factor: FloatArray = field(default_factory=lambda: np.empty((0, 0)))
    """Shape (3, 3), m/s, as ``airspeed.speed_error_factors`` gives it, or (1, 1) of the level alone; (0, 0) where
    nothing is known of it."""

    roll_rate: FloatArray | None = None
    """Shape (n,) on the grid, rad/s; None where the log has none."""

    @property
    def alpha_trim(self) -> float:
        """Angle of attack at the start, rad."""
        return float(self.trim[ALPHA_TRIM])

    @property
    def level_lift(self) -> float:
        """Trim term of Eq. (1) that carries the weight at the mean speed, given at the reference speed."""
        return -GRAVITY_M_S2 * float(self.trim[REFERENCE]) / float(np.mean(self.slow[SPEED])) ** 2

    def at_constant_speed(self) -> "Flight":
        """The same with derivatives that do not move with the air speed."""
        trim = self.trim.copy()
        trim[SCALED] = 0.0
        return replace(self, trim=trim)

    def coarser(self) -> "Flight":
        """The same on a grid of twice the step."""
        n = (self.n + 1) // 2
        even = np.pad(self.slow, ((0, 0), (0, 2 * n - self.n)), mode="edge")
        return replace(self, h=2.0 * self.h, n=n, slow=even.reshape(len(even), n, 2).mean(axis=2))

    @property
    def duration_s(self) -> float:
        """Length of the record."""
        return self.n * self.h

    def is_quiet(self, t: FloatArray) -> np.ndarray:
        """Shape (n,), bool: which times lie before the first step or late in the free response."""
        free = self.duration_s - self.last_step_s
        died_down = self.last_step_s + max(_QUIET_AFTER * free, _QUIET_AFTER_S)
        return np.asarray((t < self.first_step_s) | (t > died_down))

    def quiet_stretches(self, channel: str) -> list[FloatArray]:
        """What a channel measured before the first step, and late in the free response."""
        t, y = self.outputs[channel].t, self.outputs[channel].y
        quiet, before = self.is_quiet(t), t < self.first_step_s
        return [y[quiet & before], y[quiet & ~before]]


@dataclass(frozen=True, slots=True)
class Flights:
    """All manoeuvres of a diagnosis with what they have in common."""

    flights: tuple[Flight, ...]
    channels: tuple[str, ...]
    """Outputs every manoeuvre has."""
    speed_measured: bool
    reference_m_s: float
    speed_moves: float
    """Largest relative departure of the speed from its mean over all manoeuvres."""
    alpha_is_derived: bool
    """α is an autopilot's estimate from inertial sensors, blind to gusts, not a vane."""
    alpha_is_smoothed: bool
    """α was filtered before it was stored, as an estimate is: its roughness is no measure of its errors."""
    has: frozenset[str]
    """Slow channels that were measured: airspeed (or an instrument that reads nothing), a_x, bank, throttle,
    height, climb_rate."""
    white: FloatArray
    """Shape (channels,): standard deviation of the white part, robust against edges of the motion."""
    peaks: FloatArray
    """Shape (channels,): the largest departure from the starting value, the median over all manoeuvres."""

    def __len__(self) -> int:
        return len(self.flights)

    @property
    def telling(self) -> list[int]:
        """Which of the channels tell a cause by themselves: those that an instrument measured.

        An autopilot's estimate of α is off by what its filter makes of the motion.
        """
        return [c for c, name in enumerate(self.channels) if name != "alpha" or not self.alpha_is_derived]
