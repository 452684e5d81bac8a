"""Detection of a reboot on the link, by a clock that runs back."""

import struct

import numpy as np

from advisor.flight.signals.clocks import BootClock
from advisor.mavlink.wire.definitions import DEFINITIONS
from advisor.mavlink.wire.framing import Frame

_ATTITUDE = DEFINITIONS["ATTITUDE"].id


class RebootWatch:
    """Follows the clock of ATTITUDE by the rules of the flight's own stream."""

    def __init__(self) -> None:
        self._clock = BootClock()

    def hear(self, frame: Frame) -> bool:
        """Take a frame of the vehicle; return True when it confirms a reboot."""
        if frame.message_id != _ATTITUDE:
            return False
        boot = self._clock.boot
        (stamp,) = struct.unpack_from("<I", frame.payload.ljust(4, b"\0"))
        self._clock.advance(np.array([stamp], dtype=np.int64))
        return self._clock.boot != boot
