"""The flight test as a pure state machine, which turns columns of messages into events and a state."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.axis_campaign import AxisCampaign, ElevatorCampaign, LateralCampaign
from advisor.campaign.engineer import OF, Engineer
from advisor.campaign.journal import Journal
from advisor.campaign.single_maneuver import Axes, BeingFlown, InputEnough, side_signs, together, with_fit
from advisor.campaign.state import (
    NOTHING,
    OF_ELEVATOR,
    AxisState,
    ByHand,
    CampaignState,
    JudgedManeuver,
    WholeFlights,
    has_begun,
)
from advisor.decision.verdict import CrewPlan, FlightTestVerdict, crew_plan
from advisor.flight.maneuvers.maneuver import (
    Activity,
    FlightEvent,
    Maneuver,
    ManeuverAgain,
    ManeuverFlown,
    ModeChanged,
    Notice,
    SideManeuverFlown,
)
from advisor.flight.maneuvers.marks import Mark
from advisor.flight.signals.messages import Columns
from advisor.flight.signals.trust import InstrumentFinding
from advisor.flight.stream.flights import Flights
from advisor.flight.stream.stream import FlightStream
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.process.aside import Aside
from advisor.process.parts import Parts
from advisor.words.axes import AxisName
from advisor.words.problems import Problem
from advisor.words.quantities import clock

_TEST_OF: Mapping[AxisName, str] = {"pitch": "", "lateral": "roll and yaw: "}
"""Words before the decision on a test, by the name of its axis."""


@dataclass(frozen=True, slots=True)
class ManeuverJudged:
    """A manoeuvre was estimated and judged, and the flight test was decided again."""

    judged: JudgedManeuver
    flight_test: FlightTestVerdict
    plan: CrewPlan | None = None
    """Plan of both axes; None if only one axis has been flown."""
    axis: AxisName = "pitch"
    revised: tuple[str, ...] = ()
    """Sentences about earlier manoeuvres whose verdict changed, each with its reason."""


@dataclass(frozen=True, slots=True)
class _Verdicts:
    """Verdicts of the manoeuvres that have been judged so far."""

    axes: Mapping[AxisName, AxisState[Any]]
    maneuvers: tuple[Maneuver, ...]
    """Manoeuvres of all axes."""
    estimates: tuple[Estimate | NoEstimate, ...]
    """Estimates of the elevator's manoeuvres."""


CampaignEvent = FlightEvent | ManeuverJudged | InputEnough


