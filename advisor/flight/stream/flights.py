"""Flights of a campaign: one log or link after the other. Each manoeuvre of a campaign has a number and is
used once."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import (
    Activity,
    FlightBegan,
    FlightEvent,
    Maneuver,
    ManeuverAgain,
    ManeuverFlown,
    Notice,
    SideManeuverFlown,
    VehicleFound,
    are_one,
    is_fuller,
)
from advisor.flight.maneuvers.marks import Mark
from advisor.flight.signals.messages import Columns
from advisor.flight.signals.track import ChannelStatus
from advisor.flight.stream.stream import FlightStream
from advisor.flight.vehicle.surfaces import Surface
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.words.axes import AXES, AxisName
from advisor.words.problems import Problem

_PROBE_US = (1400.0, 1600.0)
"""Pulses at which two elevators' scales are compared, us: within the travel of every servo."""
_SCALES_AGREE = 0.05
"""Largest relative difference of an elevator's scale between flights of one aircraft, as after a new trim."""


class OneAircraft:
    """Comparison of each flight's vehicle and elevator with those of the first flight."""

    def __init__(self) -> None:
        self._vehicle: tuple[str, Vehicle] | None = None
        self._elevator: tuple[str, Surface] | None = None

    def refuse(self, name: str, vehicle: Vehicle) -> Problem | None:
        """Return a problem if the vehicle of a flight is certainly another aircraft; else None."""
        first_name, first = self._vehicle = self._vehicle or (name, vehicle)
        if _kind(vehicle) == _kind(first):
            return None
        return Problem(
            "other_vehicle",
            f"The vehicle is {_kind(vehicle)}, and {_kind(first)} in {first_name}:"
            " one campaign needs one aircraft.",
            "Give the logs of one aircraft only.",
        )

    def other_system(self, name: str, vehicle: Vehicle) -> str:
        """Return a sentence if the vehicle's system id differs from the first flight's; else ""."""
        first_name, first = self._vehicle = self._vehicle or (name, vehicle)
        if vehicle.system == first.system:
            return ""
        return f"{name}: the vehicle is {vehicle}, and {first} in {first_name}; both count as one aircraft."

    def doubt_elevator(self, name: str, elevator: Surface) -> str:
        """Return a sentence if the elevator is driven differently from the first flight's; else ""."""
        first_name, first = self._elevator = self._elevator or (name, elevator)
        if elevator.outputs == first.outputs and _scales_agree(elevator, first):
            return ""
        outputs, before = (" + ".join(map(str, surface.outputs)) for surface in (elevator, first))
        return (
            f"{name}: the elevator is output {outputs} with a scale of its own, and output {before} in "
            f"{first_name}; both count as one aircraft."
        )


def _kind(vehicle: Vehicle) -> str:
    """Return the vehicle's properties that no setting changes, such as the autopilot's make."""
    return f"{vehicle.autopilot} on a {'multicopter' if vehicle.is_multicopter else 'fixed wing'}"


def _scales_agree(a: Surface, b: Surface) -> bool:
    steps = [np.diff(s.angles(np.tile(np.array(_PROBE_US)[:, None], len(s.parts))), axis=0) for s in (a, b)]
    return bool(np.allclose(steps[0], steps[1], rtol=_SCALES_AGREE))


@dataclass(frozen=True, slots=True)
class FlightHeard:
    """Summary of one log or link of the campaign."""

    flight: int
    """Number of the flight, 0 for the first."""
    name: str
    """Name of the log or link that the user gave."""
    vehicle: Vehicle | None
    duration_s: float
    """Vehicle time received over all power-ons, s."""
    channels: Mapping[str, ChannelStatus]
    again: int = 0
    """Number of its manoeuvres that another log or power-on also contains."""
    problems: tuple[Problem, ...] = ()
    """Reasons why the flight is not used, known at its end."""
    sides_unknown: Problem | None = None
    """Reason why aileron or rudder cannot be followed; None if their outputs are known."""


