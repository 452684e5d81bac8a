"""Where a screen's data come from: a link, a log, a demonstration - one narrow protocol for all."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Protocol, runtime_checkable

from advisor.flight.messages import Columns

Condition = Literal["good", "poor", "waiting", "lost", "ended"]


@dataclass(frozen=True, slots=True)
class LinkHealth:
    """How the data arrive, for a glance and for a close look."""

    condition: Condition
    sentence: str
    """What is wrong and what to do; or what is right."""
    figures: tuple[tuple[str, str], ...] = ()
    """Statistics for the engineer: (name, value with unit)."""


class Source(Protocol):
    """Delivers batches of columns in order of arrival. All calls but ``health`` come from one thread."""

    @property
    def title(self) -> str:
        """What it is, for the status line: ``udpin:0.0.0.0:14550``, ``flight7.tlog``."""

    def read(self, timeout_s: float) -> Sequence[Columns] | None:
        """Wait at most ``timeout_s`` for the next batch; empty: nothing yet; None: the end.

        Raises
        ------
        UnusableInputError
            When the input can never serve; the message says how to mend it.
        """

    def health(self) -> LinkHealth:
        """How the data arrive at this moment; any thread may ask."""

    def take_notices(self) -> Sequence[str]:
        """What happened on the way since the last call: reconnected, rates granted, a second vehicle."""

    def close(self) -> None:
        """Release sockets and files."""


@dataclass(frozen=True, slots=True)
class Playback:
    """Where a replay stands."""

    paused: bool
    speed: float
    """1: as it was flown; infinite: as fast as it can."""
    position_s: float
    """Seconds since the first record, silences shortened."""
    duration_s: float
    """Length on the same scale."""


@runtime_checkable
class Playable(Source, Protocol):
    """A source that can be paused, stepped, sped up and started again. Any thread may call."""

    def playback(self) -> Playback:
        """Where it stands."""

    def pause(self, paused: bool) -> None:
        """Hold or go on."""

    def set_speed(self, speed: float) -> None:
        """Multiple of real time, above 0; infinite: as fast as it can."""

    def step(self) -> None:
        """While paused: deliver the next tenth of a second."""

    def rewind(self) -> None:
        """Start again with the first record; the caller starts a new campaign."""
