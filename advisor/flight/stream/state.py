"""State of a stream: the vehicle's outputs, channels, problems and contradicted instruments."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft, ScriptIdentity
from advisor.flight.elevator.elevator_guess import SAID, ElevatorGuesses, Guess
from advisor.flight.elevator.mixing import Mixing
from advisor.flight.instruments.axes.side_instruments import examine_side
from advisor.flight.instruments.examination import examine
from advisor.flight.instruments.examined import ExaminedRecords
from advisor.flight.maneuvers.maneuver import Maneuver, VehicleSaid
from advisor.flight.maneuvers.markers import MarkerWatch
from advisor.flight.maneuvers.marks import Mark, Marks
from advisor.flight.signals.channels import Banks
from advisor.flight.signals.clocks import Attitudes, BootClock
from advisor.flight.signals.messages import LONGEST, Columns, WholeTexts
from advisor.flight.signals.record import UNITS, Channel
from advisor.flight.signals.track import ChannelStatus, PowerOn
from advisor.flight.signals.tracks import Tracks
from advisor.flight.signals.trust import Distrust, InstrumentFinding, frozen
from advisor.flight.stream.cutting import Cutting
from advisor.flight.stream.elevator_path import LOOPS, AskedSources, ElevatorPath, SidePath
from advisor.flight.stream.identity import READER, Identity
from advisor.flight.stream.maneuver_records import ManeuverRecords
from advisor.flight.stream.suitability import Service, problems, with_guess
from advisor.flight.vehicle.following import FOLLOW, TAKE, SenderWatch
from advisor.flight.vehicle.pieces import DOWN, Breaks, Master
from advisor.flight.vehicle.surfaces import Surface
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.words.problems import Problem, printable

_EVERY_S = 10.0
"""Length of an examined stretch, s: one to two periods of a slow short period."""
_LATE_S = 1.0
"""Length of the newest flight that an examination leaves out, s, because packets may still arrive."""
_ENOUGH = 6
"""Number of stretches with motion after which the watch ends. Errors are then well below the scatter between
instruments."""


class InstrumentWatch:
    """Examination of the instruments, one stretch of the flight after another.

    The stretches end at fixed vehicle times, so that the batches of a log change no result.

    Parameters
    ----------
    cut
        Function that returns a stretch of a channel by name, start and end, s.
    """

    def __init__(self, cut: Callable[[str, float, float], Channel | None]) -> None:
        self._cut = cut
        self.begin()

    def begin(self) -> None:
        """Begin another power-on, or follow another vehicle."""
        self.pitch, self.sideways = ExaminedRecords(examine), ExaminedRecords(examine_side)
        """All stretches so far. No finding is marked as used, because these records give no estimate."""
        self._at_s = -np.inf
        self._moving = 0

    def advance(self, first_s: float, now_s: float) -> None:
        """Make every due examination; vehicle times of the first and the newest message, s."""
        while self._moving < _ENOUGH and now_s - _LATE_S >= max(self._at_s, first_s) + _EVERY_S:
            rate = self._cut("q", max(self._at_s, first_s), now_s - _LATE_S)
            if rate is None:
                return
            end_s = _EVERY_S * (np.floor(rate.t[0] / _EVERY_S) + 1.0)
            if end_s > now_s - _LATE_S:
                return
            self._examine(end_s - _EVERY_S, end_s)
            self._at_s = end_s

    def finish(self, first_s: float, now_s: float) -> None:
        """Examine the last stretch at the end of the stream."""
        self.advance(first_s, now_s)
        if np.isfinite(first_s) and self._moving < _ENOUGH:
            self._examine(max(self._at_s, first_s), now_s)

    def _examine(self, start_s: float, end_s: float) -> None:
        cuts = {name: self._cut(name, start_s, end_s) for name in UNITS}
        channels = {name: c for name, c in cuts.items() if c is not None}
        for stretches in (self.pitch, self.sideways):
            examined = stretches.examined(channels)
            self._moving += "theta_scale" in examined.evidence
            if examined.evidence:
                stretches.count(examined.evidence, examined.findings)


SEVERITIES = ("emergency", "alert", "critical", "error", "warning", "notice", "info", "debug")
"""Names of MAV_SEVERITY 0 to 7 (MAVLink common.xml)."""

_OWN = (READER, FOLLOW, TAKE, DOWN)
"""Beginnings of the texts that the advisor writes into its own stream."""


class VehicleTexts:
    """Whole texts of every sender, as events."""

    def __init__(self) -> None:
        self._texts = WholeTexts()

    def heard(self, columns: Columns, at_s: float) -> Iterator[VehicleSaid]:
        """Yield the texts that these messages complete.

        Parameters
        ----------
        columns
            STATUSTEXT of one sender, in order of arrival.
        at_s
            Vehicle time of the newest sample, s since boot; NaN before the first.
        """
        sender = (columns.system, columns.component)
        for whole in self._texts.heard(columns, np.full(len(columns.order), at_s)):
            yield from _said(sender, whole.severity, whole.text, at_s)

    def finish(self, at_s: float) -> Iterator[VehicleSaid]:
        """Yield the texts whose last chunk did not arrive."""
        for sender, whole in self._texts.finish():
            yield from _said(sender, whole.severity, whole.text, at_s)


def _said(sender: tuple[int, int], severity: int, raw: bytes, at_s: float) -> Iterator[VehicleSaid]:
    text = printable(raw.decode("utf-8", "replace")).strip()
    if not text or raw.startswith(_OWN):
        return
    if len(text) > LONGEST:
        text = f"{text[: LONGEST - 1]}…"
    name = SEVERITIES[severity] if severity < len(SEVERITIES) else ""
    yield VehicleSaid(text, name, *sender, at_s)


KEEP_S = 120.0
"""Time for which channels are kept, s: longer than any manoeuvre with its lead-in."""


class StreamState:
    """Parts of a stream, and the present knowledge of its vehicle; `FlightStream` updates it."""

    def __init__(
        self,
        aircraft: Aircraft,
        target_system: int | None = None,
        marks: Sequence[Mark] = (),
        *,
        keep_all: bool = False,
        lateral: bool = False,
        guesses_sides: bool = False,
    ) -> None:
        self._aircraft = aircraft
        self._asked = AskedSources(aircraft)
        self._keep_s = np.inf if keep_all else KEEP_S
        self._clock_heard: list[Master] = []
        self.power_ons: list[PowerOn] = []
        """Every finished power-on with all data; empty without ``keep_all``."""
        self._who = Identity(aircraft, target_system)
        self._texts = VehicleTexts()
        self._attitudes = Attitudes()
        self._clock = BootClock()
        self.tracks = Tracks(
            aircraft.alpha.source,
            aircraft.airspeed_m_s,
            aircraft.reference.air_temperature_c,
            aircraft.reference.height_m,
            lambda: self._who.simulated,
            aircraft.beta.source,
        )
        """Channels of this power-on, the newest stretch of each."""
        self._breaks = Breaks()
        identity = ScriptIdentity.of(aircraft)
        self.marks = Marks(marks, None if identity == ScriptIdentity.of(Aircraft()) else identity)
        """Marks by hand, by a switch, by texts and by a script."""
        self._cutting = Cutting(
            ManeuverRecords(self.tracks, self._who, self._breaks), aircraft, self.marks, lateral
        )
        self._mixing = Mixing(self.tracks)
        self._markers = MarkerWatch(aircraft.markers)
        self._path = ElevatorPath(self.tracks, self._mixing, self.marks, self._cutting)
        self._side = SidePath(self.tracks, self.marks, self._cutting) if lateral else None
        self._over = False
        self.boot = 0
        """Number of the present power-on, 0 for the first in the stream."""
        self._guesses = ElevatorGuesses(guesses_sides)
        self._instruments = InstrumentWatch(self.tracks.cut)
        self._start_boot()
        self.seen: set[str] = set()
        """Names of the messages that the vehicle has sent."""
        self._past: dict[str, ChannelStatus] = {}
        self.service = Service(self._wanting)
        """Usability of the present data."""
        self.senders = SenderWatch()
        """Watch for a second sender under the vehicle's id."""
        self._system: int | None = None
        self._earlier_s = 0.0

    def _start_boot(self) -> None:
        self.tracks.clear()
        self._clock_heard.clear()
        self._path.begin(self.boot)
        if self._side is not None:
            self._side.begin(self.boot)
        self._banks = Banks()
        self._breaks.begin()
        self._mixing.begin()
        self._cutting.begin(self._who.mode)
        self._who.outputs.begin()
        self._first_s = np.nan
        self._flown_before = self._cutting.pitch.counted
        self._master_s = np.nan
        self._modes: list[tuple[float, str]] = [(np.nan, self._who.mode)]
        self._heartbeat_s = -np.inf
        self._guesses.begin()
        self._instruments.begin()

    @property
    def vehicle(self) -> Vehicle | None:
        """Followed vehicle. None before its first heartbeat."""
        return self._who.vehicle

    @property
    def other_systems(self) -> frozenset[int]:
        return self._who.other_systems

    @property
    def maneuvers(self) -> int:
        """Number of manoeuvres found."""
        return self._cutting.pitch.counted

    @property
    def mode(self) -> str:
        """Flight mode of the newest heartbeat."""
        return self._who.mode

    @property
    def elevator(self) -> Surface | Problem:
        """Outputs and scale of the elevator, or the reason for their absence."""
        stated = self._who.outputs.elevator
        if isinstance(stated, Problem) or not self._path.heard:
            return stated
        return stated.without(set(stated.outputs) - self._path.heard) or stated

    @property
    def elevator_notes(self) -> tuple[str, ...]:
        """Sentences about the elevator's outputs, assumed scale and sign, then about aileron and rudder."""
        sentences = [SAID] if self._cutting.is_backwards else []
        if isinstance(self.elevator, Surface):
            sentences = [self.elevator.said, self._mixing.said(self.elevator), *sentences]
        if self._cutting.sideways.counted:
            sentences += [
                surface.said for name, surface in self._who.outputs.counted.items() if name in LOOPS
            ]
        return tuple(said for said in sentences if said)

    @property
    def sides_unknown(self) -> Problem | None:
        """Reason why aileron or rudder cannot be followed; None if their outputs are known."""
        return self._who.outputs.sides_unknown

    @property
    def now_s(self) -> float:
        """Vehicle time of the newest sample, s since boot; NaN before the first."""
        return self._clock.newest_s

    @property
    def duration_s(self) -> float:
        """Vehicle time received so far over all boots, s."""
        return self._earlier_s + (self._master_s - self._first_s if np.isfinite(self._master_s) else 0.0)

    @property
    def channels(self) -> Mapping[str, ChannelStatus]:
        """Arrival status of every channel; at the end of the stream, the best status."""
        arriving = self._past if self._over else {**self._past, **self.tracks.statuses()}
        return {
            name: replace(status, provenance=self._who.provenance(status.source, status.provenance))
            for name, status in arriving.items()
        }

    def problems(self) -> list[Problem]:
        """Return the reasons why the stream so far cannot be used; empty for a usable stream."""
        flown = self._cutting
        obstacles = problems(
            self.vehicle,
            self.other_systems,
            self.elevator,
            self._at_best(),
            flown.pitch.counted,
            flown.activities,
            self.frozen,
            self.seen,
        )
        wrong = self._mixing.contradiction
        if self.guess is not None and isinstance(self.elevator, Problem):
            obstacles = [with_guess(problem, self.guess) for problem in obstacles]
        return [
            *(self.marks.problems() if self._over else ()),
            *([self.senders.seen] if self.senders.seen and not flown.pitch.counted else ()),
            *([wrong] if wrong and not flown.pitch.counted else ()),
            *obstacles,
        ]

    @property
    def guess(self) -> Guess | None:
        """Guess of the elevator's output, while no parameter states it."""
        return None if self.vehicle is not None and self.vehicle.is_multicopter else self._guesses.newest

    @property
    def side_guesses(self) -> Mapping[str, Guess]:
        """Guesses of the aileron's and the rudder's output; empty unless they were asked for."""
        return self._guesses.sides

    def _wanting(self, channels: Mapping[str, ChannelStatus], now_s: float) -> list[Problem]:
        """Return the problems of a stream with these channels, without a test for manoeuvres."""
        wrong = self._mixing.contradiction if not self._cutting.pitch.counted else None
        two = self.senders.problem(self._system, now_s) if self._system is not None else None
        # Problems of the vehicle followed come first. The screens offer the other vehicles themselves.
        others = self.other_systems if self.vehicle is None else ()
        obstacles = problems(self.vehicle, others, self.elevator, channels, 1, {}, (), self.seen)
        return [*(problem for problem in (two, wrong) if problem), *obstacles]

    @property
    def frozen(self) -> list[Distrust]:
        """Channels that were frozen in flight."""
        ranges = {name: (status.lowest, status.highest) for name, status in self._at_best().items()}
        return self._who.distrusts(frozen(ranges))

    @property
    def instruments(self) -> tuple[InstrumentFinding, ...]:
        """Contradictions of the instruments from the manoeuvres, or before the first one from any motion."""
        pitch = self._cutting.pitch.findings or (
            self._instruments.pitch.findings if self._cutting.pitch.counted == self._flown_before else ()
        )
        sideways = self._cutting.sideways.findings or (
            () if self._cutting.sideways.counted else self._instruments.sideways.findings
        )
        codes = {f.code for f in pitch}
        return (*pitch, *(f for f in sideways if f.code not in codes))

    def so_far(self) -> Maneuver | None:
        """Return the present manoeuvre, cut at the newest sample; None between manoeuvres."""
        return self._path.so_far()

    def _at_best(self) -> dict[str, ChannelStatus]:
        """Return the best arrival status of each channel over all power-ons."""
        now = {name: status.at_best(self._past.get(name)) for name, status in self.tracks.statuses().items()}
        return {**self._past, **now}
