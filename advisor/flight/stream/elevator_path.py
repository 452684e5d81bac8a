"""Paths of the samples of elevator, aileron and rudder: from servo outputs to movements, and on to events.

Aileron and rudder each have a segmenter. Simultaneous movements form one input. An input is cut when its free
response is long enough, in vehicle time.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import groupby
from operator import itemgetter

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.elevator.elevator_watch import SETTLE_S, ElevatorWatch
from advisor.flight.elevator.mixing import Commanded, Mixing
from advisor.flight.maneuvers.axes.side_inputs import (
    BESIDE,
    TAIL_S,
    TOGETHER_S,
    SideMovement,
    first_input,
    input_span,
    named,
)
from advisor.flight.maneuvers.excitation import ROLL, YAW, Loop
from advisor.flight.maneuvers.maneuver import READER_NOTICE, FlightEvent, Maneuver, Notice, Span
from advisor.flight.maneuvers.marks import Due, Marks
from advisor.flight.maneuvers.segmentation import LEAD_IN_S
from advisor.flight.signals.channels import Decoded, given_airspeed, named_value, of_companion, quantities
from advisor.flight.signals.messages import Columns
from advisor.flight.signals.record import ALL_UNITS
from advisor.flight.signals.track import PowerOn
from advisor.flight.signals.tracks import Tracks
from advisor.flight.stream.cutting import Cutting
from advisor.flight.stream.identity import Identity
from advisor.flight.vehicle.pieces import Master
from advisor.process.arrays import FloatArray


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


_NAMED = "named_value:"
"""Beginning of a vane's ``source`` if a NAMED_VALUE_FLOAT carries its angle."""


def decoded(columns: Columns, t: FloatArray, aircraft: Aircraft, companion: bool) -> Iterator[Decoded]:
    """Yield the quantities in messages of one type.

    Parameters
    ----------
    t
        Shape (n,): vehicle time of each message, s since boot.
    companion
        Whether another component than the autopilot sent the messages.
    """
    measured = quantities(columns, t)
    yield from map(of_companion, measured) if companion else measured
    if columns.name == "ATTITUDE" and aircraft.airspeed_m_s is not None:
        yield given_airspeed(columns, t, aircraft.airspeed_m_s)
    if columns.name == "NAMED_VALUE_FLOAT":
        for channel, source in (("alpha", aircraft.alpha.source), ("beta", aircraft.beta.source)):
            if source.startswith(_NAMED):
                yield named_value(columns, t, channel, source.removeprefix(_NAMED))


def power_on(
    boot: int,
    tracks: Tracks,
    who: Identity,
    is_backwards: bool,
    clock: Sequence[Master],
    modes: Sequence[tuple[float, str]],
) -> PowerOn:
    """Return all data received since the start of the vehicle's clock.

    Parameters
    ----------
    is_backwards
        Whether the elevator was found to move opposite to its nominal sign.
    modes
        Vehicle time of each flight mode change, s, and the mode's name.
    """
    cuts = {name: tracks.cut(name, -np.inf, np.inf) for name in ALL_UNITS}
    channels = {name: who.identified(c) for name, c in cuts.items() if c is not None}
    if is_backwards and "elevator" in channels:
        channels["elevator"] = replace(channels["elevator"], y=-channels["elevator"].y)
    heard = [(master.order, master.t) for master in clock if len(master.t)]
    order, t = map(np.concatenate, zip(*heard, strict=True)) if heard else (np.empty(0, int), np.empty(0))
    return PowerOn(boot, channels, order, t, tuple(modes))


_ANY = ("auto", "none", "derived")
"""Sources that require no message."""


class AskedSources:
    """Reports which named sources of the aircraft file have sent no value."""

    def __init__(self, aircraft: Aircraft) -> None:
        stated = {"alpha": aircraft.alpha.source, "beta": aircraft.beta.source}
        self._missing = {name: source for name, source in stated.items() if source not in _ANY}
        self._names: set[str] = set()

    def hear(self, columns: Columns) -> None:
        """Keep the names of NAMED_VALUE_FLOAT messages, for the sentence on a missing one."""
        if self._missing and columns.name == "NAMED_VALUE_FLOAT":
            raw = set(columns.fields["name"].tolist())
            self._names |= {name.rstrip(b"\0").decode("ascii", "replace") for name in raw}

    def take(self, new: Decoded) -> None:
        """Take samples of a channel from a possible source."""
        if new.channel in self._missing and len(new.t):
            del self._missing[new.channel]

    def finish(self) -> Iterator[Notice]:
        """Yield a notice on each source without a value, once."""
        for name, source in self._missing.items():
            others = ", ".join(sorted(self._names))
            there = f"the named values are {others}" if others else "no named value arrived"
            why = f"; {there}" if source.startswith(_NAMED) else ""
            yield Notice(READER_NOTICE, f"{name}.source asks for {source}, which is not in this record{why}.")
        self._missing = {}


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
