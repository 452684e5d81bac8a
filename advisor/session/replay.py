"""Logs that are replayed like a flight (paused, stepped, at any speed, in the order of arrival), and a
campaign resumed.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from math import inf
from pathlib import Path
from threading import Event

import numpy as np

from advisor.analysis.marks_file import LogSeries, keep_on_all, of_flight
from advisor.campaign.state import NOTHING, ByHand
from advisor.flight.signals.messages import Columns
from advisor.session.conducting import LinkHealth, LinkRequest, Playback, Source, Tempo
from advisor.session.timeline import Timeline

STEP_S = 0.1
_FAST_SLICE_S = 0.5


def _wait(changed: Event, seconds: float) -> None:
    changed.wait(seconds)


class LogPlayer:
    """Source over the messages of a log, which can be paused, stepped, played at any speed and restarted.

    Parameters
    ----------
    load : callable
        Returns the columns of the log. The function is called once, in the reading thread.
    speed : float
        Multiple of real time. Infinite: as fast as possible.
    wait : callable
        ``wait(event, seconds)`` waits until the event is set or the time is over. Tests pass their own clock.
    keep_beside : sequence of Path
        Logs of each flight, next to which decisions by hand are kept. If empty, decisions by hand are not
        kept.
    said : callable
        Returns sentences on the logs after loading.
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
        """Return the next part of the log when its time has come, see `Source.read`."""
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
        """Return the state of the log: playing or ended."""
        timeline = self._timeline
        if timeline is None:
            return LinkHealth("waiting", f"Reading {self._title}.")
        figures = (("messages", f"{len(timeline)}"), ("length", f"{timeline.duration_s:.0f} s"))
        if self._ended:
            return LinkHealth("ended", "The log has been played to its end.", figures)
        return LinkHealth("good", "A recorded log is being played.", figures)

    @property
    def is_hurried(self) -> bool:
        """Whether the log is played faster than it was flown."""
        return self._hurrying or self._tempo.speed > 1.0

    def playback(self) -> Playback:
        duration_s = self._timeline.duration_s if self._timeline else 0.0
        return Playback(self._position_s, duration_s, self._hurrying)

    def play(self, tempo: Tempo) -> None:
        """Pause or continue the replay, or change its speed. Any thread may call."""
        self._tempo = tempo
        self._changed.set()

    def step(self) -> None:
        """Deliver the next `STEP_S`, whether the replay is paused or not. Any thread may call."""
        self._steps += 1
        self._changed.set()

    def hurry(self, hurrying: bool) -> None:
        """Play as fast as possible, or at the tempo again."""
        self._hurrying = hurrying

    def rewind(self) -> None:
        """Start again with the first record, between two reads. The caller starts a new campaign."""
        self._position_s, self._ended = 0.0, False
        if self._timeline:
            self._timeline.rewind()

    def take_notices(self) -> Sequence[str]:
        """Return sentences on the logs after loading. A log file gives no later notices."""
        notices, self._notices = self._notices, ()
        return notices

    def order(self, order: LinkRequest) -> None:
        """Do nothing, because the vehicle of a log cannot receive requests."""

    def keep(self, by_hand: ByHand) -> str:
        """Store each decision by hand next to its log."""
        if not self._keep_beside:
            return "decisions by hand are not kept: they hold until you quit"
        before, self._kept = self._kept, by_hand
        return keep_on_all(self._keep_beside, before, by_hand)

    def close(self) -> None:
        """Do nothing, because a replay keeps no file open."""


STRETCH_S = 30.0
"""Longest part of an earlier flight in one batch, s. An autopilot's own log comes as one batch, so that the
campaign would not report for minutes.
"""


def stretches(batches: Iterable[list[Columns]]) -> Iterator[list[Columns]]:
    """Yield the messages of the batches in their order, at most ``STRETCH_S`` of flight together."""
    for batch in batches:
        timeline = Timeline(batch)
        ends = np.arange(STRETCH_S, timeline.duration_s, STRETCH_S)
        yield from filter(None, map(timeline.up_to, [*ends.tolist(), inf]))


class ResumedSource:
    """Delivers the logs of earlier flights, then the messages of a link as the last flight.

    Parameters
    ----------
    logs
        Logs of earlier flights, the oldest first, only read.
    """

    def __init__(self, logs: Sequence[Path], link: Source) -> None:
        self._series = LogSeries(logs)
        self._link = link
        self._past: Iterator[list[Columns]] | None = stretches(self._series.batches())
        self._kept = self._series.read_by_hand()
        self._notices: list[str] = []

    def read(self, timeout_s: float) -> Sequence[Columns] | None:
        """Return the next batch, beginning with the earlier flights.

        Raises
        ------
        UnusableInputError
            The link can never be used.
        """
        if self._past is not None:
            batch = next(self._past, None)
            if batch is not None:
                return batch
            self._past = None
            self._notices += self._series.said()
        columns = self._link.read(timeout_s)
        return columns if columns is None else of_flight(columns, len(self._series.logs))

    def health(self) -> LinkHealth:
        """Return the state of the arriving data."""
        if self._past is not None:
            return LinkHealth("waiting", "The earlier flights are being read.")
        return self._link.health()

    def take_notices(self) -> Sequence[str]:
        """Return the notices since the last call."""
        notices, self._notices = self._notices, []
        return [*notices, *self._link.take_notices()]

    def order(self, order: LinkRequest) -> None:
        """Send a crew's request to the link."""
        self._link.order(order)

    def keep(self, by_hand: ByHand) -> str:
        """Store each decision by hand next to its log or recording."""
        before, self._kept = self._kept, by_hand
        said = keep_on_all(self._series.logs, before, by_hand)
        newest = self._link.keep(by_hand.on_flight(len(self._series.logs)))
        return "; ".join(filter(None, (said, newest)))

    def close(self) -> None:
        self._link.close()
