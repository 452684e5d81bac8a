"""The stream of one vehicle: columns of messages in, channels and manoeuvres out.

Whatever is decided is decided by the order of arrival and the vehicle's clock, never by how
messages were batched: a live link, message by message, and a log, whole, end in the same
events. Memory is bounded by two minutes of channels.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft import Aircraft
from advisor.flight.attitude import Attitudes
from advisor.flight.banks import Banks, merged
from advisor.flight.boots import Master, by_boot
from advisor.flight.channels import (
    Decoded,
    derived_alpha,
    named_value,
    quantities,
    stamps,
)
from advisor.flight.clocks import BootClock
from advisor.flight.commanded import Commanded, commanded
from advisor.flight.cutting import Cutting
from advisor.flight.elevator_watch import SETTLE_S, ElevatorWatch
from advisor.flight.events import (
    FlightEvent,
    ManeuverFlown,
    ModeChanged,
    Notice,
    Rebooted,
)
from advisor.flight.identity import Identity
from advisor.flight.maneuver import Maneuver, Span
from advisor.flight.markers import HEARD, MarkerWatch
from advisor.flight.marks import Due, Mark, Marks
from advisor.flight.messages import Columns, FloatArray
from advisor.flight.mixing import Mixing
from advisor.flight.pieces import pieces
from advisor.flight.record import Channel
from advisor.flight.segmentation import LEAD_IN_S
from advisor.flight.sense import SAID
from advisor.flight.suitability import problems
from advisor.flight.surfaces import Surface
from advisor.flight.track import ChannelStatus, Tracks
from advisor.flight.vehicle import Vehicle, closes_pitch_loop
from advisor.problems import Problem

KEEP_S = 120.0
"""How far back channels reach: longer than any manoeuvre with its lead-in."""
_OUTPUTS = ("SERVO_OUTPUT_RAW", "ACTUATOR_OUTPUT_STATUS")
_HEARTBEAT_S = 2.2
"""The mode changed since the heartbeat before, at most so long ago: one of them may be lost."""


class FlightStream:
    """Follows one vehicle.

    Parameters
    ----------
    aircraft
        The aircraft file: elevator output and calibration, source of the angle of attack.
    target_system
        System id to follow; None: the first vehicle heard.
    marks
        Stretches that somebody has called manoeuvres, known before the stream begins.
    """

    def __init__(
        self, aircraft: Aircraft, target_system: int | None = None, marks: Sequence[Mark] = ()
    ) -> None:
        self._aircraft = aircraft
        self._who = Identity(aircraft.elevator, target_system)
        self._attitudes = Attitudes()
        self._clock = BootClock()
        self._tracks = Tracks(aircraft.alpha.source)
        self._cutting = Cutting(self._tracks, self._who, aircraft.elevator.is_calibrated)
        self._mixing = Mixing(self._tracks)
        self.marks = Marks(marks)
        """What is marked by hand, by a switch and by texts."""
        self._markers = MarkerWatch(aircraft.markers)
        self._over = False
        self._start_boot()
        self.boot = 0
        """Number of the power-on, 0 for the first in the stream."""
        self.seen: set[str] = set()
        """Names of the messages the vehicle has sent."""
        self._best: dict[str, ChannelStatus] = {}
        self._earlier_s = 0.0

    def _start_boot(self) -> None:
        self._tracks.clear()
        self._watch = ElevatorWatch()
        self._banks = Banks()
        self._mixing.begin()
        self._elevator_message: str | None = None
        self._cutting.begin(self._who.mode)
        self._first_s = np.nan
        self._master_s = np.nan
        self._heartbeat_s = -np.inf
        self._attitude = np.full((1, 2), np.nan)

    @property
    def vehicle(self) -> Vehicle | None:
        """Who is followed; None before its first heartbeat."""
        return self._who.vehicle

    @property
    def other_systems(self) -> frozenset[int]:
        """System ids of further vehicles heard."""
        return self._who.other_systems

    @property
    def maneuvers(self) -> int:
        """How many manoeuvres have been found."""
        return self._cutting.maneuvers

    @property
    def mode(self) -> str:
        """Flight mode of the newest heartbeat."""
        return self._who.mode

    @property
    def elevator(self) -> Surface | Problem:
        """The elevator's outputs and scale, or why there is none."""
        return self._who.elevator

    @property
    def elevator_notes(self) -> tuple[str, ...]:
        """What the elevator is made of, what is assumed of its scale and sense, in sentences."""
        backwards = SAID if self._cutting.is_backwards else ""
        if not isinstance(self.elevator, Surface):
            return (backwards,) if backwards else ()
        sentences = (self.elevator.said, self._mixing.said(self.elevator), backwards)
        return tuple(said for said in sentences if said)

    @property
    def now_s(self) -> float:
        """Vehicle time of the newest sample, s since boot; NaN before the first."""
        return self._clock.newest_s

    @property
    def duration_s(self) -> float:
        """Vehicle time heard so far, over all boots, s."""
        return self._earlier_s + (self._master_s - self._first_s if np.isfinite(self._master_s) else 0.0)

    @property
    def channels(self) -> Mapping[str, ChannelStatus]:
        """How every channel arrives, from the source that would be used now."""
        arriving = {**self._best, **self._tracks.statuses()}
        return {
            name: replace(status, provenance=self._who.provenance(status.source, status.provenance))
            for name, status in arriving.items()
        }

    def problems(self) -> list[Problem]:
        """Why this stream cannot be used, as far as it has been heard; empty when it can."""
        self._note_rates()
        flown = self._cutting
        found = problems(
            self.vehicle, self.other_systems, self.elevator, self._best, flown.maneuvers, flown.activities
        )
        wrong = self._mixing.contradiction
        return [
            *(self.marks.problems() if self._over else ()),
            *([wrong] if wrong and not flown.maneuvers else ()),
            *found,
        ]

    def recent(self, name: str, seconds: float) -> Channel | None:
        """The newest stretch of a channel; None when nothing of it has arrived."""
        return self._tracks.recent(name, seconds)

    def so_far(self) -> Maneuver | None:
        """The manoeuvre being flown, cut at the newest sample; None between manoeuvres."""
        now = self._watch.newest_s
        marked_s = self.marks.since_s(now)
        onset = self._watch.onset_s if marked_s is None else marked_s
        if onset is None or not now > onset:
            return None
        if marked_s is None and not self._cutting.pilot_flies(onset):
            return None
        span = Span(onset - LEAD_IN_S, onset, now, now, "other", (), "still flying")
        return self._cutting.so_far(span, self.boot)

    def feed(self, columns: Sequence[Columns]) -> list[FlightEvent]:
        """Take messages that have arrived; what became known by them, in order."""
        events: list[FlightEvent] = []
        for piece in pieces(self._attitudes.of(columns)):
            events += self._feed_piece(piece)
        return events

    def finish(self) -> list[FlightEvent]:
        """No more messages will come: whatever is open is closed."""
        events = self._finish_boot()
        self._over = True
        return events

    def _finish_boot(self) -> list[FlightEvent]:
        events = self._watch_elevator(self._mixing.finish())
        due = self.marks.finish(self._master_s)
        for span in self._watch.finish():
            events += self._found(span, None)
        events += self._marked(due, None)
        self._note_rates()
        return events

    def _note_rates(self) -> None:
        """Remember how each channel arrived when it arrived fastest."""
        for name, status in self._tracks.statuses().items():
            best = self._best.get(name)
            if best is None or not status.rate_hz <= best.rate_hz:
                self._best[name] = status

    def _feed_piece(self, piece: Sequence[Columns]) -> list[FlightEvent]:
        """Columns within which neither vehicle nor parameters nor mode change."""
        mode = self._who.mode
        events = self._who.learn(piece)
        vehicle = self._who.vehicle
        if vehicle is None:
            return events
        if self._who.mode != mode:
            events.append(ModeChanged(self._who.mode, self._master_s))
            if np.isfinite(self._master_s):
                order = min(int(c.order[0]) for c in piece)
                earliest_s = max(self._heartbeat_s, self._master_s - _HEARTBEAT_S)
                self._watch.mode_changed(earliest_s, order)
                # Who takes over and flies an input at once did so before the heartbeat that tells of it.
                closed = closes_pitch_loop(self._who.mode)
                self._cutting.change(self._who.mode, self._master_s if closed else earliest_s)
            else:
                self._cutting.begin(self._who.mode)
        mine = [c for c in piece if c.system == vehicle.system]
        self.seen.update(c.name for c in mine)
        for part, master in by_boot(mine, vehicle.component, self._clock, self.boot):
            if master.boot != self.boot:
                events += self._finish_boot()
                self._earlier_s = self.duration_s
                self.boot = master.boot
                self._start_boot()
                self.marks.start_boot(self.boot, self._earlier_s)
                self._markers.start_boot()
                events.append(Rebooted(self.boot))
            events += self._feed_part(part, master, vehicle)
        return events

    def _feed_part(self, part: Sequence[Columns], master: Master, vehicle: Vehicle) -> list[FlightEvent]:
        """Columns of one boot: channels first, then the elevator sample by sample."""
        self._tracks.forget(max(self._watch.newest_s, self._master_s) - KEEP_S)
        orders = np.concatenate(([-1], master.order))
        # A late ATTITUDE says when it was, not what the time is.
        clock = np.fmax.accumulate(np.concatenate(([self._master_s], master.t)))
        attitude = _last_finite(np.concatenate((self._attitude, master.attitude)))
        elevator: list[Commanded] = []
        for columns in merged(part):
            now = np.searchsorted(orders, columns.order, side="right") - 1
            if columns.name in HEARD:
                self.marks.hear(self._markers.heard(columns, stamps(columns, clock[now])))
            if columns.component != vehicle.component and columns.name != "NAMED_VALUE_FLOAT":
                continue
            t = clock[now] if columns.component != vehicle.component else stamps(columns, clock[now])
            if columns.name == "HEARTBEAT" and np.isfinite(t[-1]):
                self._heartbeat_s = float(t[-1])
            for new in self._decode(columns, t, attitude[now]):
                self._tracks.append(new)
            if columns.name in _OUTPUTS:
                pulses = self._banks.together(columns)
                for moved in commanded(self._who.surfaces, pulses, t, vehicle.autopilot):
                    if moved.channel == "elevator":
                        elevator.append(moved)
                    else:
                        self._tracks.append(moved.combined())
        if np.isnan(self._first_s) and len(master.t):
            self._first_s = float(master.t[0])
            self.marks.start_clock(self._first_s)
        self._master_s, self._attitude = float(clock[-1]), attitude[-1:]
        return self._feed_elevator(elevator)

    def _decode(self, columns: Columns, t: FloatArray, attitude: FloatArray) -> Iterator[Decoded]:
        yield from quantities(columns, t)
        if columns.name == "VFR_HUD":
            yield derived_alpha(columns, t, attitude, self._aircraft.airspeed_m_s)
        elif columns.name == "NAMED_VALUE_FLOAT" and self._aircraft.alpha.source.startswith("named_value:"):
            yield named_value(columns, t, self._aircraft.alpha.source.removeprefix("named_value:"))

    def _feed_elevator(self, moved: Sequence[Commanded]) -> list[FlightEvent]:
        """Form the elevator's samples out of its outputs, and follow them."""
        events: list[FlightEvent] = []
        arrived = [new for new in moved if len(new.t)]
        if self._elevator_message is None and arrived:
            # Some vehicles report their outputs in two messages: the first to speak is listened to.
            self._elevator_message = min(arrived, key=lambda new: int(new.order[0])).message
        for new in arrived:
            if new.message == self._elevator_message:
                for known in self._mixing.take(new, closes_pitch_loop(self._who.mode)):
                    events += [known] if isinstance(known, Notice) else self._watch_elevator([known])
        return events

    def _watch_elevator(self, decoded: Sequence[Decoded]) -> list[FlightEvent]:
        """Give the segmenter its samples in the order of their stamps, and cut what has ended."""
        events: list[FlightEvent] = []
        arrived: list[tuple[int, float, float]] = []
        for new in decoded:
            self._tracks.append(new)
            arrived += zip(new.order.tolist(), new.t.tolist(), new.y.tolist(), strict=True)
        for order, t, y in sorted(arrived):
            self.marks.advance(order)
            for found in self._watch.push(t, order, y):
                if isinstance(found, Span):
                    events += self._found(found, order)
                elif self._cutting.pilot_flies(found.at_s):
                    events.append(found)
            events += self._marked(self.marks.due(self._watch.newest_s - SETTLE_S), order)
        return events

    def _found(self, span: Span, up_to_order: int | None) -> list[FlightEvent]:
        """What the finder has found, unless it lies in a marked stretch."""
        return [] if self.marks.hides(span, up_to_order) else self._flown(span, up_to_order)

    def _marked(self, due: Due, up_to_order: int | None) -> list[FlightEvent]:
        events: list[FlightEvent] = list(due.notices)
        for span, order in due.spans:
            events += self._flown(span, order)
        for mark in due.marks:
            events += self._cutting.marked(mark, self.boot, up_to_order)
            self._note_rates()
        return events

    def _flown(self, span: Span, up_to_order: int | None) -> list[FlightEvent]:
        events = self._cutting.flown(self.marks.before(span), self.boot, up_to_order)
        if any(isinstance(event, ManeuverFlown) for event in events):
            self._note_rates()
        return events


def _last_finite(values: FloatArray) -> FloatArray:
    """Each row, or where it has a NaN the last one before it that has none."""
    index = np.where(np.all(np.isfinite(values), axis=1), np.arange(len(values)), 0)
    return values[np.maximum.accumulate(index)]