class Campaign:
    """Finds, estimates and judges the manoeuvres of a flight test. The class does no input or output and has
    no clock, so that a log and a live link give equal results.

    Parameters
    ----------
    target_system
        System id of the vehicle; None for the first vehicle that sends.
    informs
        Whether to compute the information of the input that is being flown, for live displays. With ``tell``
        it is always computed. Verdicts do not depend on it.
    marks
        Further marks, which replace overlapping marks of ``by_hand`` and are not kept in a file.
    names
        Names of the campaign's logs, in their order; empty for a single log.
    advises
        Whether roll and yaw are estimated jointly after every manoeuvre, for the advice to stop; else only at
        the end.
    aside
        Judge manoeuvres in another thread while the stream is read on, for screens. Verdicts and numbers do
        not depend on this option, and come when they are ready.
    """

    def __init__(
        self,
        aircraft: Aircraft,
        target_system: int | None = None,
        informs: bool = False,
        tell: Callable[[CampaignEvent], object] | None = None,
        by_hand: ByHand = NOTHING,
        marks: Sequence[Mark] = (),
        names: Sequence[str] = (),
        lateral: bool = False,
        advises: bool = True,
        aside: bool = False,
    ) -> None:
        self._journal = Journal()
        self._parts = Parts(lambda failed: self._journal.write(str(failed.problem)))
        self._elevator = ElevatorCampaign(aircraft, self._journal.write, self._parts)
        self._lateral = LateralCampaign(aircraft, self._parts, advises) if lateral else None
        self._axes: Mapping[AxisName, AxisCampaign] = {
            "pitch": self._elevator,
            "lateral": self._lateral or self._elevator,
        }
        """Campaign of each axis; without roll and yaw, both are the elevator's."""
        self._aircraft = aircraft
        self._tell = tell
        self._flights = Flights(aircraft, target_system, (*marks, *by_hand.marks), names, lateral)
        self._engineer = Engineer(self._flights, self._journal, self._axes, by_hand)
        self._aside: Aside[ManeuverJudged] = Aside(aside)
        self._activity: tuple[Activity, ...] = ()
        self._whole_flights = WholeFlights()
        self._ended = False
        informs = informs or tell is not None
        self._being_flown = BeingFlown(aircraft, self._flights, self._parts, informs, aside)
        self._outputs_unknown: Problem | None = None
        self._shown: _Verdicts | None = None

    def feed(self, columns: Sequence[Columns]) -> list[CampaignEvent]:
        """Process the next messages, in order of arrival. The result does not depend on how the messages are
        grouped."""
        events = self._take(self._flights.feed(columns))
        if (enough := self._being_flown.enough(self._axes_before)) is not None:
            events.append(enough)
            if self._tell is not None:
                self._tell(enough)
        self._engineer.repeat_remarks()
        return events

    @property
    def is_judging(self) -> bool:
        """Whether a manoeuvre has been flown whose verdict has not been announced."""
        return self._aside.is_pending

    @property
    def judging_s(self) -> float:
        """Time for which one manoeuvre is being judged, s."""
        return self._aside.age_s

    def wait(self) -> None:
        """Return when every manoeuvre so far has been judged."""
        self._aside.wait()

    @property
    def engineer(self) -> Engineer:
        """The engineer, whose decisions count in all verdicts."""
        self.wait()
        return self._engineer

    def finish(self) -> list[CampaignEvent]:
        """End the stream. A manoeuvre that lacks only the rest at its end is still used."""
        if self._stream.marks.by_hand_since_s is not None:
            self._engineer.end_maneuver()
        events = self._take(self._flights.finish())
        self.wait()
        events += self._take(())
        self._ended = True
        for campaign in filter(None, (self._elevator, self._lateral)):
            campaign.finish()
            events += self._revised_at_the_end(campaign)
        for problem in self._stream.marks.problems():
            self._journal.write(str(problem))
        return events

    @property
    def state(self) -> CampaignState:
        """State after the newest message, as shown on screens."""
        stream, flights = self._stream, self._flights
        flying, channels = flights.so_far(), stream.channels
        heard = flights.heard(channels, self._ended)
        unknown = [flight.sides_unknown for flight in heard]
        self._outputs_unknown = unknown[-1] if all(unknown) else None
        shown = self._so_far()
        instruments = self._parts.make("instruments", lambda: self._contradictions(shown), lambda _: ())
        return CampaignState(
            vehicle=stream.vehicle,
            now_s=stream.now_s,
            mode=stream.mode,
            channels=channels,
            axes=shown.axes,
            flying=flying,
            marking_since_s=stream.marks.by_hand_since_s,
            arriving=self._being_flown.arrived(flying, self._axes_before),
            judging=self._aside.is_busy,
            elevator_notes=flights.elevator_notes,
            reader_notes=(
                *self._journal.reader_notes,
                *(f"{d.sentence}; {d.fix}." for d in stream.frozen if not d.stops),
            ),
            elevator_guess=stream.guess if isinstance(stream.elevator, Problem) else None,
            other_vehicles=tuple(sorted(stream.other_systems)),
            whole_flight=self._whole_flights.now(self.power_on, stream.now_s, stream.tracks.courses),
            no_data=stream.service.problems,
            serves=stream.service.serves,
            instruments=instruments,
            mark_notes=self._journal.mark_notes,
            notices=self._journal.lines,
            flight=flights.flight,
            boot=stream.boot,
            flights=heard,
            activity=self._activity,
            failed=self._parts.failed,
        )

    def _so_far(self) -> _Verdicts:
        """Return the verdicts so far. While a manoeuvre is being judged, return the verdicts before it."""
        if self._shown is None or not self._aside.is_busy:
            self._shown = self._verdicts()
        return self._shown

    def _verdicts(self) -> _Verdicts:
        """Return the verdicts of all manoeuvres so far."""
        elevator, lateral = self._elevator, self._lateral
        numbers = tuple(judged.maneuver.number for judged in elevator.joined)
        axes: dict[AxisName, AxisState[Any]] = {
            "pitch": AxisState(elevator.judged, elevator.flight_test, elevator.model, numbers)
        }
        if lateral is not None:
            axes["lateral"] = lateral.state(self._outputs_unknown)
        sideways = lateral.maneuvers if lateral is not None else ()
        return _Verdicts(axes, (*elevator.maneuvers, *sideways), elevator.estimates)

    @property
    def _axes_before(self) -> Axes | None:
        """Function that returns the state of each axis; None while a manoeuvre is being judged."""
        return None if self._aside.is_busy else lambda: self._so_far().axes

    def _contradictions(self, shown: _Verdicts) -> tuple[InstrumentFinding, ...]:
        by_motion = together(shown.maneuvers, self._stream.instruments)
        side = shown.axes.get("lateral")
        of_fits = with_fit(by_motion, shown.axes["pitch"].model, shown.estimates, self._aircraft)
        return (*of_fits, *side_signs(side.model if side is not None else None, self._aircraft))

    @property
    def power_on(self) -> tuple[int, int]:
        """Number of the flight and of the power-on of the newest message, each from 0."""
        return self._flights.flight, self._stream.boot

    @property
    def serves(self) -> bool:
        """Whether the present data are known to be sufficient."""
        return self._stream.service.serves

    @property
    def problems(self) -> list[Problem]:
        """Reasons for which the stream so far cannot be used; empty for a usable stream.

        Manoeuvres of aileron and rudder do not need the elevator's messages.
        """
        problems = self._flights.problems()
        if self._lateral is None or not self._lateral.maneuvers:
            return problems
        return [problem for problem in problems if problem.code not in OF_ELEVATOR]

    def log(self, sentence: str) -> None:
        """Write a sentence from outside the campaign, such as a link's report, into the event log."""
        self._journal.write(sentence, self._stream.now_s)

    def _take(self, events: Sequence[FlightEvent]) -> list[CampaignEvent]:
        news = self._heard_verdicts()
        for event in events:
            news.append(event)
            self._journal.take(event)
            match event:
                case ModeChanged(mode, at_s):
                    self._whole_flights.change_mode(self.power_on, at_s, mode)
                case ManeuverFlown(maneuver):
                    news += self._give(self._elevator, maneuver)
                case SideManeuverFlown(maneuver) if self._lateral is not None:
                    news += self._give(self._lateral, maneuver)
                case Activity():
                    joined = event.joined(self._activity[-1]) if self._activity else None
                    self._activity = (*self._activity[:-1], joined) if joined else (*self._activity, event)
                case ManeuverAgain():
                    news += self._heard_again(event)
        if self._tell is not None:
            for happened in news:
                self._tell(happened)
        return news

    def _give(self, half: AxisCampaign, maneuver: Maneuver) -> list[CampaignEvent]:
        """Start judging a manoeuvre that has just been flown, and return the verdicts that are ready."""
        if self._aside.in_thread:
            self._so_far()
        self._aside.do(partial(self._judge, half, maneuver, self._engineer.decided))
        return self._heard_verdicts()

    def _judge(self, half: AxisCampaign, maneuver: Maneuver, decided: ByHand) -> ManeuverJudged:
        half.take(maneuver, decided)
        event = ManeuverJudged(
            half.judged[-1], half.flight_test, self._plan, half.axis, half.take_revisions()
        )
        if self._aside.in_thread:
            self._shown = self._verdicts()
        return event

    def _heard_verdicts(self) -> list[CampaignEvent]:
        """Return the manoeuvres that have been judged, and log their verdicts and the decisions."""
        events = self._aside.made()
        for event in events:
            maneuver, axis = event.judged.maneuver, event.axis
            span = maneuver.span
            which = f", {span.kind}" if axis == "lateral" else ""
            of_it = f"{OF[axis]}manoeuvre {maneuver.number} ({clock(span.start_s)}{which})"
            self._journal.write_of_past(f"{of_it}: {event.judged.verdict.sentence}", span.end_s)
            for said in (*event.revised, event.flight_test.sentence):
                self._journal.write_of_past(f"{_TEST_OF[axis]}{said}", span.end_s)
        return [*events]

    def _revised_at_the_end(self, half: AxisCampaign) -> list[CampaignEvent]:
        """Log the verdicts that the estimate of all manoeuvres together has changed."""
        notices = [Notice("verdict_revised", said) for said in half.take_revisions()]
        for notice in notices:
            self._journal.take(notice)
        return [*notices]

    @property
    def _plan(self) -> CrewPlan | None:
        """Plan of both axes; None if the test of one axis has not begun."""
        if self._lateral is None or not has_begun(self._lateral.judged):
            return None
        if not has_begun(self._elevator.judged):
            return None
        return crew_plan(self._elevator.flight_test, self._lateral.flight_test)

    def _heard_again(self, event: ManeuverAgain) -> list[CampaignEvent]:
        """Keep the better record of a manoeuvre that arrived twice; an exclusion of either remains."""
        self.wait()
        maneuver, half = event.maneuver, self._axes[event.axis]
        where = f" in {self._flights.name}" if self._flights.name else ""
        better = "; this record holds more and replaces the other one" if event.takes_place else ""
        self._journal.write_of_past(
            f"{OF[event.axis]}manoeuvre {maneuver.number} ({clock(maneuver.span.start_s)}) comes again{where}"
            f": it counts once{better}",
            maneuver.span.end_s,
        )
        before = half.numbered(maneuver.number).excluded_because
        because = before if before is not None else self._engineer.decided.excluded_because(maneuver)
        if not event.takes_place:
            if because != before:
                half.exclude(maneuver.number, because)
            return []
        half.take_better(maneuver, because)
        return [ManeuverJudged(half.numbered(maneuver.number), half.flight_test, self._plan, half.axis)]

    @property
    def _stream(self) -> FlightStream:
        return self._flights.stream