class Flights:
    """Stream of the vehicle through several logs, and then through a link.

    Each flight is processed as if alone, so that its manoeuvres do not depend on other flights.

    Parameters
    ----------
    aircraft, target_system
        Arguments of `FlightStream`, such as the aircraft file.
    names
        Names of the logs, in their order; empty for a single log.
    """

    def __init__(
        self,
        aircraft: Aircraft,
        target_system: int | None = None,
        marks: Sequence[Mark] = (),
        names: Sequence[str] = (),
        lateral: bool = False,
    ) -> None:
        self._lateral = lateral
        self._aircraft, self._target_system = aircraft, target_system
        self._marks, self._names = tuple(marks), tuple(names) if len(names) > 1 else ()
        self._recorded: dict[AxisName, list[Maneuver]] = {axis: [] for axis in AXES}
        self._past: list[FlightHeard] = []
        self._notes: list[str] = []
        self._one_aircraft = OneAircraft()
        self._begin(0)
        self._told_of = -1

    def _begin(self, flight: int) -> None:
        self.flight = flight
        marks = [mark for mark in self._marks if mark.flight == flight]
        self.stream = FlightStream(self._aircraft, self._target_system, marks, lateral=self._lateral)
        """Stream of the present flight."""
        self._again = 0
        self._foreign: Problem | None = None

    @property
    def elevator_notes(self) -> tuple[str, ...]:
        """Sentences about the elevator's outputs and about assumptions, over all flights."""
        return tuple(dict.fromkeys((*self._notes, *self.stream.elevator_notes)))

    def heard(self, channels: Mapping[str, ChannelStatus], over: bool = False) -> tuple[FlightHeard, ...]:
        """Return the summary of every flight so far; ``channels`` are those of the present flight."""
        return (*self._past, self._so_far(channels, over))

    def so_far(self) -> Maneuver | None:
        """Return the present manoeuvre, cut at the newest sample; None between manoeuvres."""
        flying = self.stream.so_far() if self._foreign is None else None
        return flying and replace(flying, number=len(self._recorded["pitch"]) + 1, flight=self.flight)

    def problems(self) -> list[Problem]:
        """Return the reasons why none of the flights so far can be used; empty if at least one is usable."""
        now = self._problems()
        if not now or any(not past.problems for past in self._past):
            return []
        name = self._name(self.flight)
        here = [replace(p, text=f"{name}: {p.text}") for p in now] if name else now
        before = [
            replace(p, text=f"{flight.name}: {p.text}") for flight in self._past for p in flight.problems
        ]
        return [*before, *here]

    def feed(self, columns: Sequence[Columns]) -> list[FlightEvent]:
        """Take messages, one flight after the other, and return the events that follow from them."""
        events: list[FlightEvent] = []
        filled = sorted((c for c in columns if len(c)), key=lambda c: c.flight)
        for flight, part in groupby(filled, key=lambda c: c.flight):
            if flight != self.flight:
                events += self._end()
                self._begin(flight)
            if flight != self._told_of:
                self._told_of = flight
                events += [FlightBegan(flight, self._name(flight))] if self._names else []
            if self._foreign is None:
                events += self._through(self.stream.feed(list(part)))
        return events

    def finish(self) -> list[FlightEvent]:
        """Handle the end of the messages, and close every open movement."""
        if self._foreign is not None:
            return []
        events = [*self._through(self.stream.finish()), *self._compare_elevators()]
        if self._names:
            events += [Notice(p.code, p.about(self.name)) for p in self.stream.problems()]
        return events

    def _end(self) -> list[FlightEvent]:
        events = self.finish()
        if self.flight == self._told_of:
            self._past.append(self._so_far(self.stream.channels, over=True))
            self._notes += self.stream.elevator_notes
        return events

    def _so_far(self, channels: Mapping[str, ChannelStatus], over: bool) -> FlightHeard:
        return FlightHeard(
            self.flight,
            self._name(self.flight),
            self.stream.vehicle,
            self.stream.duration_s,
            channels,
            self._again,
            tuple(self._problems()) if over else (),
            self.stream.sides_unknown,
        )

    def _problems(self) -> list[Problem]:
        return [self._foreign] if self._foreign is not None else self.stream.problems()

    def _name(self, flight: int) -> str:
        return self._names[flight] if flight < len(self._names) else ""

    @property
    def name(self) -> str:
        """Name of the present log; empty for a single log."""
        return self._name(self.flight)

    def _through(self, events: Sequence[FlightEvent]) -> list[FlightEvent]:
        """Return the events of one flight with the manoeuvre numbers of the campaign."""
        through: list[FlightEvent] = []
        for event in events:
            match event:
                case ManeuverFlown(maneuver):
                    through.append(self._once(maneuver, "pitch", ManeuverFlown))
                case SideManeuverFlown(maneuver):
                    through.append(self._once(maneuver, "lateral", SideManeuverFlown))
                case Activity():
                    through.append(replace(event, flight=self.flight))
                case VehicleFound(vehicle):
                    through += [event, *self._compare_vehicles(vehicle)]
                    if self._foreign is not None:
                        return through
                case _:
                    through.append(event)
        return through

    def _once(
        self, maneuver: Maneuver, axis: AxisName, new: type[ManeuverFlown | SideManeuverFlown]
    ) -> FlightEvent:
        """Return the event of a manoeuvre of an axis, new or recorded before, with its campaign's number."""
        maneuver, recorded = replace(maneuver, flight=self.flight), self._recorded[axis]
        for i, before in enumerate(recorded):
            if before.power_on != maneuver.power_on and are_one(maneuver, before):
                self._again += 1
                again = replace(maneuver, number=before.number)
                takes_place = is_fuller(again, before)
                if takes_place:
                    recorded[i] = again
                return ManeuverAgain(again, takes_place, axis)
        recorded.append(replace(maneuver, number=len(recorded) + 1))
        return new(recorded[-1])

    def _compare_vehicles(self, vehicle: Vehicle) -> Iterator[FlightEvent]:
        """Yield notices about a vehicle unlike the first flight's; refuse another aircraft."""
        self._foreign = self._one_aircraft.refuse(self.name, vehicle)
        if self._foreign is not None:
            yield Notice(self._foreign.code, f"{self.name}: {self._foreign}")
        elif said := self._one_aircraft.other_system(self.name, vehicle):
            self._notes.append(said)
            yield Notice("other_system", said)

    def _compare_elevators(self) -> Iterator[FlightEvent]:
        """Yield notices about an elevator that is driven differently from the first flight's."""
        elevator = self.stream.elevator
        if isinstance(elevator, Surface) and (said := self._one_aircraft.doubt_elevator(self.name, elevator)):
            self._notes.append(said)
            yield Notice("other_elevator", said)
