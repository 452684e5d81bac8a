"""Counts of a vehicle's messages in windows of the vehicle's own clock.

After a pause of the advisor or of the computer, waiting packets arrive all at once. By the clock of arrival
their rate would be a multiple of the true rate.
"""

import struct
from collections import Counter
from collections.abc import Collection

from advisor.mavlink.wire.definitions import DEFINITIONS
from advisor.mavlink.wire.framing import Frame

_CLOCK = DEFINITIONS["ATTITUDE"].id
"""Message whose stamp, the milliseconds since boot, is the vehicle's clock."""


class Delivery:
    """Counter of messages with some ids. A window with a pause of the vehicle, or of its clock, gives no
    rates.

    A window ends after its length by the clock of arrival. Rates are computed with the vehicle's clock, or
    with the clock of arrival without it.

    Parameters
    ----------
    window_s
        Length of a window, s.
    """

    def __init__(self, messages: Collection[int], window_s: float) -> None:
        self._messages = frozenset(messages)
        self._window_s = window_s
        self._counts: Counter[int] = Counter()
        self._since_s: float | None = None
        self._heard_s = float("-inf")
        self._clock_ms: int | None = None
        self._since_ms: int | None = None

    def restart(self) -> None:
        """Begin a new window at the next call of ``look``."""
        self._since_s = None

    def hear(self, frame: Frame, now_s: float) -> None:
        """Count any frame of the vehicle."""
        if now_s - self._heard_s > self._window_s / 2.0:
            self._clock_ms = None
            self._begin(now_s)
        self._heard_s = now_s
        if frame.message_id == _CLOCK:
            (stamp_ms,) = struct.unpack_from("<I", frame.payload.ljust(4, b"\0"))
            before_ms, self._clock_ms = self._clock_ms, stamp_ms
            if before_ms is None or abs(stamp_ms - before_ms) > 500.0 * self._window_s:
                self._begin(now_s)  # with this frame: those after it count
                return
        if frame.message_id in self._messages:
            self._counts[frame.message_id] += 1

    def look(self, now_s: float) -> dict[int, float] | None:
        """Return the rate of each message in a finished window, Hz; None for an unfinished window."""
        if self._since_s is None:
            self._begin(now_s)
        assert self._since_s is not None
        elapsed_s = now_s - self._since_s
        if elapsed_s < self._window_s:
            return None
        paused = now_s - self._heard_s > self._window_s / 2.0
        if self._clock_ms is not None and self._since_ms is not None:
            elapsed_s = (self._clock_ms - self._since_ms) / 1000.0
            if elapsed_s <= 0.0:  # another boot, or a clock that stands
                elapsed_s = now_s - self._since_s
        rates = {message: self._counts[message] / elapsed_s for message in self._messages}
        self._begin(now_s)
        return None if paused else rates

    def _begin(self, now_s: float) -> None:
        self._since_s, self._since_ms = now_s, self._clock_ms
        self._counts.clear()
