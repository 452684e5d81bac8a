"""Identity of the vehicle: the heartbeat of an aircraft among all senders."""

from dataclasses import dataclass, replace

from advisor.flight.signals.messages import Columns
from advisor.words.mends import Carrier, Mends, mends_of
from advisor.words.problems import Problem

# Numbers of MAV_AUTOPILOT and MAV_TYPE, MAVLink common.xml.
_AUTOPILOT_INVALID = 8
_AUTOPILOTS = {0: "generic", 3: "ardupilot", 12: "px4", 4: "openpilot", 15: "armazila", 18: "smartap"}
_PERIPHERALS = frozenset({5, 6, 18, 26, 27, 30, 31, 32, 33, 34, 36, 37, 38, 39, 40, 41, 42})
"""Values of MAV_TYPE that are no vehicle, such as antenna tracker, ground station, gimbal and camera."""
MULTICOPTERS = frozenset({2, 13, 14, 15, 29, 35})
"""Values of MAV_TYPE for aircraft with four, six, eight, three, twelve and ten rotors."""


@dataclass(frozen=True, slots=True)
class Vehicle:
    """Autopilot of the vehicle whose messages are used."""

    system: int
    component: int
    autopilot: str
    """``ardupilot``, ``px4``, or another name or number of MAV_AUTOPILOT."""
    type: int
    """MAV_TYPE of the heartbeat."""
    firmware: str | None = None
    """Firmware version that the vehicle states. None before the first statement."""
    carrier: Carrier = "telemetry"
    """Kind of record or link that carries the messages, on which the remedies depend."""
    log_profile: int | None = None
    """Value of SDLOG_PROFILE of a PX4 log; None if unknown. Remedies name only bits that are not set."""

    def __str__(self) -> str:
        return f"{self.autopilot} {self.system}/{self.component}"

    @property
    def is_multicopter(self) -> bool:
        """Whether rotors alone steer the vehicle."""
        return self.type in MULTICOPTERS

    @property
    def no_elevator(self) -> Problem | None:
        """Reason why the vehicle's kind has no elevator; None if the vehicle can have an elevator."""
        if not self.is_multicopter:
            return None
        return Problem(
            "multicopter",
            f"{self} is a multicopter: it has no elevator.",
            "Give the log or link of an aircraft with an elevator.",
        )

    @property
    def mends(self) -> Mends:
        """Remedies for missing or slow messages, in the terms of this autopilot."""
        return mends_of(self.autopilot, self.carrier, self.log_profile)

    def with_firmware(self, firmware: str) -> "Vehicle":
        return replace(self, firmware=firmware)


def is_aircraft(autopilot: int, kind: int) -> bool:
    """Return whether a heartbeat with this MAV_AUTOPILOT and MAV_TYPE is that of a vehicle."""
    return autopilot != _AUTOPILOT_INVALID and kind not in _PERIPHERALS


class VehicleFinder:
    """Choice of the vehicle among all senders of heartbeats.

    Parameters
    ----------
    target_system
        System id that the user asked for. None for the first vehicle that sends.
    """

    def __init__(self, target_system: int | None = None) -> None:
        self._target = target_system
        self.vehicle: Vehicle | None = None
        self.others: set[int] = set()
        """System ids of the other vehicles on the stream."""
        self.heard: dict[int, Vehicle] = {}
        """Every vehicle since its first heartbeat, by its system id."""

    def hear(self, heartbeat: Columns) -> bool:
        """Take the first row of one sender's heartbeats, and return whether it determines the vehicle."""
        autopilot = int(heartbeat.fields["autopilot"][0])
        kind = int(heartbeat.fields["type"][0])
        if not is_aircraft(autopilot, kind):
            return False
        name = _AUTOPILOTS.get(autopilot, f"autopilot {autopilot}")
        vehicle = Vehicle(heartbeat.system, heartbeat.component, name, kind, carrier=heartbeat.carrier)
        self.heard.setdefault(heartbeat.system, vehicle)
        if self.vehicle is None and self._target in (None, heartbeat.system):
            self.follow(vehicle)
            return True
        if self.vehicle is None or heartbeat.system != self.vehicle.system:
            self.others.add(heartbeat.system)
        return False

    @property
    def may_choose(self) -> bool:
        """Whether the user named no vehicle, and there are several."""
        return self._target is None and self.vehicle is not None and bool(self.others)

    def follow(self, vehicle: Vehicle) -> None:
        self.others |= {other for other in self.heard if self.vehicle is not None}
        self.others.discard(vehicle.system)
        self.vehicle = vehicle
