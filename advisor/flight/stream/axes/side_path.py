"""Path of the aileron and rudder samples: from movements to lateral manoeuvres.

Aileron and rudder each have a segmenter. Simultaneous movements form one input. An input is cut when its free
response is long enough, in vehicle time.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import groupby
from operator import itemgetter

from advisor.flight.elevator.elevator_watch import SETTLE_S, ElevatorWatch
from advisor.flight.maneuvers.axes.side_inputs import (
    BESIDE,
    TAIL_S,
    TOGETHER_S,
    SideMovement,
    first_input,
    input_span,
    named,
)
from advisor.flight.maneuvers.events import FlightEvent
from advisor.flight.maneuvers.hand_flying import ROLL, YAW, Loop
from advisor.flight.maneuvers.maneuver import Span
from advisor.flight.maneuvers.marks import Marks
from advisor.flight.signals.channels import Decoded
from advisor.flight.signals.tracks import Tracks
from advisor.flight.stream.cutting import Cutting

LOOPS: dict[str, Loop] = {"aileron": ROLL, "rudder": YAW}


class SidePath:
    """Lateral manoeuvres in the samples of aileron and rudder.

    Parameters
    ----------
    marks
        Marked stretches. A movement in a marked stretch is not reported separately.
    """

    def __init__(self, tracks: Tracks, marks: Marks, cutting: Cutting) -> None:
        self._tracks, self._marks, self._cutting = tracks, marks, cutting
        self.begin(0)

    def begin(self, boot: int) -> None:
        """Begin another power-on, or follow another vehicle."""
        self._boot = boot
        self._watches = {name: ElevatorWatch() for name in LOOPS}
        self._pending: list[SideMovement] = []
        self._messages: dict[str, str] = {}

    def mode_changed(self, earliest_s: float, order: int) -> None:
        """Take a flight mode change by the message of this order, not before ``earliest_s``."""
        for watch in self._watches.values():
            watch.mode_changed(earliest_s, order)

    def feed(self, moved: Sequence[Decoded]) -> list[FlightEvent]:
        """Process samples of aileron and rudder, in order of arrival."""
        events: list[FlightEvent] = []
        arrived = [
            (order, t, new.channel, y)
            for new in moved
            if new.source.startswith(self._messages.setdefault(new.channel, new.source.partition(".")[0]))
            for order, t, y in zip(new.order.tolist(), new.t.tolist(), new.y.tolist(), strict=True)
        ]
        for order, samples in groupby(sorted(arrived), key=itemgetter(0)):
            events += self._complete(order)
            # All controls of one message come before a decision: their inputs may end together.
            for _, t, name, y in samples:
                for event in self._watches[name].push(t, order, y):
                    if isinstance(event, Span):
                        self._add(SideMovement(LOOPS[name], event))
            while self._pending and self._is_over():
                events += self._released(order)
        return [*events, *self._complete(None)]

    def _complete(self, order: int | None) -> list[FlightEvent]:
        """Return the events of stretches that were complete at the message of this order; None for all."""
        events: list[FlightEvent] = []
        due = self._cutting.side_due
        while due and (order is None or (due[0].order is not None and due[0].order <= order)):
            events += self._cutting.side_events(due.pop(0))
        return events

    def finish(self) -> list[FlightEvent]:
        """Handle the end of the samples, and close every open movement."""
        for name, watch in self._watches.items():
            for span in watch.finish():
                self._add(SideMovement(LOOPS[name], span))
        events: list[FlightEvent] = []
        while self._pending:
            events += self._released(None)
        return [*self._complete(None), *events]

    @property
    def _newest_s(self) -> float:
        """Newest stamp of aileron and rudder, s."""
        return max(watch.newest_s for watch in self._watches.values())

    def _add(self, movement: SideMovement) -> None:
        """Store a movement of aileron or rudder, unless it ends at trim without any level."""
        if movement.amplitude == 0.0:
            return
        self._pending = sorted([*self._pending, movement], key=lambda m: m.span.start_s)

    def _is_over(self) -> bool:
        """Return whether no movement can join or shorten the first input any more."""
        side_input, _ = first_input(self._pending)
        last_s = side_input.last_step_s
        if self._marks.since_s(self._newest_s) is not None:
            return False
        if self._newest_s >= last_s + TAIL_S[1] + SETTLE_S:
            return not any(
                watch.onset_s is not None and watch.onset_s <= last_s + TOGETHER_S
                for watch in self._watches.values()
            )
        return any(movement.span.closed_by in ("gap", "mode change") for movement in side_input.movements)

    def _released(self, up_to_order: int | None) -> list[FlightEvent]:
        """Remove the first input, and return its event; empty if it is no test input."""
        side_input, self._pending = first_input(self._pending)
        last_s = side_input.last_step_s
        yaw_rate = self._tracks.cut("r", last_s, last_s + TAIL_S[1], up_to_order)
        ahead = [
            *self._pending,
            *(
                _begun(watch.onset_s, watch.amplitude, side_input.main, LOOPS[name])
                for name, watch in self._watches.items()
                if watch.onset_s is not None and up_to_order is not None
            ),
        ]
        span = input_span(side_input, sorted(ahead, key=lambda m: m.span.start_s), self._newest_s, yaw_rate)
        # A small movement within the record of another input is no input of its own.
        least_rad = BESIDE * side_input.main.amplitude
        self._pending = [m for m in self._pending if m.span.start_s >= span.end_s or m.amplitude >= least_rad]
        span = self._marks.before(span)
        maneuver, evidence = self._cutting.records.of_sides(span, self._boot, up_to_order)
        if (
            self._marks.holds(span)
            or self._cutting.claims(span, up_to_order)
            or self._cutting.is_no_side_input(maneuver, side_input, up_to_order)
        ):
            return []
        named_one = replace(maneuver, span=replace(span, kind=named(side_input)))
        return self._cutting.side_counted(named_one, evidence)


def _begun(onset_s: float, amplitude: float, like: SideMovement, loop: Loop) -> SideMovement:
    """Return a movement that is being flown, with its amplitude so far, rad."""
    steps = ((onset_s, amplitude),)
    span = replace(like.span, start_s=onset_s, last_step_s=onset_s, end_s=onset_s, steps=steps)
    return SideMovement(loop, span)
