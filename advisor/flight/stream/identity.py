"""Identity of the vehicle from its messages: autopilot, firmware, mode, and roles of its outputs."""

from collections.abc import Sequence
from dataclasses import replace
from math import nan

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import READER_NOTICE, FlightEvent, Notice, VehicleFound
from advisor.flight.signals.messages import Columns
from advisor.flight.signals.record import Channel
from advisor.flight.signals.trust import Distrust
from advisor.flight.stream.surfaces_heard import SurfacesHeard, speakers
from advisor.flight.vehicle.following import FOLLOW, TAKE, Following, chosen
from advisor.flight.vehicle.modes import in_hover, mode_name
from advisor.flight.vehicle.parameters import AIRSPEED_SENSOR, LOG_PROFILE, Parameters, filter_delay_s
from advisor.flight.vehicle.vehicle import Vehicle, VehicleFinder
from advisor.words.problems import printable

_BUNDLED = b"Bundled aircraft"
"""Beginning of the STATUSTEXT with which this project's simulator introduces itself."""

_RELEASES = ((255, ""), (192, "-rc"), (128, "-beta"), (64, "-alpha"), (0, "-dev"))
"""Suffix of a version for each least value of FIRMWARE_VERSION_TYPE (MAVLink common.xml)."""

READER = b"Log reader: "
"""Beginning of a STATUSTEXT in which a log reader sends a sentence to the user."""

_ON_ROTORS = (1, 2, 3)
"""Values of MAV_VTOL_STATE with rotors in use: transition to forward flight, transition to hover, hover."""


