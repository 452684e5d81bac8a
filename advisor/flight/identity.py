"""What the vehicle says of itself: who it is, its firmware, its mode, what its outputs drive."""

from collections.abc import Sequence
from math import isfinite, nan

from advisor.aircraft import Elevator
from advisor.flight.elevator_outputs import find_elevator
from advisor.flight.events import FlightEvent, Notice, VehicleFound
from advisor.flight.messages import Columns
from advisor.flight.surfaces import AILERON, RUDDER, Surface, find_surface
from advisor.flight.vehicle import Vehicle, VehicleFinder, mode_name
from advisor.problems import Problem

_BUNDLED = b"Bundled aircraft"
"""How the simulator of this project introduces itself in a STATUSTEXT."""

_RELEASES = ((255, ""), (192, "-rc"), (128, "-beta"), (64, "-alpha"), (0, "-dev"))
"""Least FIRMWARE_VERSION_TYPE (MAVLink common.xml), the lowest byte of a version, and how users write it."""

READER = b"Log reader: "
"""How a reader of logs begins the sentences that its STATUSTEXTs carry to the user."""

READER_NOTICE = "log_reader"
"""Code of the notice that carries such a sentence, or says how a change in flight was read."""
_GROUND_STATION = 190
"""Component (MAV_COMP_ID_MISSIONPLANNER) under which a ground station stores parameters fetched as a file."""


