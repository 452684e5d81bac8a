"""Outputs and scales of the control surfaces, from the parameters received so far.

The first test input of a power-on fixes the elevator's pulse scale, because no linkage changes in flight. A
limit received later waits for the next power-on, so that no manoeuvre has a step at its arrival.
"""

from dataclasses import replace
from math import isfinite

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.flight.elevator.elevator_outputs import find_elevator, find_side_control
from advisor.flight.maneuvers.maneuver import READER_NOTICE, FlightEvent, Notice
from advisor.flight.signals.messages import Columns
from advisor.flight.vehicle.parameters import Parameters, Sender, Stated, read_by
from advisor.flight.vehicle.surfaces import Surface, Wiring
from advisor.flight.vehicle.vehicle import Vehicle, VehicleFinder
from advisor.words.problems import Problem
from advisor.words.quantities import clock

_GROUND_STATION = 190
"""Component id (MAV_COMP_ID_MISSIONPLANNER) of a ground station that records parameters from a file."""


def speakers(vehicle: Vehicle) -> tuple[tuple[int, int], ...]:
    """Return the senders (system, component) that state the vehicle's parameters. The vehicle is last in the
    list, so its values override the others."""
    return (vehicle.system, _GROUND_STATION), (vehicle.system, vehicle.component)


class SurfacesHeard:
    """Elevator, aileron and rudder among the servo outputs."""

    def __init__(self, aircraft: Aircraft, parameters: Parameters, finder: VehicleFinder) -> None:
        self._aircraft, self._parameters, self._finder = aircraft, parameters, finder
        self._taken: Elevator | None = None
        self._said = ""
        self._said_of: set[tuple[str, float]] = set()
        self._late: dict[tuple[Sender, str], Stated] = {}
        self.elevator: Surface | Problem = self._found()
        """Outputs and scale of the elevator from all parameters, or the reason why they are unknown."""
        self.counted: dict[str, Surface] = {}
        """Elevator, aileron and rudder with their pulse scales, if known."""

    def follow(self) -> list[FlightEvent]:
        """Find the surfaces of another vehicle."""
        self._taken = None
        return self._settle()

    def begin(self) -> None:
        """Begin another power-on, whose pulse scales use all received limits."""
        for (sender, name), stated in self._late.items():
            self._parameters.keep(sender, name, stated)
        self._late.clear()
        self._count()

    def take(self, output: int) -> list[FlightEvent]:
        """Use the output that the crew accepted as the elevator."""
        self._taken = replace(self._aircraft.elevator, output=output)
        return self._settle()

    def serves(self, vehicle: Vehicle) -> bool:
        """Return whether the elevator's outputs of a vehicle are known."""
        return isinstance(find_elevator(self._aircraft.elevator, self._wiring(vehicle)), Surface)

    def hear(self, columns: Columns, now_s: float, flown: bool) -> list[FlightEvent]:
        """Take parameter messages, and return a notice for each change of the elevator's calibration.

        Parameters
        ----------
        now_s
            Vehicle time of the newest sample, s since boot.
        flown
            Whether this power-on has a test input, after which the elevator's pulse scale is fixed.
        """
        vehicle, sender = self._vehicle, (columns.system, columns.component)
        events: list[FlightEvent] = []
        for name, before, stated in self._parameters.news(columns):
            self._parameters.keep(sender, name, stated)
            if vehicle is None or sender not in speakers(vehicle):
                continue
            was, now = self.elevator, self._found()
            if isinstance(was, Surface) and _moves_otherwise(was, now):
                at = f" at {clock(now_s)}" if isfinite(now_s) else ""
                value = read_by(vehicle.autopilot, stated)
                if before is not None:
                    old = read_by(vehicle.autopilot, before)
                    events += self._notice(name, value, _changed(name, old, value, at, not flown))
                elif flown:
                    events += self._notice(name, value, _too_late(name, value, at))
                    self._late[sender, name] = stated
                if flown:
                    self._parameters.keep(sender, name, before)
                    continue
            events += self._settle()
        return events

    @property
    def sides_unknown(self) -> Problem | None:
        """Reason why aileron or rudder cannot be followed, because no source states their outputs. None
        before a vehicle is known, and if both outputs are known.

        If parameters name the outputs of other surfaces, the aircraft may have no rudder.
        """
        wiring, vehicle = self._wiring(self._vehicle), self._vehicle
        missing = [name for name in ("aileron", "rudder") if name not in self.counted]
        if vehicle is None or vehicle.no_elevator is not None or not missing:
            return None
        if len(missing) == 1 and wiring.roles:
            return None
        several = len(missing) > 1
        keys = " and ".join(f"{name}.output" for name in missing)
        return Problem(
            "no_aileron",
            f"The output{'s' if several else ''} of {' and '.join(missing)} {'are' if several else 'is'} not "
            "known.",
            f"For roll and yaw, give {keys} in the aircraft file, or record {wiring.words.function}.",
        )

    def _notice(self, name: str, value: float, text: str) -> list[FlightEvent]:
        if (name, value) in self._said_of:
            return []
        self._said_of.add((name, value))
        return [Notice(READER_NOTICE, text)]

    @property
    def _vehicle(self) -> Vehicle | None:
        return self._finder.vehicle

    def _wiring(self, vehicle: Vehicle | None) -> Wiring:
        if vehicle is None:
            return self._parameters.wiring((), "")
        return self._parameters.wiring(speakers(vehicle), vehicle.autopilot)

    def _found(self) -> Surface | Problem:
        wiring, vehicle = self._wiring(self._vehicle), self._vehicle
        if vehicle is not None and vehicle.no_elevator is not None:
            return vehicle.no_elevator
        surface = find_elevator(self._aircraft.elevator, wiring)
        if isinstance(surface, Problem) and self._taken is not None:
            return find_elevator(self._taken, wiring, "by a guess that the crew has accepted")
        return surface

    def _count(self) -> None:
        """Find the surfaces from all received parameters."""
        self.elevator, wiring = self._found(), self._wiring(self._vehicle)
        if self._vehicle is not None and self._vehicle.is_multicopter:
            self.counted = {}
            return
        surfaces = {
            "elevator": self.elevator,
            "aileron": find_side_control("aileron", self._aircraft.aileron, wiring),
            "rudder": find_side_control("rudder", self._aircraft.rudder, wiring),
        }
        self.counted = {name: surface for name, surface in surfaces.items() if isinstance(surface, Surface)}

    def _settle(self) -> list[FlightEvent]:
        """Find the surfaces from all received parameters, and report the elevator's outputs once."""
        self._count()
        said = self.elevator.said if isinstance(self.elevator, Surface) else ""
        if not said or said == self._said:
            return []
        self._said = said
        return [Notice("elevator_scale", said)]


def _moves_otherwise(was: Surface, now: Surface | Problem) -> bool:
    """Return whether other outputs or scales drive a surface now.

    A stated direction that equals the assumed one is no change.
    """
    if isinstance(now, Problem):
        return True
    return [replace(part, sure=False) for part in now.parts] != [
        replace(part, sure=False) for part in was.parts
    ]


def _changed(name: str, old: float, value: float, at: str, counts: bool) -> str:
    used = (
        f"the elevator is counted with {value:g} after that"
        if counts
        else f"the elevator is still counted with {old:g}, because its linkage has not changed"
    )
    return f"{name} changed from {old:g} to {value:g}{at}: {used}."


def _too_late(name: str, value: float, at: str) -> str:
    return (
        f"{name} {value:g} is heard only{at}: the value assumed before counts until it starts again. "
        "Z_δe and M_δe have another scale; advisor analyze counts the whole recording anew."
    )