class Identity:
    """Collection of the messages that identify the vehicle.

    Parameters
    ----------
    target_system
        System id to follow; None for the first vehicle that sends.
    """

    def __init__(self, aircraft: Aircraft, target_system: int | None) -> None:
        self._finder = VehicleFinder(target_system)
        self._firmware: dict[int, str] = {}
        self._parameters = Parameters()
        self._mode = ""
        self._hovers = False
        self.outputs = SurfacesHeard(aircraft, self._parameters, self._finder)
        """Elevator, aileron and rudder among the servo outputs."""
        self._following = Following(self.outputs.serves)
        self.simulated = False
        """Whether the vehicle is the bundled aircraft, whose vane is simulated."""

    @property
    def vehicle(self) -> Vehicle | None:
        """Followed vehicle. None before its first heartbeat."""
        vehicle = self._finder.vehicle
        if vehicle is not None and vehicle.carrier == "ulog":
            profile = self._parameters.stated(speakers(vehicle), vehicle.autopilot).get(LOG_PROFILE)
            vehicle = vehicle if profile is None else replace(vehicle, log_profile=int(profile))
        if vehicle is not None and vehicle.system in self._firmware:
            return vehicle.with_firmware(self._firmware[vehicle.system])
        return vehicle

    @property
    def mode(self) -> str:
        """Flight mode of the newest heartbeat, with a note if rotors carry a VTOL aircraft."""
        return in_hover(self._mode) if self._hovers and self._mode else self._mode

    @property
    def other_systems(self) -> frozenset[int]:
        """System ids of the other vehicles on the stream."""
        return frozenset(self._finder.others)

    def provenance(self, source: str, stated: str) -> str:
        """Return the provenance of a channel from its source and the vehicle's identity.

        On ArduPilot, AOA_SSA is derived from inertial speed and estimated wind. On other autopilots the
        origin of AOA_SSA is unknown.
        """
        if source not in ("AOA_SSA.AOA", "AOA_SSA.SSA") or self.vehicle is None:
            return stated
        if self.simulated:
            return "simulated"
        return "derived" if self.vehicle.autopilot == "ardupilot" else "unknown"

    def identified(self, channel: Channel) -> Channel:
        """Return a channel with its provenance and with the known delay of the autopilot's filters."""
        vehicle, provenance = self.vehicle, self.provenance(channel.source, channel.provenance)
        if vehicle is None:
            return replace(channel, provenance=provenance)
        stated = self._parameters.stated(speakers(vehicle), vehicle.autopilot)
        delay_s = filter_delay_s(channel.name, channel.source, vehicle.autopilot, stated)
        return replace(channel, provenance=provenance, delay_s=delay_s)

    @property
    def airspeed_doubt(self) -> str:
        """Sentence about an air speed without a sensor, from the parameters; empty without a doubt."""
        vehicle = self._finder.vehicle
        if vehicle is None:
            return ""
        stated = self._parameters.stated(speakers(vehicle), vehicle.autopilot)
        off = next((name for name in AIRSPEED_SENSOR if stated.get(name) == 0.0), None)
        if off is None:
            return ""
        return (
            f"{off} is 0: no sensor measures the air speed. The autopilot computes it from the ground speed, "
            "and wind makes the derivatives wrong."
        )

    def distrusts(self, distrusted: Sequence[Distrust]) -> list[Distrust]:
        """Return the wrong channels among the distrusted ones, except for the bundled aircraft's constant air
        speed."""
        return [d for d in distrusted if not (self.simulated and d.channel == "airspeed")]

    def learn(self, piece: Sequence[Columns], now_s: float = nan, flown: bool = False) -> list[FlightEvent]:
        """Take messages of which at most the first changes the identity.

        Parameters
        ----------
        now_s
            Vehicle time of the newest sample, s since boot.
        flown
            Whether a test input has been flown, after which the elevator's scale is fixed.
        """
        events = self._choose(piece)
        for columns in piece:
            if columns.name == "HEARTBEAT":
                events += self._heartbeat(columns)
            elif columns.name == "PARAM_VALUE":
                events += self.outputs.hear(columns, now_s, flown)
            elif columns.name == "EXTENDED_SYS_STATE":
                self._flies_on(columns)
            elif columns.name == "AUTOPILOT_VERSION":
                self._version(columns)
            elif columns.name == "STATUSTEXT":
                events += self._text(columns)
        return events

    @property
    def may_choose(self) -> bool:
        """Whether another vehicle may be followed later."""
        return self._finder.may_choose

    def _choose(self, piece: Sequence[Columns]) -> list[FlightEvent]:
        """Follow another vehicle if the present vehicle's data cannot be used and the other vehicle's data
        can.
        """
        before = self._finder.vehicle
        if before is None or not piece:
            return []
        better = self._following.better(piece, before, list(self._finder.heard.values()))
        return self._follow(better) if better is not None and self.may_choose else []

    def _follow(self, vehicle: Vehicle) -> list[FlightEvent]:
        before = self._finder.vehicle
        assert before is not None
        self._finder.follow(vehicle)
        self._mode, self._hovers = "", False
        return [
            VehicleFound(vehicle),
            Notice(
                "vehicle_changed",
                f"Vehicle {vehicle.system} is now followed in place of vehicle {before.system}; "
                f"--target-system {before.system} keeps to that one.",
            ),
            *self.outputs.follow(),
        ]

    def _heartbeat(self, columns: Columns) -> list[FlightEvent]:
        events: list[FlightEvent] = []
        before = len(self._finder.others)
        if self._finder.hear(columns):
            assert self._finder.vehicle is not None
            events += [VehicleFound(self._finder.vehicle), *self.outputs.follow()]
        if len(self._finder.others) > before:
            others = ", ".join(str(n) for n in sorted(self._finder.others))
            events.append(
                Notice(
                    "several_vehicles",
                    f"Other vehicles are heard too (system {others}): --target-system picks one.",
                )
            )
        vehicle = self._finder.vehicle
        if vehicle and (columns.system, columns.component) == (vehicle.system, vehicle.component):
            custom = int(columns.fields["custom_mode"][0])
            self._mode = mode_name(vehicle.autopilot, vehicle.type, custom)
        return events

    def _flies_on(self, columns: Columns) -> None:
        vehicle = self._finder.vehicle
        if vehicle and (columns.system, columns.component) == (vehicle.system, vehicle.component):
            self._hovers = int(columns.fields["vtol_state"][0]) in _ON_ROTORS

    def _version(self, columns: Columns) -> None:
        packed = int(columns.fields["flight_sw_version"][0])
        if packed:
            kind = next((name for least, name in _RELEASES if packed & 0xFF >= least), "")
            version = f"{packed >> 24 & 0xFF}.{packed >> 16 & 0xFF}.{packed >> 8 & 0xFF}{kind}"
            self._version_told(columns.system, version)

    def _version_told(self, system: int, version: str) -> None:
        """Keep the more detailed version text, such as 4.8.0-beta1 instead of 4.8.0-beta."""
        if not self._firmware.get(system, "").startswith(version):
            self._firmware[system] = version

    def _text(self, columns: Columns) -> list[FlightEvent]:
        text = bytes(columns.fields["text"][0])
        if text.startswith(READER):
            said = text.removeprefix(READER).decode("utf-8", "replace")
            return [Notice(READER_NOTICE, f"{said}.")]
        taken = chosen(text, TAKE)
        if taken is not None and self._finder.vehicle is not None:
            return self.outputs.take(taken)
        other = self._finder.heard.get(chosen(text, FOLLOW) or 0)
        if other is not None and other != self._finder.vehicle:
            return self._follow(other)
        if text.startswith(_BUNDLED):
            self.simulated = True
        words = text.split()
        if len(words) > 1 and words[0].startswith(b"Ardu") and words[1][:1] == b"V":
            version = printable(words[1][1:].decode("ascii", "replace"))
            if version.startswith(self._firmware.get(columns.system, "")):
                self._version_told(columns.system, version)
        return []
