"""Interface of all sources of a screen's data: a link, a log or a demonstration."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import nan
from typing import Literal, Protocol

from advisor.campaign.hand_decisions import ByHand
from advisor.flight.signals.messages import Columns
from advisor.mavlink.link.health import LinkStatistics
from advisor.session.behind import backlog_s, behind_sentence

Condition = Literal["good", "poor", "waiting", "lost", "stale", "ended"]
"""State of the arriving data. Stale: a process of the advisor does not answer, and all displayed data are
old."""


@dataclass(frozen=True, slots=True)
class LinkHealth:
    """State of the arriving data, in one word and in detail."""

    condition: Condition
    sentence: str
    """Sentence on the fault and its remedy, or on the faultless state."""
    figures: tuple[tuple[str, str], ...] = ()
    """Link statistics for the engineer: (name, value with unit)."""
    alarm: str = ""
    """Sentence on data that are being lost at this moment; empty if none are."""
    recording: str = ""
    """State of the recording with its size and the free disk space; empty for a log."""
    link: LinkStatistics | None = None
    """Statistics of the link. None for a log, and before the link is open."""
    read_to_s: float = nan
    """Host time of the newest record that the campaign received, seconds since 1970."""

    @property
    def behind_s(self) -> float:
        """Time between the newest judged record and the newest record of the link, s."""
        return backlog_s(self.link, self.read_to_s) if self.link is not None else 0.0

    @property
    def behind(self) -> str:
        """Sentence on a backlog that the crew must know; empty without such a backlog."""
        return behind_sentence(self.behind_s)


@dataclass(frozen=True, slots=True)
class LinkRequest:
    """A crew's request to the link."""

    what: Literal["follow", "outputs", "take"]
    """Kind of request: read another vehicle, ask for the elevator's output, or use an output as the
    elevator."""
    number: int = 0
    """System id of the vehicle to read, or number of the output."""


class Source(Protocol):
    """Delivers batches of columns in order of arrival. All calls except ``health`` come from one thread."""

    def read(self, timeout_s: float) -> Sequence[Columns] | None:
        """Wait at most ``timeout_s`` for the next batch; return an empty batch after that, or None at the
        end.

        Raises
        ------
        UnusableInputError
            The input can never be used. The message names the remedy.
        """

    def health(self) -> LinkHealth:
        """Return the state of the arriving data. Any thread may call."""

    def take_notices(self) -> Sequence[str]:
        """Return the notices since the last call: reconnected, rates granted, a second vehicle."""

    def order(self, order: LinkRequest) -> None:
        """Carry out a crew's request to the link. Sources without a link do nothing."""

    def keep(self, by_hand: ByHand) -> str:
        """Store the decisions by hand with the data; return a sentence on the file or the failure."""

    def close(self) -> None:
        """Release sockets and files."""


@dataclass(frozen=True, slots=True)
class Tempo:
    """Tempo of a replay."""

    paused: bool = False
    speed: float = 1.0
    """Multiple of real time. Infinite: as fast as possible."""


@dataclass(frozen=True, slots=True)
class Playback:
    """Position of a replay."""

    position_s: float
    """Time since the first record with silences shortened, s."""
    duration_s: float
    """Length of the replay with silences shortened, s."""
    hurrying: bool = False
    """Whether the replay is playing to a position as fast as possible."""
