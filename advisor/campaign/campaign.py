"""The flight test as a pure state machine: columns of messages in, events and a state out."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from advisor.aircraft import Aircraft
from advisor.campaign.hand_decisions import NOTHING, ByHand, Remark
from advisor.campaign.joint_estimate import NEWEST, Together
from advisor.campaign.running_estimate import Settling
from advisor.campaign.servo_lag import learnt as learnt_from
from advisor.campaign.servo_lag import may_learn, reserved
from advisor.campaign.single_maneuver import assess
from advisor.campaign.state import CampaignState, JudgedManeuver
from advisor.decision.course import Course
from advisor.decision.history import Flown
from advisor.decision.judge import judge_campaign
from advisor.decision.stopping import flight_test
from advisor.decision.verdict import FlightTestVerdict
from advisor.event_log import EventLog
from advisor.flight.events import (
    Activity,
    DataAgain,
    FlightBegan,
    FlightEvent,
    ManeuverAgain,
    ManeuverFlown,
    ModeChanged,
    NoData,
    Notice,
    Rebooted,
    VehicleFound,
)
from advisor.flight.flights import Flights
from advisor.flight.identity import READER_NOTICE
from advisor.flight.maneuver import Maneuver
from advisor.flight.marks import MARK_NOTICES, Mark
from advisor.flight.messages import Columns
from advisor.flight.stream import FlightStream
from advisor.oem.estimator import lag_is_unknown
from advisor.oem.solution import Method
from advisor.problems import Problem

NOTICES = 1000
"""Sentences kept for the event log, 0.1 kB each: some hundred manoeuvres with all that is said of them."""


@dataclass(frozen=True, slots=True)
class ManeuverJudged:
    """A manoeuvre was estimated and judged; the flight test decided anew."""

    judged: JudgedManeuver
    flight_test: FlightTestVerdict


CampaignEvent = FlightEvent | ManeuverJudged


class Campaign:
    """Listens, estimates, judges. No input or output, no clock: a log and a live link give the same.

    Parameters
    ----------
    aircraft
        What the crew says of its aircraft.
    target_system
        System id of the vehicle; None: the first one heard.
    settle
        Estimate while a manoeuvre is still being flown, for live faces.
        Verdicts do not depend on it.
    tell
        Called with every event, for whoever announces verdicts.
    method
        How each manoeuvre's optimum is sought: Gauss-Newton, or the paper's simplex.
    by_hand
        What was decided by hand on this flight before.
    marks
        Further marks, which win over those of ``by_hand`` and are not kept with them.
    names
        What the logs of the campaign are called, in their order; empty for a single one.
    """

    def __init__(
        self,
        aircraft: Aircraft,
        target_system: int | None = None,
        settle: bool = False,
        tell: Callable[[CampaignEvent], object] | None = None,
        method: Method = "gauss-newton",
        by_hand: ByHand = NOTHING,
        marks: Sequence[Mark] = (),
        names: Sequence[str] = (),
    ) -> None:
        self._aircraft = aircraft
        self._learnt = aircraft
        self._method: Method = method
        self._tell = tell
        self._flights = Flights(aircraft, target_system, (*marks, *by_hand.marks), names)
        self.by_hand = by_hand
        """Everything that has been decided by hand."""
        self._to_remark = list(by_hand.remarks)
        self._maneuvers: list[Maneuver] = []
        self._history: list[Flown] = []
        self._notices = EventLog(NOTICES)
        self._mark_notes: tuple[str, ...] = ()
        self._reader_notes: tuple[str, ...] = ()
        self._activity: tuple[Activity, ...] = ()
        self._judged: tuple[JudgedManeuver, ...] = ()
        self._course = Course(aircraft.campaign)
        self._flight_test = flight_test((), aircraft.campaign, aircraft, self._course)
        self._together = Together(aircraft)
        self._ended = False
        self._settling = Settling(aircraft) if settle else None

    def feed(self, columns: Sequence[Columns]) -> list[CampaignEvent]:
        """Take the next messages, in order of arrival; how they are cut into batches does not matter."""
        told = self._take(self._flights.feed(columns))
        self._repeat_remarks()
        return told

    def finish(self) -> list[CampaignEvent]:
        """The stream has ended: a manoeuvre that is complete but for its quiet end still counts."""
        if self._stream.marks.by_hand_since_s is not None:
            self.end_maneuver()
        told = self._take(self._flights.finish())
        self._ended = True
        self._decide()
        self._learn()
        for problem in self._stream.marks.problems():
            self._log(str(problem))
        return told

    @property
    def state(self) -> CampaignState:
        """Everything a face may show, as of the newest message."""
        stream, flights = self._stream, self._flights
        flying, channels = flights.so_far(), stream.channels
        settled = self._settling.follow(flying) if self._settling else None
        joined = self._joined
        return CampaignState(
            vehicle=stream.vehicle,
            now_s=stream.now_s,
            duration_s=flights.duration_s,
            mode=stream.mode,
            channels=channels,
            maneuvers=self._judged,
            flight_test=self._flight_test,
            model=self._together.estimate([judged.maneuver for judged in joined]),
            flying=flying,
            marking_since_s=stream.marks.by_hand_since_s,
            settling=settled.estimate if settled else None,
            enough=settled.enough if settled else None,
            estimate_from=tuple(judged.maneuver.number for judged in joined),
            elevator_notes=flights.elevator_notes,
            reader_notes=(
                *self._reader_notes,
                *(f"{d.sentence}; {d.fix}." for d in stream.frozen if not d.stops),
            ),
            elevator_guess=stream.guess if isinstance(stream.elevator, Problem) else None,
            other_vehicles=tuple(sorted(stream.other_systems)),
            no_data=stream.no_data,
            mark_notes=self._mark_notes,
            notices=self._notices.lines,
            notices_before=self._notices.before,
            flight=flights.flight,
            boot=stream.boot,
            flights=flights.heard(channels, self._ended),
            activity=self._activity,
        )

    @property
    def power_on(self) -> tuple[int, int]:
        """Flight and power-on being heard, each 0 for the first."""
        return self._flights.flight, self._stream.boot

    @property
    def problems(self) -> list[Problem]:
        """Why this stream cannot be used, as far as it has been heard; empty when it can."""
        return self._flights.problems()

    def exclude(self, number: int, because: str) -> None:
        """Take a manoeuvre out of every decision; all that followed is decided again."""
        self._decide_by_hand(number, because)

    def include(self, number: int) -> None:
        """Take an excluded manoeuvre in again."""
        self._decide_by_hand(number, None)

    def mark(self, text: str) -> None:
        """Set a mark in the event log at the newest vehicle time."""
        if math.isfinite(self._now_s):
            here = Remark(self._now_s, text, self._stream.boot, self._flights.flight)
            self.by_hand = self.by_hand.remarking(here)
        self._log(f"mark: {text}", self._stream.now_s)

    def begin_maneuver(self) -> None:
        """Mark a manoeuvre from the newest vehicle time on; a mark that is open already is dropped."""
        if not math.isfinite(self._now_s):
            self._log("nothing can be marked before the vehicle's clock is heard")
            return
        self._stream.marks.begin_by_hand(self._now_s)
        self._log("a manoeuvre is marked from here", self._stream.now_s)

    def end_maneuver(self) -> None:
        """End the mark at the newest vehicle time; its manoeuvre is judged when all of it has arrived."""
        ended = self._stream.marks.end_by_hand(self._now_s)
        if isinstance(ended, Notice):
            self._log(ended.text, self._stream.now_s)
            return
        self.by_hand = self.by_hand.marking(replace(ended, flight=self._flights.flight))
        self._log(f"a manoeuvre is marked from {ended.start_s:.1f} s to here", self._stream.now_s)

    def note(self, number: int, text: str) -> None:
        """Write a note beside a manoeuvre."""
        self.by_hand = self.by_hand.noting(self._maneuvers[self._index(number)], text)
        self._log(f"note on manoeuvre {number}: {text}", self._stream.now_s)
        self._decide()

    def _take(self, events: Sequence[FlightEvent]) -> list[CampaignEvent]:
        told: list[CampaignEvent] = []
        for event in events:
            told.append(event)
            match event:
                case ManeuverFlown(maneuver):
                    self._maneuvers.append(maneuver)
                    flown = assess(maneuver, self._learnt, self._method)
                    because = self.by_hand.excluded_because(maneuver)
                    self._history.append(replace(flown, excluded_because=because))
                    self._decide()
                    self._learn()
                    told.append(ManeuverJudged(self._judged[-1], self._flight_test))
                    ended_s = maneuver.span.end_s
                    self._log(f"manoeuvre {maneuver.number}: {self._judged[-1].verdict.sentence}", ended_s)
                    self._log(self._flight_test.sentence, ended_s)
                case Activity():
                    joined = event.joined(self._activity[-1]) if self._activity else None
                    self._activity = (*self._activity[:-1], joined) if joined else (*self._activity, event)
                case ModeChanged(mode, at_s):
                    self._log(f"mode {mode}", at_s)
                case Notice(code, text):
                    self._log(text)
                    if code in MARK_NOTICES:
                        self._mark_notes += (text,)
                    if code == READER_NOTICE:
                        self._reader_notes += (text,)
                case NoData(problems):
                    for problem in problems:
                        self._log(f"NO DATA: {problem}", self._stream.now_s)
                case DataAgain():
                    self._log("the data serve again", self._stream.now_s)
                case VehicleFound(vehicle):
                    self._log(f"following {vehicle}")
                case ManeuverAgain():
                    told += self._heard_again(event)
                case FlightBegan(flight, name):
                    self._log(f"{name}: flight {flight + 1} begins")
                case Rebooted(boot):
                    self._log(f"the vehicle's clock went back, as after a reboot: power-on {boot + 1}")
        if self._tell is not None:
            for happened in told:
                self._tell(happened)
        return told

    def _heard_again(self, event: ManeuverAgain) -> list[CampaignEvent]:
        """A manoeuvre came a second time: the better record counts, and stays out if one of them does."""
        maneuver = event.maneuver
        i = self._index(maneuver.number)
        known = self._history[i].excluded_because
        because = known if known is not None else self.by_hand.excluded_because(maneuver)
        where = f" in {self._flights.name}" if self._flights.name else ""
        better = "; this record holds more and takes the place" if event.takes_place else ""
        self._log(
            f"manoeuvre {maneuver.number} comes again{where}: it counts once{better}", maneuver.span.end_s
        )
        if not event.takes_place and because == known:
            return []
        if event.takes_place:
            self._maneuvers[i] = maneuver
            self._history[i] = assess(maneuver, self._learnt, self._method)
        self._history[i] = replace(self._history[i], excluded_because=because)
        self._decide()
        self._learn()
        return [ManeuverJudged(self._judged[i], self._flight_test)] if event.takes_place else []

    @property
    def _stream(self) -> FlightStream:
        """The flight being heard."""
        return self._flights.stream

    @property
    def _now_s(self) -> float:
        """Newest vehicle time to the millisecond, as the vehicle's clock counts and a file keeps."""
        return round(self._stream.now_s, 3)

    def _repeat_remarks(self) -> None:
        """Write the moments marked before into the event log, each at its time."""
        now = (self._flights.flight, self._stream.boot, self._stream.now_s)
        for remark in [r for r in self._to_remark if (r.flight, r.boot, r.at_s) <= now]:
            self._to_remark.remove(remark)
            self._log(f"mark: {remark.text}", remark.at_s)

    def _decide(self) -> None:
        plan = self._aircraft.campaign
        verdicts = judge_campaign(self._history, plan, self._course)
        judged = (
            JudgedManeuver(
                maneuver,
                flown.estimate,
                verdict,
                flown.excluded_because,
                self.by_hand.notes_on(maneuver),
            )
            for maneuver, flown, verdict in zip(self._maneuvers, self._history, verdicts, strict=True)
        )
        self._judged = tuple(judged)
        self._flight_test = flight_test(self._history, plan, self._aircraft, self._course)
        if lag_is_unknown(self._learnt):
            model = self._together.estimate([judged.maneuver for judged in self._joined])
            self._judged = tuple(
                replace(judged, verdict=reserved(judged.verdict, judged.estimate, model))
                for judged in self._judged
            )

    @property
    def _joined(self) -> Sequence[JudgedManeuver]:
        """The manoeuvres that are estimated together: the newest accepted ones, at the end all."""
        accepted = [judged for judged in self._judged if judged.verdict.accepted]
        return accepted if self._ended else accepted[-NEWEST:]

    def _learn(self) -> None:
        """Examine all manoeuvres again when they have told more of the instruments."""
        joined = self._joined
        all_of_them = len(joined) == sum(judged.verdict.accepted for judged in self._judged)
        if not may_learn(self._learnt, all_of_them):
            return
        model = self._together.estimate([judged.maneuver for judged in joined])
        learnt = learnt_from(self._learnt, model, exactly=self._ended)
        if learnt is self._learnt:
            return
        self._learnt = learnt
        again = [assess(maneuver, learnt, self._method) for maneuver in self._maneuvers]
        self._history = [
            replace(flown, excluded_because=before.excluded_because)
            for flown, before in zip(again, self._history, strict=True)
        ]
        lag = learnt.elevator.lag_found_s
        self._log(
            f"the servo's lag is {lag:.3f} s by all manoeuvres together; every estimate uses it now;"
            f" for the aircraft file: elevator: {{lag_s: {lag:.3f}}}"
        )
        self._decide()

    def _decide_by_hand(self, number: int, because: str | None) -> None:
        i = self._index(number)
        self._history[i] = replace(self._history[i], excluded_because=because)
        self.by_hand = self.by_hand.excluding(self._maneuvers[i], because)
        what = "included again" if because is None else f"excluded: {because}"
        self._log(f"manoeuvre {number} {what}", self._stream.now_s)
        self._decide()
        self._learn()

    def _log(self, text: str, at_s: float = math.nan) -> None:
        self._notices.add([f"{at_s:.1f} s: {text}" if math.isfinite(at_s) else text])

    def _index(self, number: int) -> int:
        return [maneuver.number for maneuver in self._maneuvers].index(number)
