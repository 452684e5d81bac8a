"""From records of a link to messages, and to the vehicle that the flight's own stream follows."""

from dataclasses import replace

from advisor.aircraft import Elevator
from advisor.flight.identity import Identity
from advisor.flight.messages import Columns
from advisor.flight.pieces import pieces
from advisor.mavlink.frames import FrameScanner
from advisor.mavlink.health import LinkStatistics
from advisor.mavlink.outgoing import OWN_COMPONENT, OWN_SYSTEM, Heartbeat, Ids, Packer


class Decoding:
    """Decodes as a log is decoded, and decides whom to follow by the same messages as the flight's stream.

    Parameters
    ----------
    elevator
        As the aircraft file has it: it tells which of several vehicles has one. None: by the parameters.
    target_system
        System id of the vehicle; None: the first autopilot heard.
    """

    def __init__(self, elevator: Elevator | None, target_system: int | None) -> None:
        # No packet of the vehicle shall wait for the decoder's kernels to be loaded.
        hello = Packer(None).pack(Heartbeat().speak(None, 0.0)[0], (OWN_SYSTEM, OWN_COMPONENT), 0)
        FrameScanner().feed(bytes(8) + hello)
        self._scanner = FrameScanner()
        self._who = Identity(elevator or Elevator(), target_system)
        self._followed: Ids | None = None

    def feed(self, records: bytes) -> list[Columns]:
        """Return the messages of these records."""
        columns = self._scanner.feed(records)
        for piece in pieces(columns, by_second=True):
            self._who.learn(piece)
        return columns

    def counted(self, statistics: LinkStatistics) -> LinkStatistics:
        """Return the statistics with what the decoder counts of the vehicle: frames lost, late, and come
        twice."""
        vehicle = statistics.vehicle
        received = self._scanner.statistics.senders.get(vehicle) if vehicle is not None else None
        if received is None:
            return statistics
        return replace(
            statistics,
            vehicle_messages=received.frames,
            lost=received.lost,
            repeated=received.repeated,
            repeated_after_s=received.repeated_after_s,
            late=received.late,
        )

    def forget_followed(self) -> None:
        """Whoever listens is new: tell the vehicle again."""
        self._followed = None

    def newly_followed(self) -> Ids | None:
        """Return the vehicle followed since the last call; None: the same as before."""
        vehicle = self._who.vehicle
        followed = (vehicle.system, vehicle.component) if vehicle is not None else None
        if followed == self._followed:
            return None
        self._followed = followed
        return followed
