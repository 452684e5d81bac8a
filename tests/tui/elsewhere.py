"""What the tests let run in a process of its own, where it must be found by its name.

The estimator and the readers of logs take a second to import: only what uses them imports them.
"""

import os
import signal
import time
from collections.abc import Sequence
from dataclasses import replace
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.state import NOTHING, ByHand
from advisor.flight.signals.messages import Columns
from advisor.session.conducting import LinkHealth
from advisor.session.replay import LogPlayer
from advisor.words.problems import UnusableInputError
from tests.tui import flights
from tests.tui.stand_ins import HandFedSource, StagedCampaign

if TYPE_CHECKING:
    from advisor.campaign.campaign import Campaign, CampaignEvent

LOG = Path(__file__).parents[2] / "logs" / "bundled-demo.tlog"
FIRST_JUDGED_S = 27.0
BUSY_S = 4.0


def first_manoeuvre() -> LogPlayer:
    """The bundled log's first manoeuvre, as fast as it can be played."""
    return _played(26.0)


def _played(flown_s: float) -> LogPlayer:
    from advisor.mavlink.logs.logs import open_log

    pieces = [piece for batch in open_log(LOG) for piece in batch]
    end_s = min(piece.arrival_s[0] for piece in pieces) + flown_s
    return LogPlayer(LOG.name, lambda: [_until(piece, end_s) for piece in pieces], inf)


def _until(piece: Columns, end_s: float) -> Columns:
    end = int((piece.arrival_s < end_s).sum())
    fields = {name: values[:end] for name, values in piece.fields.items()}
    return replace(piece, order=piece.order[:end], arrival_s=piece.arrival_s[:end], fields=fields)


class Traced(LogPlayer):
    """Tells its process, and waits as long as a link that reads its recording again."""

    def health(self) -> LinkHealth:
        """The process instead of a sentence."""
        read_again = self.playback().position_s >= FIRST_JUDGED_S
        return LinkHealth("good" if read_again else "waiting", str(os.getpid()))


def traced() -> Traced:
    """The bundled log's first two manoeuvres, at ten times their speed."""
    player = _played(45.0)
    return Traced(LOG.name, player._load, 10.0)


def campaign(by_hand: ByHand = NOTHING) -> "Campaign":
    """A real one."""
    from advisor.campaign.campaign import Campaign

    return Campaign(Aircraft(), informs=True, by_hand=by_hand)


def staged(by_hand: ByHand) -> StagedCampaign:
    """Three manoeuvres flown."""
    return StagedCampaign([flights.state(3)], by_hand=by_hand)


def busy(by_hand: ByHand) -> StagedCampaign:
    """Estimates for seconds when it is fed."""
    return StagedCampaign([flights.state(3)], on_feed=_estimate)


def _estimate() -> None:
    end_s = time.monotonic() + BUSY_S
    while time.monotonic() < end_s:
        sum(k * k for k in range(1000))


def halting(note: Path, by_hand: ByHand) -> "Campaign":
    """A real one on a computer that halts: for 3 s before the first batch, and for 4 s after 2 s of batches.

    The note holds the times, s, at which the first batch was judged and the second halt began.
    """
    time.sleep(3.0)
    real = campaign(by_hand)
    feed, judged_s = real.feed, []

    def feed_or_halt(columns: Sequence[Columns]) -> "list[CampaignEvent]":
        if judged_s and time.time() > judged_s[0] + 2.0 and not note.exists():
            note.write_text(f"{judged_s[0]} {time.time()}")
            time.sleep(4.0)
        events = feed(columns)
        judged_s.append(time.time())
        return events

    real.feed = feed_or_halt  # type: ignore[method-assign]
    return real


def ending(by_hand: ByHand) -> StagedCampaign:
    """Takes its process with it when it is fed."""
    return StagedCampaign([flights.state(0)], on_feed=lambda: os._exit(9))


def talking() -> HandFedSource:
    """A source with one message."""
    source = HandFedSource()
    source.deliver()
    return source


class Stopping(HandFedSource):
    """Stops its own process, like a debugger or a full memory does, in the first process that reads it."""

    def __init__(self, note: Path) -> None:
        super().__init__()
        self._note = note
        self.deliver()

    def read(self, timeout_s: float) -> Sequence[Columns] | None:
        """Read, or hang."""
        if self.batches.empty() and not self._note.exists():
            self._note.touch()
            time.sleep(0.3)
            os.kill(os.getpid(), signal.SIGSTOP)
        return super().read(timeout_s)


def unusable() -> HandFedSource:
    """A source that can never serve."""
    source = HandFedSource()
    source.batches.put(UnusableInputError("rate", "AOA_SSA arrives at 4 Hz.", "Ask for 50 Hz."))
    return source


def faulty() -> HandFedSource:
    """A source with a fault."""
    source = HandFedSource()
    source.batches.put(ZeroDivisionError("a fault"))
    return source
