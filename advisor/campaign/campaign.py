"""The flight test as a pure state machine: columns of messages in, events and a state out."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.arriving_information import ArrivingInformation
from advisor.campaign.axes.elevator_campaign import ElevatorCampaign
from advisor.campaign.axes.lateral_campaign import LateralCampaign
from advisor.campaign.axis_campaign import AxisCampaign
from advisor.campaign.engineer import OF, Engineer
from advisor.campaign.hand_decisions import NOTHING, ByHand
from advisor.campaign.instruments import side_signs, together, with_fit
from advisor.campaign.journal import Journal
from advisor.campaign.late_limits import recount
from advisor.campaign.running_estimate import Settled, Settling
from advisor.campaign.state import (
    OF_ELEVATOR,
    AxisState,
    CampaignState,
    JudgedManeuver,
    LateralState,
    WholeFlights,
    has_begun,
)
from advisor.decision.arriving import Arriving
from advisor.decision.crew_plan import CrewPlan, crew_plan
from advisor.decision.verdict import FlightTestVerdict
from advisor.flight.maneuvers.announced import Announced
from advisor.flight.maneuvers.events import (
    Activity,
    ElevatorRescaled,
    FlightEvent,
    ManeuverAgain,
    ManeuverFlown,
    ModeChanged,
    Notice,
    SideManeuverFlown,
)
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.maneuvers.marks import Mark
from advisor.flight.signals.instrument_finding import InstrumentFinding
from advisor.flight.signals.messages import Columns
from advisor.flight.stream.flights import FlightHeard, Flights
from advisor.flight.stream.stream import FlightStream
from advisor.oem.axes.lateral.estimate import LateralEstimate
from advisor.oem.estimate import Estimate
from advisor.process.parts import Parts
from advisor.words.axes import AxisName
from advisor.words.problems import Problem
from advisor.words.vehicle_time import clock

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
class InputEnough:
    """The data of a multisine that a script flies are enough: the script may end it."""

    number: int
    """Number of the input in the script's texts."""


CampaignEvent = FlightEvent | ManeuverJudged | InputEnough


