"""Logs played like a flight: paused, stepped, sped up, always in its order of arrival."""

from collections.abc import Callable, Sequence
from math import inf
from pathlib import Path
from threading import Event

from advisor.campaign.hand_decisions import NOTHING, ByHand
from advisor.flight.messages import Columns
from advisor.marks_file import keep_on_all
from advisor.tui.source import LinkHealth, Order, Playback, Tempo
from advisor.tui.timeline import Timeline

STEP_S = 0.1
_FAST_SLICE_S = 0.5


def _wait(changed: Event, seconds: float) -> None:
    changed.wait(seconds)


class LogPlayer:
    """A `Playable` source over the messages of a log.

    Parameters
    ----------
    title : str
        The log's name.
    load : callable
        Returns the log's columns; called once, in the reading thread.
    speed : float
        Multiple of real time; infinite: as fast as it can.
    wait : callable
        ``wait(event, seconds)`` waits until the event is set or the time is over; tests have their own clock.
    keep_beside : sequence of Path
        The logs beside which decisions by hand are kept, flight by flight; none: they are not kept.
    before : ByHand
        What was decided by hand before.
    said : callable
        Returns what is to be said of the logs once they are loaded.
    """

    def __init__(
        self,
        title: str,
        load: Callable[[], Sequence[Columns]],
        speed: float = 1.0,
        wait: Callable[[Event, float], None] = _wait,
        keep_beside: Sequence[Path] = (),
        before: ByHand = NOTHING,
        said: Callable[[], Sequence[str]] = tuple,
    ) -> None:
        self._title = title
        self._load = load
        self._wait = wait
        self._keep_beside = keep_beside
        self._kept = before
        self._said = said
        self._notices: Sequence[str] = ()
        self._tempo = Tempo(speed=speed)
        self._hurrying = False
        self._steps = 0
        self._position_s = 0.0
        self._ended = False
        self._timeline: Timeline | None = None
        self._changed = Event()

    def read(self, timeout_s: float) -> Sequence[Columns] | None:
        """The next stretch of the log when its time has come, see `Source.read`."""
        if self._timeline is None:
            self._timeline = Timeline(self._load())
            self._notices = self._said()
        self._ended = self._position_s >= self._timeline.duration_s
        if self._ended:
            return None
        self._changed.clear()
        tempo = self._tempo
        if self._hurrying:
            stretch_s = _FAST_SLICE_S
        elif self._steps:
            self._steps -= 1
            stretch_s = STEP_S
        elif tempo.paused:
            self._wait(self._changed, timeout_s)
            return ()
        elif tempo.speed == inf:
            stretch_s = _FAST_SLICE_S
        else:
            stretch_s = STEP_S * max(1.0, tempo.speed)
            self._wait(self._changed, stretch_s / tempo.speed)
            if self._changed.is_set():
                return ()
        self._position_s = min(self._position_s + stretch_s, self._timeline.duration_s)
        return self._timeline.up_to(self._position_s)

    def health(self) -> LinkHealth:
        """A log cannot get lost; it can only be over."""
        timeline = self._timeline
        if timeline is None:
            return LinkHealth("waiting", f"Reading {self._title}.")
        figures = (("messages", f"{len(timeline)}"), ("length", f"{timeline.duration_s:.0f} s"))
        if self._ended:
            return LinkHealth("ended", "The log has been played to its end.", figures)
        return LinkHealth("good", "A recorded log is being played.", figures)

    def playback(self) -> Playback:
        """Where it stands."""
        duration_s = self._timeline.duration_s if self._timeline else 0.0
        return Playback(self._position_s, duration_s, self._hurrying)

    def play(self, tempo: Tempo) -> None:
        """Hold, go on, faster or slower."""
        self._tempo = tempo
        self._changed.set()

    def step(self) -> None:
        """Deliver the next `STEP_S`, paused or not."""
        self._steps += 1
        self._changed.set()

    def hurry(self, hurrying: bool) -> None:
        """Play as fast as it can, or at the tempo again."""
        self._hurrying = hurrying

    def rewind(self) -> None:
        """Start again with the first record. Only between two reads."""
        self._position_s, self._ended = 0.0, False
        if self._timeline:
            self._timeline.rewind()

    def take_notices(self) -> Sequence[str]:
        """What was found when the logs were loaded; nothing happens on the way from a file."""
        notices, self._notices = self._notices, ()
        return notices

    def order(self, order: Order) -> None:
        """A log has been flown: nothing can be asked of its vehicle."""

    def keep(self, by_hand: ByHand) -> str:
        """Keep each decision beside the log that it concerns."""
        if not self._keep_beside:
            return "decisions by hand are not kept: they hold until you quit"
        before, self._kept = self._kept, by_hand
        return keep_on_all(self._keep_beside, before, by_hand)

    def close(self) -> None:
        """A log holds nothing open."""
