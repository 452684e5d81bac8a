"""Source of a screen's data: a link, a log or a demonstration behind one narrow protocol."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import nan
from typing import Literal, Protocol, runtime_checkable

from advisor.campaign.hand_decisions import ByHand
from advisor.flight.signals.messages import Columns
from advisor.mavlink.link.health import LinkStatistics
from advisor.session.behind import backlog_s, behind_sentence

Condition = Literal["good", "poor", "waiting", "lost", "stale", "ended"]
"""State of the data's arrival. Stale: a process of the advisor does not answer; all shown is old."""


@dataclass(frozen=True, slots=True)
class LinkHealth:
    """State of the data's arrival, for a glance and for a close look."""

    condition: Condition
    sentence: str
    """Sentence on the fault and its remedy, or on the sound state."""
    figures: tuple[tuple[str, str], ...] = ()
    """Statistics for the engineer: (name, value with unit)."""
    alarm: str = ""
    """Sentence on data that are lost at this moment; empty while none are."""
    recording: str = ""
    """State of the recording with its size and the free disk; empty for a log."""
    link: LinkStatistics | None = None
    """Counts of the link. None for a log, and before the link is open."""
    read_to_s: float = nan
    """Host time of the newest record that the campaign was given, seconds since 1970."""

    @property
    def behind_s(self) -> float:
        """Time by which everything that is judged is older than the newest record of the link, s."""
        return backlog_s(self.link, self.read_to_s) if self.link is not None else 0.0

    @property
    def behind(self) -> str:
        """Sentence on a backlog that the crew must know; empty without one."""
        return behind_sentence(self.behind_s)


@dataclass(frozen=True, slots=True)
class LinkRequest:
    """A crew's request to the link."""

    what: Literal["follow", "outputs", "take"]
    """Follow another vehicle; ask once for the elevator's output; or use an output as the elevator."""
    number: int = 0
    """System id of the vehicle to follow, or number of the output."""


class Source(Protocol):
    """Delivers batches of columns in order of arrival. All calls except ``health`` come from one thread."""

    def read(self, timeout_s: float) -> Sequence[Columns] | None:
        """Wait at most ``timeout_s`` for the next batch; return an empty one so far, or None at the end.

        Raises
        ------
        UnusableInputError
            The input can never serve. The message names the remedy.
        """

    def health(self) -> LinkHealth:
        """Return the state of the data's arrival. Any thread may call."""

    def take_notices(self) -> Sequence[str]:
        """Return the notices since the last call: reconnected, rates granted, a second vehicle."""

    def order(self, order: LinkRequest) -> None:
        """Carry out a crew's request to the link. Other sources do nothing."""

    def keep(self, by_hand: ByHand) -> str:
        """Keep the decisions by hand with the data; return a sentence on the place or the failure."""

    def close(self) -> None:
        """Release sockets and files."""


@dataclass(frozen=True, slots=True)
class Tempo:
    """Tempo of a replay."""

    paused: bool = False
    speed: float = 1.0
    """Multiple of the flight's own speed. Infinite: as fast as possible."""


@dataclass(frozen=True, slots=True)
class Playback:
    """Position of a replay."""

    position_s: float
    """Time since the first record with silences shortened, s."""
    duration_s: float
    """Length of the replay on that scale, s."""
    hurrying: bool = False
    """Whether the replay is playing to a position as fast as possible."""


@runtime_checkable
class Playable(Source, Protocol):
    """A source that can be paused, stepped, sped up and started again."""

    def playback(self) -> Playback:
        """Return the position of the replay."""

    def play(self, tempo: Tempo) -> None:
        """Change the tempo. Any thread may call."""

    def step(self) -> None:
        """Deliver the next tenth of a second while paused. Any thread may call."""

    def hurry(self, hurrying: bool) -> None:
        """Play as fast as possible, paused or not. Afterwards the tempo holds again."""

    def rewind(self) -> None:
        """Start again with the first record. The caller starts a new campaign."""