class Campaign:
    """Finds, estimates and judges the manoeuvres of a flight test. The class does no input or output and has
    no clock, so that a log and a live link give equal results.

    Parameters
    ----------
    target_system
        System id of the vehicle; None: the first one heard.
    settle
        Estimate while a manoeuvre is still being flown, for live faces.
        Verdicts do not depend on the running estimate.
    marks
        Further marks, which replace overlapping marks of ``by_hand`` and are not kept in a file.
    names
        Names of the campaign's logs, in their order; empty for a single log.
    advises
        Whether roll and yaw are estimated jointly after every manoeuvre, for the advice to stop; else only at
        the end.
    """

    def __init__(
        self,
        aircraft: Aircraft,
        target_system: int | None = None,
        settle: bool = False,
        tell: Callable[[CampaignEvent], object] | None = None,
        by_hand: ByHand = NOTHING,
        marks: Sequence[Mark] = (),
        names: Sequence[str] = (),
        lateral: bool = False,
        advises: bool = True,
    ) -> None:
        self._journal = Journal()
        self._parts = Parts(lambda failed: self._journal.write(str(failed.problem)))
        self._elevator = ElevatorCampaign(aircraft, self._journal.write, self._parts)
        self._lateral = LateralCampaign(aircraft, self._parts, advises) if lateral else None
        self._aircraft = aircraft
        self._tell = tell
        self._flights = Flights(aircraft, target_system, (*marks, *by_hand.marks), names, lateral)
        axes: Mapping[AxisName, AxisCampaign] = {
            "pitch": self._elevator,
            "lateral": self._lateral or self._elevator,
        }
        self.engineer = Engineer(self._flights, self._journal, axes, by_hand)
        """The engineer, whose decisions count in all verdicts."""
        self._activity: tuple[Activity, ...] = ()
        self._whole_flights = WholeFlights()
        self._ended = False
        self._settling = Settling() if settle else None
        self._information = ArrivingInformation(aircraft) if settle or tell is not None else None
        self._heard_enough: Announced | None = None

    def feed(self, columns: Sequence[Columns]) -> list[CampaignEvent]:
        """Process the next messages, in order of arrival. The result does not depend on how the messages are
        grouped."""
        told = self._take(self._flights.feed(columns))
        if (enough := self._enough()) is not None:
            told.append(enough)
            if self._tell is not None:
                self._tell(enough)
        self.engineer.repeat_remarks()
        return told

    def finish(self) -> list[CampaignEvent]:
        """End the stream: a manoeuvre without only its quiet end is still used."""
        if self._stream.marks.by_hand_since_s is not None:
            self.engineer.end_maneuver()
        told = self._take(self._flights.finish())
        self._ended = True
        for campaign in filter(None, (self._elevator, self._lateral)):
            campaign.finish()
            told += self._revised_at_the_end(campaign)
        for problem in self._stream.marks.problems():
            self._journal.write(str(problem))
        return told

    @property
    def state(self) -> CampaignState:
        """State after the newest message, as shown on screens."""
        stream, flights, elevator = self._stream, self._flights, self._elevator
        flying, channels, model = flights.so_far(), stream.channels, elevator.model
        settled = self._settled(flying, model)
        heard = flights.heard(channels, self._ended)
        numbers = tuple(judged.maneuver.number for judged in elevator.joined)
        axes: dict[AxisName, AxisState[Any]] = {
            "pitch": AxisState(elevator.judged, elevator.flight_test, model, numbers)
        }
        lateral = self._lateral_state(heard)
        if lateral is not None:
            axes["lateral"] = lateral
        side = lateral.model if lateral is not None else None
        instruments = self._parts.make("instruments", lambda: self._contradictions(model, side), lambda _: ())
        return CampaignState(
            vehicle=stream.vehicle,
            now_s=stream.now_s,
            mode=stream.mode,
            channels=channels,
            axes=axes,
            flying=flying,
            marking_since_s=stream.marks.by_hand_since_s,
            settling=settled.estimate if settled else None,
            readable=settled is not None and settled.readable,
            enough=settled.enough if settled and not self._tests_sideways else None,
            arriving=self._arrived(flying, model, lateral),
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

    def _lateral_state(self, heard: Sequence[FlightHeard]) -> LateralState | None:
        """Return the state of roll and yaw, with the reason if no flight names their outputs."""
        if self._lateral is None:
            return None
        unknown = [one.sides_unknown for one in heard]
        return self._lateral.state(unknown[-1] if all(unknown) else None)

    def _settled(self, flying: Maneuver | None, model: Estimate | None) -> Settled | None:
        """Return the estimate of the manoeuvre that is being flown, for live displays."""
        settling = self._settling
        if settling is None:
            return None
        return self._parts.make(
            "estimate of the manoeuvre being flown",
            lambda: settling.follow(flying, self._elevator.learnt, model),
            lambda _: None,
        )

    def _arrived(
        self, flying: Maneuver | None, model: Estimate | None, lateral: LateralState | None
    ) -> Arriving | None:
        """Return the errors with the information of the manoeuvre that is being flown, for live displays."""
        information = self._information
        if information is None:
            return None
        return self._parts.make(
            "information of the manoeuvre being flown",
            lambda: information.follow(flying, model, self._elevator.flight_test, lateral),
            lambda _: None,
        )

    def _enough(self) -> InputEnough | None:
        """Return the event of a multisine of a script whose data have become enough; None else."""
        flown = self._stream.marks.announced_now
        if flown is None or flown.input != "multisine" or self._information is None:
            self._heard_enough = None
            return None
        if flown == self._heard_enough or not self._information.is_due(self._stream.now_s):
            return None
        lateral = self._lateral_state(self._flights.heard(self._stream.channels, self._ended))
        arrived = self._arrived(self._flights.so_far(), self._elevator.model, lateral)
        if arrived is None or not arrived.is_enough:
            return None
        self._heard_enough = flown
        return InputEnough(flown.number)

    def _contradictions(
        self, model: Estimate | None, side: LateralEstimate | None
    ) -> tuple[InstrumentFinding, ...]:
        """Return the contradictions of the instruments, from the motion and from the fits."""
        sideways = self._lateral.maneuvers if self._lateral is not None else ()
        maneuvers = (*self._elevator.maneuvers, *sideways)
        by_motion = together(maneuvers, self._stream.instruments)
        found = with_fit(by_motion, model, self._elevator.estimates, self._aircraft)
        return (*found, *side_signs(side, self._aircraft))

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
        found = self._flights.problems()
        if self._lateral is None or not self._lateral.maneuvers:
            return found
        return [problem for problem in found if problem.code not in OF_ELEVATOR]

    def log(self, sentence: str) -> None:
        """Write a sentence from outside the campaign, such as a link's report, into the event log."""
        self._journal.write(sentence, self._stream.now_s)

    def _take(self, events: Sequence[FlightEvent]) -> list[CampaignEvent]:
        told: list[CampaignEvent] = []
        for event in events:
            told.append(event)
            self._journal.take(event)
            match event:
                case ModeChanged(mode, at_s):
                    self._whole_flights.change_mode(self.power_on, at_s, mode)
                case ManeuverFlown(maneuver):
                    told.append(self._judge(self._elevator, maneuver, "pitch"))
                case SideManeuverFlown(maneuver) if self._lateral is not None:
                    told.append(self._judge(self._lateral, maneuver, "lateral"))
                case Activity():
                    joined = event.joined(self._activity[-1]) if self._activity else None
                    self._activity = (*self._activity[:-1], joined) if joined else (*self._activity, event)
                case ManeuverAgain():
                    told += self._heard_again(event)
                case ElevatorRescaled():
                    told += self._count_anew(event)
        if self._tell is not None:
            for happened in told:
                self._tell(happened)
        return told

    def _judge(
        self, half: ElevatorCampaign | LateralCampaign, maneuver: Maneuver, axis: AxisName
    ) -> ManeuverJudged:
        """Judge a manoeuvre that has just been flown, and log its verdict and the decision."""
        half.take(maneuver, self.engineer.decided)
        span, judged = maneuver.span, half.judged[-1]
        which = f", {span.kind}" if axis == "lateral" else ""
        verdict = f"{OF[axis]}manoeuvre {maneuver.number} ({clock(span.start_s)}{which})"
        self._journal.write_of_past(f"{verdict}: {judged.verdict.sentence}", span.end_s)
        revised = half.take_revisions()
        for said in revised:
            self._journal.write_of_past(f"{_TEST_OF[axis]}{said}", span.end_s)
        self._journal.write_of_past(f"{_TEST_OF[axis]}{half.flight_test.sentence}", span.end_s)
        return ManeuverJudged(judged, half.flight_test, self._plan, axis, revised)

    def _revised_at_the_end(self, half: AxisCampaign) -> list[CampaignEvent]:
        """Log the verdicts that the estimate of all manoeuvres together has changed."""
        told = [Notice("verdict_revised", said) for said in half.take_revisions()]
        for notice in told:
            self._journal.take(notice)
        return [*told]

    @property
    def _plan(self) -> CrewPlan | None:
        """Plan of both axes; None if the test of one axis has not begun."""
        if self._lateral is None or not has_begun(self._lateral.judged):
            return None
        if not has_begun(self._elevator.judged):
            return None
        return crew_plan(self._elevator.flight_test, self._lateral.flight_test)

    @property
    def _tests_sideways(self) -> bool:
        """Whether roll and yaw are tested, and the elevator only trims."""
        lateral = self._lateral
        return lateral is not None and has_begun(lateral.judged) and not has_begun(self._elevator.judged)

    def _heard_again(self, event: ManeuverAgain) -> list[CampaignEvent]:
        """Keep the better record of a manoeuvre that arrived twice; an exclusion of either remains."""
        maneuver = event.maneuver
        where = f" in {self._flights.name}" if self._flights.name else ""
        better = "; this record holds more and takes the place" if event.takes_place else ""
        self._journal.write_of_past(
            f"manoeuvre {maneuver.number} ({clock(maneuver.span.start_s)}) comes again{where}: "
            f"it counts once{better}",
            maneuver.span.end_s,
        )
        known = self._elevator.numbered(maneuver.number).excluded_because
        because = known if known is not None else self.engineer.decided.excluded_because(maneuver)
        if not event.takes_place:
            if because != known:
                self._elevator.exclude(maneuver.number, because)
            return []
        self._elevator.take_better(maneuver, because)
        return [
            ManeuverJudged(self._elevator.numbered(maneuver.number), self._elevator.flight_test, self._plan)
        ]

    def _count_anew(self, event: ElevatorRescaled) -> list[CampaignEvent]:
        """Scale earlier manoeuvres by an elevator limit that arrived late, so that all use one scale."""
        again = recount(self._elevator.maneuvers, event)
        if again.notice is None:
            return []
        self._journal.take(again.notice)
        self._elevator.count_anew(again)
        return [again.notice]

    @property
    def _stream(self) -> FlightStream:
        return self._flights.stream
