"""Stream of one vehicle: columns of messages as input, channels and manoeuvres as output.

Every decision depends on the order of arrival and the vehicle's clock, never on batches. A live link, message
by message, and a whole log give equal events. Memory is bounded by two minutes of channels.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.flight.elevator.mixing import Commanded, commanded
from advisor.flight.maneuvers.maneuver import FlightEvent, ModeChanged, Notice, Rebooted
from advisor.flight.maneuvers.markers import HEARD
from advisor.flight.signals.channels import COMPANIONS, Decoded, merged, stamps
from advisor.flight.signals.clocks import BootClock
from advisor.flight.signals.derived_alpha import DERIVED_ALPHA, promised
from advisor.flight.signals.messages import Columns, arrivals
from advisor.flight.stream.elevator_path import decoded, power_on
from advisor.flight.stream.state import StreamState
from advisor.flight.vehicle.modes import closes_pitch_loop
from advisor.flight.vehicle.pieces import Master, by_boot, pieces
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.process.arrays import FloatArray, IntArray
from advisor.words.problems import Problem
from advisor.words.quantities import clock

_OUTPUTS = ("SERVO_OUTPUT_RAW", "ACTUATOR_OUTPUT_STATUS")
_HEARTBEAT_S = 2.2
"""Longest time since the last heartbeat in which the mode may have changed, s. One heartbeat may be lost."""


class FlightStream(StreamState):
    """Follows one vehicle.

    Parameters
    ----------
    aircraft
        Aircraft file, with the elevator's output and calibration, and the source of the angle of attack.
    target_system
        System id to follow; None for the first vehicle that sends.
    keep_all
        Whether every sample is kept, for ``power_ons``. With all samples, the memory grows with the length of
        the flight.
    guesses_sides
        Whether the outputs of aileron and rudder are guessed, for a new aircraft file.
    """

    def feed(self, columns: Sequence[Columns]) -> list[FlightEvent]:
        """Take messages, and return the events that follow from them, in order."""
        events: list[FlightEvent] = []
        several = self._who.may_choose or len({c.system for c in columns if c.name == "HEARTBEAT"}) > 1
        for piece in pieces(self._attitudes.of(columns), by_second=several):
            events += self._feed_piece(piece)
        return events

    def finish(self) -> list[FlightEvent]:
        """Handle the end of the messages, and close every open movement."""
        if self._cutting.pitch.counted == self._flown_before:
            self._instruments.finish(self._first_s, self._master_s)
        events = [*self._finish_boot(), *self._asked.finish()]
        self.service.end()
        self._over = True
        return events

    def _finish_boot(self) -> list[FlightEvent]:
        flown = self._path.finish(self._master_s)
        lateral = self._side.finish() if self._side is not None else []
        events = [*flown, *lateral, *self._texts.finish(self._master_s)]
        self._past = self._at_best()
        if self._keep_s == np.inf:
            self.power_ons.append(
                power_on(
                    self.boot,
                    self.tracks,
                    self._who,
                    self._cutting.is_backwards,
                    self._clock_heard,
                    self._modes,
                )
            )
        return events

    def _feed_piece(self, piece: Sequence[Columns]) -> list[FlightEvent]:
        """Process columns within which vehicle, parameters and mode are constant."""
        mode = self._who.mode
        flown = self._cutting.pitch.counted > self._flown_before
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
            self.service.begin()
        if self._who.mode != mode:
            events.append(ModeChanged(self._who.mode, self._master_s))
            self._modes.append((self._master_s, self._who.mode))
            if np.isfinite(self._master_s):
                order = min(int(c.order[0]) for c in piece)
                earliest_s = max(self._heartbeat_s, self._master_s - _HEARTBEAT_S)
                self._path.mode_changed(earliest_s, order)
                if self._side is not None:
                    self._side.mode_changed(earliest_s, order)
                # A pilot who takes over and flies an input at once did so before the heartbeat that reports
                # the mode.
                closed = closes_pitch_loop(self._who.mode)
                self._cutting.records.change(self._who.mode, self._master_s if closed else earliest_s)
            else:
                self._cutting.begin(self._who.mode)
        mine = [c for c in piece if c.system == vehicle.system]
        self.seen.update(c.name for c in mine)
        for part, master in by_boot(mine, vehicle.component, self._clock, self.boot):
            if master.boot != self.boot:
                events += [*self._start_again(self._clock), Rebooted(self.boot)]
            events += self._feed_part(part, master, vehicle)
        self.senders.hear(mine, vehicle.component)
        return [*events, *self._serving(mine)]

    def _serving(self, piece: Sequence[Columns]) -> list[FlightEvent]:
        """Return the event of changed data usability; empty without a change."""
        return list(self.service.advance(piece))

    def _take_outputs(
        self, columns: Columns, t: FloatArray, autopilot: str, elevator: list[Commanded], side: list[Decoded]
    ) -> list[Notice]:
        """Append the samples of elevator, aileron and rudder to two lists; return notices of down time."""
        missed: list[Notice] = []
        for moved in commanded(self._who.outputs.counted, self._banks.together(columns), t, autopilot):
            if moved.channel == "elevator":
                elevator.append(moved)
                arrived_s = arrivals(columns, moved.order)
                self.service.take(moved.channel, moved.source, arrived_s)
                missed += map(_missed, self._breaks.take(moved.t, arrived_s))
            else:
                side.append(moved.combined())
                self.tracks.append(side[-1])
        return missed

    def _set_clock(self, part: Sequence[Columns], orders: IntArray, clock: FloatArray) -> None:
        """Set the vehicle's clock from clock readings with their arrival orders, both of shape (n,)."""
        if np.isnan(self._first_s) and len(clock) > 1:
            self._first_s = float(clock[1])
            self.marks.start_clock(self._first_s)
        self._breaks.take_clock(clock)
        self._master_s = float(clock[-1])
        for columns in part:
            if columns.name == "ATTITUDE":
                now = np.searchsorted(orders, columns.order, side="right") - 1
                self.service.take_clock(columns.arrival_s, clock[now])

    def _start_again(self, clock: BootClock) -> list[FlightEvent]:
        """Begin another power-on, or another vehicle, and drop the earlier state."""
        events = self._finish_boot()
        self._earlier_s = self.duration_s
        self._clock = clock
        self.boot = clock.boot
        self._start_boot()
        self.marks.start_boot(self.boot, self._earlier_s)
        self._markers.start_boot()
        self.service.begin()
        return events

    def _feed_part(self, part: Sequence[Columns], master: Master, vehicle: Vehicle) -> list[FlightEvent]:
        """Process columns of one boot: channels first, then the elevator sample by sample."""
        self.tracks.forget(max(self._path.newest_s, self._master_s) - self._keep_s)
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
            self._asked.hear(columns)
            for new in decoded(columns, t, self._aircraft, companion):
                self.tracks.append(new)
                if self.tracks.serves(new):
                    self._asked.take(new)
                    self.service.take(new.channel, new.source, arrivals(columns, new.order))
            if columns.name == "VFR_HUD" and self.tracks.derives_alpha:
                bring = promised(columns, self._aircraft.airspeed_m_s)
                self.service.take("alpha", DERIVED_ALPHA, arrivals(columns, bring))
            if columns.name in _OUTPUTS:
                if self._guesses.guesses_sides or isinstance(self.elevator, Problem):
                    self._guesses.hear(columns, t)
                missed += self._take_outputs(columns, t, vehicle.autopilot, elevator, side)
        self._set_clock(part, orders, clock)
        followed = [*missed, *self._path.feed(elevator, closes_pitch_loop(self._who.mode))]
        if self._side is not None:
            followed += self._side.feed(side)
        if self._cutting.pitch.counted == self._flown_before:
            self._instruments.advance(self._first_s, self._master_s)
        guesses = self._guesses.guesses_sides or isinstance(self.elevator, Problem)
        if not guesses or not np.isfinite(self._master_s):
            return followed
        guessed = self._guesses.advance(self._first_s, self._master_s, self.tracks.cut)
        return [*followed, *(guessed if isinstance(self.elevator, Problem) else ())]


def _missed(gap: tuple[float, float]) -> Notice:
    begin_s, end_s = gap
    text = f"{end_s - begin_s:.1f} s are missing since {clock(begin_s)}: the advisor was down."
    return Notice("advisor_down", text)
