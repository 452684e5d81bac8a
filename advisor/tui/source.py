"""Where a screen's data come from: a link, a log, a demonstration - one narrow protocol for all."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Protocol, runtime_checkable

from advisor.campaign.hand_decisions import ByHand
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
    alarm: str = ""
    """What is being lost at this moment; empty while nothing is."""


@dataclass(frozen=True, slots=True)
class Order:
    """Something a crew wants of the link."""

    what: Literal["follow", "outputs", "take"]
    """Follow another vehicle; ask the vehicle once which output is its elevator; take an output for it."""
    number: int = 0
    """System id of the vehicle to follow, or number of the output to take."""


class Source(Protocol):
    """Delivers batches of columns in order of arrival. All calls but ``health`` come from one thread."""

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

    def order(self, order: Order) -> None:
        """Do what a crew wants of the link; what is no link has nothing to do."""

    def keep(self, by_hand: ByHand) -> str:
        """Keep what was decided by hand with the data; a sentence says where, or why not."""

    def close(self) -> None:
        """Release sockets and files."""


@dataclass(frozen=True, slots=True)
class Tempo:
    """How the crew wants a replay to run."""

    paused: bool = False
    speed: float = 1.0
    """1: as it was flown; infinite: as fast as it can."""


@dataclass(frozen=True, slots=True)
class Playback:
    """Where a replay stands."""

    position_s: float
    """Seconds since the first record, silences shortened."""
    duration_s: float
    """Length on the same scale."""
    hurrying: bool = False
    """On the way to where someone wants it to be, whatever its tempo."""


@runtime_checkable
class Playable(Source, Protocol):
    """A source that can be paused, stepped, sped up and started again."""

    def playback(self) -> Playback:
        """Where it stands."""

    def play(self, tempo: Tempo) -> None:
        """Change the tempo; any thread may call."""

    def step(self) -> None:
        """While paused: deliver the next tenth of a second; any thread may call."""

    def hurry(self, hurrying: bool) -> None:
        """Play as fast as it can, paused or not; afterwards the tempo holds again."""

    def rewind(self) -> None:
        """Start again with the first record; the caller starts a new campaign."""
