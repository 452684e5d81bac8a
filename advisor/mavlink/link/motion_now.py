"""Present bank and air speed, read from frames without a decoder."""

import math
import struct

from advisor.mavlink.wire.framing import Frame

_ATTITUDE, _VFR_HUD = 30, 74


class MotionNow:
    """Newest bank and air speed of one system. No estimate delays these values."""

    def __init__(self) -> None:
        self.bank_rad = self.airspeed_m_s = math.nan
        """Newest bank, rad; NaN before the first message."""

    def look(self, frames: list[Frame], system: int) -> None:
        """Read the newest values from frames of this system."""
        for frame in frames:
            if frame.system != system:
                continue
            # MAVLink 2 cuts zeros from the end of a payload.
            if frame.message_id == _ATTITUDE:
                self.bank_rad = struct.unpack_from("<f", frame.payload.ljust(8, b"\0"), 4)[0]
            elif frame.message_id == _VFR_HUD:
                self.airspeed_m_s = struct.unpack_from("<f", frame.payload.ljust(4, b"\0"))[0]
