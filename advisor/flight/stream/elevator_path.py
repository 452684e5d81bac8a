"""Path of the elevator's samples: from servo outputs to the segmenter, and from movements to events."""

from collections.abc import Sequence

from advisor.flight.elevator.commanded import Commanded
from advisor.flight.elevator.elevator_watch import SETTLE_S, ElevatorWatch
from advisor.flight.elevator.mixing import Mixing
from advisor.flight.maneuvers.events import FlightEvent, Notice
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.maneuvers.marks import Due, Marks
from advisor.flight.maneuvers.segmentation import LEAD_IN_S
from advisor.flight.signals.channels import Decoded
from advisor.flight.signals.tracks import Tracks
from advisor.flight.stream.cutting import Cutting


class ElevatorPath:
    """Elevator samples from servo outputs, the movements in them, and their events.

    Parameters
    ----------
    marks
        Marked stretches of the stream. A movement in a marked stretch is not reported separately.
    """

    def __init__(self, tracks: Tracks, mixing: Mixing, marks: Marks, cutting: Cutting) -> None:
        self._tracks, self._mixing, self._marks, self._cutting = tracks, mixing, marks, cutting
        self.begin(0)

    def begin(self, boot: int) -> None:
        """Begin another power-on, or follow another vehicle."""
        self._boot = boot
        self._watch = ElevatorWatch()
        self._message: str | None = None
        self.heard: frozenset[int] = frozenset()
        """Outputs with a pulse in the newest sample; empty before the first sample."""

    @property
    def newest_s(self) -> float:
        """Vehicle time of the elevator's newest sample, s since boot."""
        return self._watch.newest_s

    def mode_changed(self, earliest_s: float, order: int) -> None:
        """Take a flight mode change by the message of this order, not before ``earliest_s``."""
        self._watch.mode_changed(earliest_s, order)

    def so_far(self) -> Maneuver | None:
        """Return the manoeuvre being flown, cut at the newest sample; None between manoeuvres."""
        now = self._watch.newest_s
        marked_s = self._marks.since_s(now)
        onset = self._watch.onset_s if marked_s is None else marked_s
        if onset is None or not now > onset:
            return None
        if marked_s is None and not self._cutting.pilot_flies(onset):
            return None
        over_s = self._watch.last_step_s if marked_s is None else None
        last_step_s = now if over_s is None else over_s
        span = Span(onset - LEAD_IN_S, onset, last_step_s, now, "other", (), "still flying")
        if marked_s is None and self._cutting.why_on_ground(span) is not None:
            return None
        return self._cutting.so_far(span, self._boot)

    def feed(self, moved: Sequence[Commanded], closes_loop: bool) -> list[FlightEvent]:
        """Form the elevator's samples from its outputs, and process them.

        Parameters
        ----------
        closes_loop
            Whether the autopilot closes a loop over the elevator.
        """
        events: list[FlightEvent] = []
        arrived = [new for new in moved if len(new.t)]
        if self._message is None and arrived:
            # Some vehicles report their outputs in two messages. The first message to arrive counts.
            self._message = min(arrived, key=lambda new: int(new.order[0])).message
        for new in arrived:
            if new.message == self._message:
                self.heard = frozenset(new.surface.outputs)
                for mixed in self._mixing.take(new, closes_loop):
                    events += [mixed] if isinstance(mixed, Notice) else self._follow([mixed])
        return events

    def finish(self, master_s: float) -> list[FlightEvent]:
        """Handle the end of the samples, and close every open movement.

        Parameters
        ----------
        master_s
            Vehicle time of the newest message, s since boot.
        """
        events = self._follow(self._mixing.finish())
        due = self._marks.finish(master_s)
        for span in self._watch.finish():
            events += self._found(span, None)
        return [*events, *self._marked(due, None)]

    def _follow(self, decoded: Sequence[Decoded]) -> list[FlightEvent]:
        """Pass samples to the segmenter in the order of their stamps, and cut finished movements."""
        events: list[FlightEvent] = []
        arrived: list[tuple[int, float, float]] = []
        for new in decoded:
            self._tracks.append(new)
            arrived += zip(new.order.tolist(), new.t.tolist(), new.y.tolist(), strict=True)
        for order, t, y in sorted(arrived):
            self._marks.advance(order)
            for event in self._watch.push(t, order, y):
                if isinstance(event, Span):
                    events += self._found(event, order)
                elif self._cutting.pilot_flies(event.at_s):
                    events.append(event)
            events += self._marked(self._marks.due(self._watch.newest_s - SETTLE_S), order)
        return events

    def _found(self, span: Span, up_to_order: int | None) -> list[FlightEvent]:
        """Return the events of a movement found by the segmenter, unless it lies in a marked stretch."""
        return [] if self._marks.hides(span, up_to_order) else self._flown(span, up_to_order)

    def _marked(self, due: Due, up_to_order: int | None) -> list[FlightEvent]:
        events: list[FlightEvent] = list(due.notices)
        for span, order in due.spans:
            events += self._flown(span, order)
        for mark in due.marks:
            events += self._cutting.marked(mark, self._boot, up_to_order)
        return events

    def _flown(self, span: Span, up_to_order: int | None) -> list[FlightEvent]:
        return self._cutting.flown(self._marks.before(span), self._boot, up_to_order)