class Identity:
    """Collects the messages that say who and what the vehicle is.

    Parameters
    ----------
    elevator
        As the aircraft file has it.
    target_system
        System id to follow; None: the first vehicle heard.
    """

    def __init__(self, elevator: Elevator, target_system: int | None) -> None:
        self._elevator = elevator
        self._finder = VehicleFinder(target_system)
        self._firmware: dict[int, str] = {}
        self._parameters: dict[tuple[int, int], dict[str, float]] = {}
        self._said = ""
        self._changes_said: set[tuple[str, float]] = set()
        self.mode = ""
        """Flight mode of the newest heartbeat."""
        self.simulated = False
        """The bundled aircraft has introduced itself: its vane is simulated."""
        self.elevator: Surface | Problem = find_elevator(elevator, {})
        """The elevator's outputs and scale, or why there is none."""
        self.surfaces: dict[str, Surface] = {}
        """Elevator, aileron and rudder, as far as they are known."""

    @property
    def vehicle(self) -> Vehicle | None:
        """Who is followed; None before its first heartbeat."""
        vehicle = self._finder.vehicle
        if vehicle is not None and vehicle.system in self._firmware:
            return vehicle.with_firmware(self._firmware[vehicle.system])
        return vehicle

    @property
    def other_systems(self) -> frozenset[int]:
        """System ids of further vehicles heard."""
        return frozenset(self._finder.others)

    def provenance(self, source: str, stated: str) -> str:
        """Provenance of a channel, as far as the vehicle's identity tells.

        AOA_SSA is derived from inertial speed and estimated wind on ArduPilot; elsewhere nobody knows.
        """
        if source != "AOA_SSA.AOA" or self.vehicle is None:
            return stated
        if self.simulated:
            return "simulated"
        return "derived" if self.vehicle.autopilot == "ardupilot" else "unknown"

    def learn(self, piece: Sequence[Columns], now_s: float = nan, flown: bool = False) -> list[FlightEvent]:
        """Take messages among which at most the first changes anything.

        Parameters
        ----------
        piece
            Messages, in order of arrival.
        now_s
            Vehicle time of the newest sample, s since boot.
        flown
            A test input has been flown: the elevator's scale stays as it was then.
        """
        events: list[FlightEvent] = []
        for columns in piece:
            if columns.name == "HEARTBEAT":
                events += self._heartbeat(columns)
            elif columns.name == "PARAM_VALUE":
                events += self._parameter(columns, now_s, flown)
            elif columns.name == "AUTOPILOT_VERSION":
                self._version(columns)
            elif columns.name == "STATUSTEXT":
                events += self._text(columns)
        return events

    def _heartbeat(self, columns: Columns) -> list[FlightEvent]:
        events: list[FlightEvent] = []
        known = len(self._finder.others)
        if self._finder.hear(columns):
            assert self._finder.vehicle is not None
            events += [VehicleFound(self._finder.vehicle), *self._settle_surfaces()]
        if len(self._finder.others) > known:
            others = ", ".join(str(n) for n in sorted(self._finder.others))
            events.append(
                Notice(
                    "several_vehicles",
                    f"Other vehicles are heard too (system {others}): --target-system picks one.",
                )
            )
        vehicle = self._finder.vehicle
        if vehicle and (columns.system, columns.component) == (vehicle.system, vehicle.component):
            self.mode = mode_name(vehicle, int(columns.fields["custom_mode"][0]))
        return events

    def _parameter(self, columns: Columns, now_s: float, flown: bool) -> list[FlightEvent]:
        known = self._parameters.setdefault((columns.system, columns.component), {})
        events: list[FlightEvent] = []
        changed = False
        for raw, value in zip(
            columns.fields["param_id"].tolist(), columns.fields["param_value"], strict=True
        ):
            name = raw.rstrip(b"\0").decode("ascii", "replace")
            if not name.startswith("SERVO") or known.get(name) == float(value):
                continue
            before = known.get(name)
            known[name] = float(value)
            if before is not None and self._scales_elevator():
                events += self._rescaled(name, before, float(value), now_s, flown)
                if flown:
                    known[name] = before
                    continue
            changed = True
        vehicle = self._finder.vehicle
        if changed and vehicle and (columns.system, columns.component) in _speakers(vehicle):
            events += self._settle_surfaces()
        return events

    def _known_parameters(self) -> dict[str, float]:
        vehicle = self._finder.vehicle
        parameters: dict[str, float] = {}
        for speaker in _speakers(vehicle) if vehicle else ():
            parameters |= self._parameters.get(speaker, {})
        return parameters

    def _scales_elevator(self) -> bool:
        """Whether the parameters have changed what the elevator's pulses mean."""
        return (
            isinstance(self.elevator, Surface)
            and find_elevator(self._elevator, self._known_parameters()) != self.elevator
        )

    def _rescaled(
        self, name: str, before: float, value: float, now_s: float, flown: bool
    ) -> list[FlightEvent]:
        """What a change of a known parameter does to the elevator: once for each value."""
        if (name, value) in self._changes_said:
            return []
        self._changes_said.add((name, value))
        at = f" at {now_s:.1f} s" if isfinite(now_s) else ""
        used = (
            f"the elevator is counted with {before:g} all the same, for its linkage has not changed"
            if flown
            else f"the elevator is counted with {value:g} from then on"
        )
        return [Notice(READER_NOTICE, f"{name} changed from {before:g} to {value:g}{at}: {used}.")]

    def _settle_surfaces(self) -> list[FlightEvent]:
        parameters = self._known_parameters()
        self.elevator = find_elevator(self._elevator, parameters)
        found = {
            "elevator": self.elevator,
            "aileron": find_surface(AILERON, parameters),
            "rudder": find_surface(RUDDER, parameters),
        }
        self.surfaces = {name: surface for name, surface in found.items() if isinstance(surface, Surface)}
        said = self.elevator.said if isinstance(self.elevator, Surface) else ""
        if not said or said == self._said:
            return []
        self._said = said
        return [Notice("elevator_scale", said)]

    def _version(self, columns: Columns) -> None:
        packed = int(columns.fields["flight_sw_version"][0])
        if packed:
            kind = next((name for least, name in _RELEASES if packed & 0xFF >= least), "")
            version = f"{packed >> 24 & 0xFF}.{packed >> 16 & 0xFF}.{packed >> 8 & 0xFF}{kind}"
            self._version_told(columns.system, version)

    def _version_told(self, system: int, version: str) -> None:
        """Keep the fuller spelling: a text says 4.8.0-beta1 where the message says 4.8.0-beta."""
        if not self._firmware.get(system, "").startswith(version):
            self._firmware[system] = version

    def _text(self, columns: Columns) -> list[FlightEvent]:
        text = bytes(columns.fields["text"][0])
        if text.startswith(READER):
            return [Notice(READER_NOTICE, f"{text.removeprefix(READER).decode()}.")]
        if text.startswith(_BUNDLED):
            self.simulated = True
        words = text.split()
        if len(words) > 1 and words[0].startswith(b"Ardu") and words[1][:1] == b"V":
            told = words[1][1:].decode("ascii", "replace")
            if told.startswith(self._firmware.get(columns.system, "")):
                self._version_told(columns.system, told)
        return []


def _speakers(vehicle: Vehicle) -> tuple[tuple[int, int], ...]:
    """Senders (system, component) that state the vehicle's parameters; the vehicle comes last and wins."""
    return (vehicle.system, _GROUND_STATION), (vehicle.system, vehicle.component)
