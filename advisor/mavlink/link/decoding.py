"""Decoding of a link's records to messages, and the choice of the followed vehicle."""

from dataclasses import replace

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.flight.signals.messages import Columns
from advisor.flight.stream.identity import Identity
from advisor.flight.vehicle.pieces import pieces
from advisor.mavlink.link.health import LinkStatistics
from advisor.mavlink.link.outgoing import OWN_COMPONENT, OWN_SYSTEM, Heartbeat, Ids, Packer
from advisor.mavlink.wire.frames import FrameScanner


class Decoding:
    """Decoder of a link's records, which chooses the vehicle like the flight's stream.

    Parameters
    ----------
    elevator
        Elevator of the aircraft file, by which the vehicle with an elevator is found. None to decide by
        parameters.
    target_system
        System id of the vehicle; None for the first autopilot that sends.
    """

    def __init__(self, elevator: Elevator | None, target_system: int | None) -> None:
        # No packet of the vehicle may wait for the decoder's kernels to load.
        hello = Packer(None).pack(Heartbeat().speak(None, 0.0)[0], (OWN_SYSTEM, OWN_COMPONENT), 0)
        FrameScanner().feed(bytes(8) + hello)
        self._scanner = FrameScanner()
        self._who = Identity(Aircraft(elevator=elevator or Elevator()), target_system)
        self._followed: Ids | None = None

    def feed(self, records: bytes) -> list[Columns]:
        columns = self._scanner.feed(records)
        for piece in pieces(columns, by_second=True):
            self._who.learn(piece)
        return columns

    def counted(self, statistics: LinkStatistics) -> LinkStatistics:
        """Return the statistics with the decoder's counts of lost, late and repeated vehicle frames."""
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
        """Report the followed vehicle again, for a new listener."""
        self._followed = None

    def newly_followed(self) -> Ids | None:
        """Return the vehicle if it changed since the last call; else None."""
        vehicle = self._who.vehicle
        followed = (vehicle.system, vehicle.component) if vehicle is not None else None
        if followed == self._followed:
            return None
        self._followed = followed
        return followed
