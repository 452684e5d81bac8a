"""What an input looks like once it has been recognised."""

from dataclasses import dataclass
from itertools import pairwise

from advisor.flight.maneuver import InputKind

BAND = 0.3
"""Within this share of the amplitude the elevator counts as at trim."""


@dataclass(frozen=True, slots=True)
class Shape:
    """An input that was recognised."""

    kind: InputKind
    start_s: float
    """The elevator leaves trim."""
    last_step_s: float
    """The elevator sets out on its way back to trim for the last time."""
    over_s: float
    """The elevator is back at trim."""
    trim: float
    """Level before and after, rad."""
    amplitude: float
    """Largest deviation from trim, rad."""
    quiet: float
    """Standard deviation at trim, before the input, rad."""
    steps: tuple[tuple[float, float], ...]
    """(onset s, level in rad from trim), the return to trim last."""

    @property
    def longest_s(self) -> float:
        """Duration of the longest step."""
        return max(b[0] - a[0] for a, b in pairwise(self.steps))

    @property
    def band(self) -> float:
        """Deviation from trim that would be a new input, rad."""
        share = BAND if self.is_3211 else 0.7 * BAND
        return max(share * self.amplitude, min(4.0 * self.quiet, 0.45 * self.amplitude))

    @property
    def is_3211(self) -> bool:
        """The pattern that by its timing alone cannot be mistaken for a correction."""
        return is_3211(self.kind)


def is_3211(kind: InputKind) -> bool:
    """Whether this is a 3-2-1-1 or its reverse."""
    return kind in ("3-2-1-1", "reverse 3-2-1-1")
