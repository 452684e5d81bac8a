"""The stream of one vehicle: columns of messages in, channels and manoeuvres out.

Every decision follows the order of arrival and the vehicle's clock, never the batches. So a live link,
message by message, and a whole log end in equal events. Memory is bounded by two minutes of channels.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.elevator.commanded import Commanded, commanded
from advisor.flight.elevator.elevator_guess import ElevatorGuesses, Guess
from advisor.flight.elevator.elevator_sign import SAID
from advisor.flight.elevator.mixing import Mixing
from advisor.flight.maneuvers.events import FlightEvent, ModeChanged, Notice, Rebooted
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.maneuvers.markers import HEARD, MarkerWatch
from advisor.flight.maneuvers.marks import Mark, Marks
from advisor.flight.signals.attitude import Attitudes
from advisor.flight.signals.banks import Banks, merged
from advisor.flight.signals.channels import COMPANIONS, Decoded, stamps
from advisor.flight.signals.clocks import BootClock
from advisor.flight.signals.derived_alpha import DERIVED_ALPHA, promised
from advisor.flight.signals.extremes import Course
from advisor.flight.signals.instrument_finding import InstrumentFinding
from advisor.flight.signals.messages import Columns, FloatArray, IntArray, arrivals
from advisor.flight.signals.power_on import PowerOn
from advisor.flight.signals.record import Channel
from advisor.flight.signals.track import ChannelStatus
from advisor.flight.signals.tracks import Tracks
from advisor.flight.signals.trust import Distrust, frozen
from advisor.flight.stream.cutting import Cutting
from advisor.flight.stream.decoding import decoded, power_on
from advisor.flight.stream.elevator_path import ElevatorPath
from advisor.flight.stream.identity import Identity
from advisor.flight.stream.instrument_watch import InstrumentWatch
from advisor.flight.stream.service import Service
from advisor.flight.stream.side_path import LOOPS, SidePath
from advisor.flight.stream.suitability import problems, with_guess
from advisor.flight.stream.vehicle_texts import VehicleTexts
from advisor.flight.vehicle.boots import Master, by_boot
from advisor.flight.vehicle.breaks import Breaks
from advisor.flight.vehicle.modes import closes_pitch_loop
from advisor.flight.vehicle.pieces import pieces
from advisor.flight.vehicle.senders import SenderWatch
from advisor.flight.vehicle.surfaces import Surface
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.words.problems import Problem
from advisor.words.vehicle_time import clock

KEEP_S = 120.0
"""Time for which channels are kept, s: longer than any manoeuvre with its lead-in."""
_OUTPUTS = ("SERVO_OUTPUT_RAW", "ACTUATOR_OUTPUT_STATUS")
_HEARTBEAT_S = 2.2
"""Longest time since the last heartbeat within which a mode has changed, s. One heartbeat may be lost."""


class FlightStream:
    """Follows one vehicle.

    Parameters
    ----------
    aircraft
        The aircraft file: elevator output and calibration, source of the angle of attack.
    target_system
        System id to follow; None: the first vehicle heard.
    marks
        Stretches marked as manoeuvres before the stream begins.
    keep_all
        Whether to keep every sample, for ``power_ons``. Memory then grows with the length of the flight.
    lateral
        Whether to find the manoeuvres of aileron and rudder, too.
    """

    def __init__(
        self,
        aircraft: Aircraft,
        target_system: int | None = None,
        marks: Sequence[Mark] = (),
        *,
        keep_all: bool = False,
        lateral: bool = False,
    ) -> None:
        self._aircraft = aircraft
        self._keep_s = np.inf if keep_all else KEEP_S
        self._clock_heard: list[Master] = []
        self.power_ons: list[PowerOn] = []
        """Every power-on that is over, whole; empty without ``keep_all``."""
        self._who = Identity(aircraft, target_system)
        self._texts = VehicleTexts()
        self._attitudes = Attitudes()
        self._clock = BootClock()
        self._tracks = Tracks(
            aircraft.alpha.source,
            aircraft.airspeed_m_s,
            aircraft.reference.air_temperature_c,
            aircraft.reference.height_m,
            lambda: self._who.simulated,
            aircraft.beta.source,
        )
        self._breaks = Breaks()
        self._cutting = Cutting(self._tracks, self._who, aircraft, self._breaks, lateral)
        self._mixing = Mixing(self._tracks)
        self.marks = Marks(marks)
        """Marks by hand, by a switch and by texts."""
        self._markers = MarkerWatch(aircraft.markers)
        self._path = ElevatorPath(self._tracks, self._mixing, self.marks, self._cutting)
        self._side = SidePath(self._tracks, self.marks, self._cutting) if lateral else None
        self._over = False
        self.boot = 0
        """Number of the power-on, 0 for the first in the stream."""
        self._guesses = ElevatorGuesses()
        self._instruments = InstrumentWatch(self._tracks.cut)
        self._start_boot()
        self.seen: set[str] = set()
        """Names of the messages that the vehicle has sent."""
        self._past: dict[str, ChannelStatus] = {}
        self._service = Service(self._wanting)
        self._senders = SenderWatch()
        self._system: int | None = None
        self._earlier_s = 0.0

    def _start_boot(self) -> None:
        self._tracks.clear()
        self._clock_heard.clear()
        self._path.begin(self.boot)
        if self._side is not None:
            self._side.begin(self.boot)
        self._banks = Banks()
        self._breaks.begin()
        self._mixing.begin()
        self._cutting.begin(self._who.mode)
        self._who.begin()
        self._first_s = np.nan
        self._flown_before = self._cutting.maneuvers
        self._master_s = np.nan
        self._heartbeat_s = -np.inf
        self._guesses.begin()
        self._instruments.begin()

    @property
    def vehicle(self) -> Vehicle | None:
        """Vehicle that is followed. None before its first heartbeat."""
        return self._who.vehicle

    @property
    def other_systems(self) -> frozenset[int]:
        """System ids of the other vehicles heard."""
        return self._who.other_systems

    @property
    def maneuvers(self) -> int:
        """Number of manoeuvres found."""
        return self._cutting.maneuvers

    @property
    def mode(self) -> str:
        """Flight mode of the newest heartbeat."""
        return self._who.mode

    @property
    def elevator(self) -> Surface | Problem:
        """Outputs and scale of the elevator, or the reason for their absence."""
        stated = self._who.elevator
        if isinstance(stated, Problem) or not self._path.heard:
            return stated
        return stated.without(set(stated.outputs) - self._path.heard) or stated

    @property
    def elevator_notes(self) -> tuple[str, ...]:
        """Composition of the elevator and assumptions about its scale and sign, as sentences; those about
        aileron and rudder follow a lateral manoeuvre."""
        sentences = [SAID] if self._cutting.is_backwards else []
        if isinstance(self.elevator, Surface):
            sentences = [self.elevator.said, self._mixing.said(self.elevator), *sentences]
        if self._cutting.side_maneuvers:
            sentences += [surface.said for name, surface in self._who.surfaces.items() if name in LOOPS]
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
        """Arrival of every channel from its present source; at the end of the stream, its best arrival."""
        arriving = self._past if self._over else {**self._past, **self._tracks.statuses()}
        return {
            name: replace(status, provenance=self._who.provenance(status.source, status.provenance))
            for name, status in arriving.items()
        }

    def problems(self) -> list[Problem]:
        """Return the reasons for which the stream so far cannot be used; empty for a usable stream."""
        flown = self._cutting
        found = problems(
            self.vehicle,
            self.other_systems,
            self.elevator,
            self._at_best(),
            flown.maneuvers,
            flown.activities,
            self.frozen,
            self.seen,
        )
        wrong = self._mixing.contradiction
        if self.guess is not None and isinstance(self.elevator, Problem):
            found = [with_guess(problem, self.guess) for problem in found]
        return [
            *(self.marks.problems() if self._over else ()),
            *([self.two_senders] if self.two_senders and not flown.maneuvers else ()),
            *([wrong] if wrong and not flown.maneuvers else ()),
            *found,
        ]

    @property
    def guess(self) -> Guess | None:
        """Guess of the elevator's output, while no parameter states the output."""
        return None if self.vehicle is not None and self.vehicle.is_multicopter else self._guesses.newest

    @property
    def no_data(self) -> tuple[Problem, ...]:
        """Reasons for which the present data cannot serve; empty while they can."""
        return self._service.problems

    def courses(self) -> dict[str, Course]:
        """Return the channels that are shown whole, over this power-on."""
        return self._tracks.courses()

    @property
    def serves(self) -> bool:
        """Whether the present data are known to serve."""
        return self._service.serves

    def _wanting(self, channels: Mapping[str, ChannelStatus], now_s: float) -> list[Problem]:
        """Return the problems of a stream with these channels, whatever was flown on it."""
        wrong = self._mixing.contradiction if not self._cutting.maneuvers else None
        two = self._senders.problem(self._system, now_s) if self._system is not None else None
        # Problems of the vehicle followed come first. The screens offer the other vehicles themselves.
        others = self.other_systems if self.vehicle is None else ()
        found = problems(self.vehicle, others, self.elevator, channels, 1, {}, (), self.seen)
        return [*(problem for problem in (two, wrong) if problem), *found]

    @property
    def two_senders(self) -> Problem | None:
        """Problem of two senders under the vehicle's id, once they were detected."""
        return self._senders.seen

    @property
    def frozen(self) -> list[Distrust]:
        """Channels that have stood still in flight."""
        ranges = {name: (status.lowest, status.highest) for name, status in self._at_best().items()}
        return self._who.distrusts(frozen(ranges))

    @property
    def instruments(self) -> tuple[InstrumentFinding, ...]:
        """Contradictions of the instruments: by the manoeuvres, and before the first by any motion."""
        pitch = self._cutting.findings or (
            self._instruments.findings if self._cutting.maneuvers == self._flown_before else ()
        )
        sideways = self._cutting.side_findings or (
            () if self._cutting.side_maneuvers else self._instruments.side_findings
        )
        known = {f.code for f in pitch}
        return (*pitch, *(f for f in sideways if f.code not in known))

    def recent(self, name: str, seconds: float) -> Channel | None:
        """Return the newest stretch of a channel; None without samples."""
        return self._tracks.recent(name, seconds)

    def so_far(self) -> Maneuver | None:
        """Return the manoeuvre being flown, cut at the newest sample; None between manoeuvres."""
        return self._path.so_far()

    def feed(self, columns: Sequence[Columns]) -> list[FlightEvent]:
        """Take messages; return the events that they cause, in order."""
        events: list[FlightEvent] = []
        several = self._who.may_choose or len({c.system for c in columns if c.name == "HEARTBEAT"}) > 1
        for piece in pieces(self._attitudes.of(columns), by_second=several):
            events += self._feed_piece(piece)
        return events

    def finish(self) -> list[FlightEvent]:
        """Take the end of the messages, and close every open movement."""
        if self._cutting.maneuvers == self._flown_before:
            self._instruments.finish(self._first_s, self._master_s)
        events = self._finish_boot()
        self._service.end()
        self._over = True
        return events

    def _finish_boot(self) -> list[FlightEvent]:
        lateral = self._side.finish() if self._side is not None else []
        events = [*self._path.finish(self._master_s), *lateral, *self._texts.finish(self._master_s)]
        self._past = self._at_best()
        if self._keep_s == np.inf:
            self.power_ons.append(
                power_on(self.boot, self._tracks, self._who, self._cutting.is_backwards, self._clock_heard)
            )
        return events

    def _at_best(self) -> dict[str, ChannelStatus]:
        """Return the arrival of each channel at its fastest, over all power-ons."""
        now = {name: status.at_best(self._past.get(name)) for name, status in self._tracks.statuses().items()}
        return {**self._past, **now}

    def _feed_piece(self, piece: Sequence[Columns]) -> list[FlightEvent]:
        """Take columns within which neither vehicle nor parameters nor mode change."""
        mode = self._who.mode
        flown = self._cutting.maneuvers > self._flown_before
        events: list[FlightEvent] = []
        for columns in piece:
            if columns.name == "STATUSTEXT":
                events += self._texts.heard(columns, self._master_s)
                self._breaks.hear(columns)
        events += self._who.learn(piece, self._master_s, flown)
        vehicle = self._who.vehicle
        if vehicle is None:
            return [*events, *self._serving(piece)]
        if vehicle.system != self._system:
            left = self._start_again(BootClock(self.boot + 1)) if self._system is not None else []
            events = [*left, *events]
            self._system = vehicle.system
            self._service.begin()
        if self._who.mode != mode:
            events.append(ModeChanged(self._who.mode, self._master_s))
            if np.isfinite(self._master_s):
                order = min(int(c.order[0]) for c in piece)
                earliest_s = max(self._heartbeat_s, self._master_s - _HEARTBEAT_S)
                self._path.mode_changed(earliest_s, order)
                if self._side is not None:
                    self._side.mode_changed(earliest_s, order)
                # A pilot who takes over and flies an input at once did so before the heartbeat that reports
                # the mode.
                closed = closes_pitch_loop(self._who.mode)
                self._cutting.change(self._who.mode, self._master_s if closed else earliest_s)
            else:
                self._cutting.begin(self._who.mode)
        mine = [c for c in piece if c.system == vehicle.system]
        self.seen.update(c.name for c in mine)
        for part, master in by_boot(mine, vehicle.component, self._clock, self.boot):
            if master.boot != self.boot:
                events += [*self._start_again(self._clock), Rebooted(self.boot)]
            events += self._feed_part(part, master, vehicle)
        self._senders.hear(mine, vehicle.component)
        return [*events, *self._serving(mine)]

    def _serving(self, piece: Sequence[Columns]) -> list[FlightEvent]:
        """Return the event of a change in the usability of the data; empty without a change."""
        return list(self._service.advance(piece))

    def _take_outputs(
        self, columns: Columns, t: FloatArray, autopilot: str, elevator: list[Commanded], side: list[Decoded]
    ) -> list[Notice]:
        """Append the samples of the elevator, and those of aileron and rudder, to the two lists.

        Return a notice for each time that the advisor missed.
        """
        missed: list[Notice] = []
        for moved in commanded(self._who.surfaces, self._banks.together(columns), t, autopilot):
            if moved.channel == "elevator":
                elevator.append(moved)
                arrived_s = arrivals(columns, moved.order)
                self._service.take(moved.channel, moved.source, arrived_s)
                missed += map(_missed, self._breaks.take(moved.t, arrived_s))
            else:
                side.append(moved.combined())
                self._tracks.append(side[-1])
        return missed

    def _set_clock(self, part: Sequence[Columns], orders: IntArray, clock: FloatArray) -> None:
        """Set the vehicle's clock by a part; readings of the clock have these orders, both of shape (n,)."""
        if np.isnan(self._first_s) and len(clock) > 1:
            self._first_s = float(clock[1])
            self.marks.start_clock(self._first_s)
        self._breaks.take_clock(clock)
        self._master_s = float(clock[-1])
        for columns in part:
            if columns.name == "ATTITUDE":
                now = np.searchsorted(orders, columns.order, side="right") - 1
                self._service.take_clock(columns.arrival_s, clock[now])

    def _start_again(self, clock: BootClock) -> list[FlightEvent]:
        """Begin another power-on, or another vehicle, and drop the earlier state."""
        events = self._finish_boot()
        self._earlier_s = self.duration_s
        self._clock = clock
        self.boot = clock.boot
        self._start_boot()
        self.marks.start_boot(self.boot, self._earlier_s)
        self._markers.start_boot()
        self._service.begin()
        return events

    def _feed_part(self, part: Sequence[Columns], master: Master, vehicle: Vehicle) -> list[FlightEvent]:
        """Take columns of one boot: channels first, then the elevator sample by sample."""
        self._tracks.forget(max(self._path.newest_s, self._master_s) - self._keep_s)
        orders = np.concatenate(([-1], master.order))
        # A late ATTITUDE states its own time, not the present time.
        clock = np.fmax.accumulate(np.concatenate(([self._master_s], master.t)))
        if self._keep_s == np.inf:
            self._clock_heard.append(replace(master, t=clock[1:]))
        elevator: list[Commanded] = []
        side: list[Decoded] = []
        missed: list[FlightEvent] = []
        for columns in merged(part):
            now = np.searchsorted(orders, columns.order, side="right") - 1
            if columns.name in HEARD:
                self.marks.hear(self._markers.heard(columns, stamps(columns, clock[now])))
            companion = columns.component != vehicle.component
            if companion and columns.name not in COMPANIONS:
                continue
            # An onboard computer has a clock of its own.
            t = clock[now] if companion else stamps(columns, clock[now])
            if columns.name == "HEARTBEAT" and np.isfinite(t[-1]):
                self._heartbeat_s = float(t[-1])
            for new in decoded(columns, t, self._aircraft, companion):
                self._tracks.append(new)
                if self._tracks.serves(new):
                    self._service.take(new.channel, new.source, arrivals(columns, new.order))
            if columns.name == "VFR_HUD" and self._tracks.derives_alpha:
                bring = promised(columns, self._aircraft.airspeed_m_s)
                self._service.take("alpha", DERIVED_ALPHA, arrivals(columns, bring))
            if columns.name in _OUTPUTS:
                if isinstance(self.elevator, Problem):
                    self._guesses.hear(columns, t)
                missed += self._take_outputs(columns, t, vehicle.autopilot, elevator, side)
        self._set_clock(part, orders, clock)
        followed = [*missed, *self._path.feed(elevator, closes_pitch_loop(self._who.mode))]
        if self._side is not None:
            followed += self._side.feed(side)
        if self._cutting.maneuvers == self._flown_before:
            self._instruments.advance(self._first_s, self._master_s)
        if not isinstance(self.elevator, Problem) or not np.isfinite(self._master_s):
            return followed
        return [*followed, *self._guesses.advance(self._first_s, self._master_s, self._tracks.cut)]


def _missed(gap: tuple[float, float]) -> Notice:
    begin_s, end_s = gap
    text = f"{end_s - begin_s:.1f} s are missing since {clock(begin_s)}: the advisor was down."
    return Notice("advisor_down", text)
