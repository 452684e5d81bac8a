"""Two senders under one system id, between whose clocks the vehicle's clock seems to jump."""

from collections.abc import Sequence

import numpy as np

from advisor.flight.signals.messages import Columns
from advisor.words.problems import Problem

WINDOW_S = 5.0
"""Stretch of arrival over which jumps are counted, s."""
LEAST_JUMP_S = 0.5
"""Least step back of the clock that counts, s. Packets that a radio delivers late lie closer."""
FEWEST_JUMPS = 3
"""Fewest steps back within the window. A reboot sets the clock back only once."""
NO_PACKET_S = 5.0
"""Largest delay of a packet, s. A larger step back shows another clock, even once."""
LARGEST_SPREAD_S, LEAST_SHARE = 0.5, 0.25
"""Two near clocks keep their distance and alternate. The values are the largest spread of the steps back, s,
and the least share of steps. Late packets meet neither."""


class SenderWatch:
    """Follows the stamps of ATTITUDE under one system and component id."""

    def __init__(self) -> None:
        self._arrival_s = np.empty(0)
        self._stamp_s = np.empty(0)
        self.seen: Problem | None = None
        """Problem of two senders, once they were detected."""

    def hear(self, columns: Sequence[Columns], component: int) -> None:
        """Take the vehicle's messages in order of arrival."""
        for c in columns:
            if c.name == "ATTITUDE" and c.component == component:
                stamps = np.asarray(c.fields["time_boot_ms"], dtype=np.float64) / 1000.0
                self._arrival_s = np.concatenate((self._arrival_s, c.arrival_s))
                self._stamp_s = np.concatenate((self._stamp_s, stamps))

    def problem(self, system: int, now_s: float) -> Problem | None:
        """Return the problem of two senders at this time of arrival; None for a single clock."""
        lately = (self._arrival_s > now_s - WINDOW_S) & (self._arrival_s <= now_s)
        steps = np.diff(self._stamp_s[lately])
        kept = self._arrival_s > now_s - WINDOW_S
        self._arrival_s, self._stamp_s = self._arrival_s[kept], self._stamp_s[kept]
        back = -steps[steps < -LEAST_JUMP_S]
        if len(back) < FEWEST_JUMPS:
            return None
        near = float(np.median(back)) < NO_PACKET_S
        if near and (np.ptp(back) > LARGEST_SPREAD_S or len(back) < LEAST_SHARE * len(steps)):
            return None
        self.seen = Problem(
            "two_senders",
            f"Two vehicles send under system id {system}: their clocks lie {np.median(back):.0f} s apart.",
            "Give one of them another id (SYSID_THISMAV, MAV_SYSID, MAV_SYS_ID), or take it off the link.",
        )
        return self.seen
