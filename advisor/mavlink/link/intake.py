"""Processing of received bytes to accepted frames, and identification of vehicle and ground stations."""

from collections.abc import Collection, Mapping

from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.flight.vehicle.vehicle import is_aircraft
from advisor.mavlink.link.health import LinkCounters
from advisor.mavlink.link.transports import Peer
from advisor.mavlink.wire.framing import RADIO_STATUS, Frame, FrameCutter, SignatureCheck

HEARTBEAT = dialect.MAVLINK_MSG_ID_HEARTBEAT
MOST_PEERS = 64


class Intake:
    """Cutter, checker and counter of frames, which knows the vehicle and its network address.

    Parameters
    ----------
    target_system
        System id of the vehicle; None for the first autopilot that sends.
    signatures
        Check of signatures on received frames. None to accept unsigned frames.
    """

    def __init__(
        self, crc_extra: Mapping[int, int], target_system: int | None, signatures: SignatureCheck | None
    ) -> None:
        self._crc_extra = crc_extra
        self._target_system = target_system
        self._signatures = signatures
        self._cutters: dict[Peer, FrameCutter] = {}
        self._bad_crc = 0
        self.counters = LinkCounters()
        self.ground_stations: set[int] = set()
        """System ids of the ground stations on the link."""
        self.vehicle: tuple[int, int] | None = None
        self._peers: dict[int, Peer] = {}
        self.other_vehicles: set[int] = set()
        """System ids of other autopilots than the vehicle's."""

    def take(self, pieces: list[tuple[Peer, bytes]], now_s: float) -> list[Frame]:
        """Return the frames that these pieces complete, of every system, in order of arrival."""
        taken: list[Frame] = []
        for peer, data in pieces:
            frames = [frame for frame in self._cutter(peer).feed(data) if self._believed(frame)]
            for frame in frames:
                if frame.message_id == HEARTBEAT:
                    self._meet(frame)
            self._peers.update((frame.system, peer) for frame in frames)
            taken += frames
        self.counters.add(taken, now_s)
        return taken

    @property
    def vehicle_peer(self) -> Peer | None:
        return self._peers.get(self.vehicle[0]) if self.vehicle is not None else None

    def follow(self, vehicle: tuple[int, int]) -> None:
        if self.vehicle is not None:
            self.other_vehicles.add(self.vehicle[0])
        self.other_vehicles.discard(vehicle[0])
        self.vehicle = vehicle

    def forget_pieces(self) -> None:
        """Drop incomplete frames after a cut of the connection."""
        for cutter in self._cutters.values():
            self._bad_crc += cutter.bad_crc
        self._cutters.clear()

    @property
    def bad_crc(self) -> int:
        """Number of frames with a wrong checksum."""
        return self._bad_crc + sum(cutter.bad_crc for cutter in tuple(self._cutters.values()))

    def _cutter(self, peer: Peer) -> FrameCutter:
        cutter = self._cutters.get(peer)
        if cutter is None:
            if len(self._cutters) >= MOST_PEERS:  # somebody changes his port with every packet
                self.forget_pieces()
            cutter = self._cutters[peer] = FrameCutter(self._crc_extra)
        return cutter

    def _believed(self, frame: Frame) -> bool:
        if self._signatures is None or frame.message_id == RADIO_STATUS:
            return True
        verdict = self._signatures.verdict(frame.raw)
        if verdict != "ok":
            self.counters.refused[verdict] += 1
        return verdict == "ok"

    def _meet(self, heartbeat: Frame) -> None:
        if is_ground_station(heartbeat):
            self.ground_stations.add(heartbeat.system)
            return
        payload = heartbeat.payload.ljust(9, b"\0")
        kind, autopilot = payload[4], payload[5]
        if not is_aircraft(autopilot, kind):
            return
        if self._target_system is not None and heartbeat.system != self._target_system:
            return
        if self.vehicle is None:
            self.vehicle = (heartbeat.system, heartbeat.component)
        elif heartbeat.system != self.vehicle[0]:
            self.other_vehicles.add(heartbeat.system)


CURE = (
    "start MAVProxy with --streamrate=-1, set Mission Planner's telemetry rates to -1, or let the vehicle "
    "control the stream rates in QGroundControl"
)


def is_ground_station(frame: Frame) -> bool:
    """Return whether a frame is the heartbeat of a ground station."""
    if frame.message_id != HEARTBEAT:
        return False
    payload = frame.payload.ljust(9, b"\0")
    return (payload[4], payload[5]) == (dialect.MAV_TYPE_GCS, dialect.MAV_AUTOPILOT_INVALID)


def who_sets_rates(stations: Collection[int]) -> str:
    """Return a clause about the station that may have changed the rates, with the remedy."""
    if not stations:
        return f"another ground station may set the rates, though none is heard here; {CURE}"
    which = ", ".join(map(str, sorted(stations)))
    several = len(stations) > 1
    who = f"ground stations {which} are" if several else f"ground station {which} is"
    return f"{who} at work on this link and may set the rates; {CURE}"
