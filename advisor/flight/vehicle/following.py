"""Choice among several vehicles, from the stream alone, so that a log and a link agree.

The first vehicle that sends is followed. If the vehicle is silent or has no elevator, the only other usable
vehicle is followed. A vehicle that was usable for a while is kept, however long it is silent. The flight test
of one aircraft must not end in that of another aircraft. If several vehicles qualify, the crew is asked.
"""

from collections.abc import Callable, Sequence

import numpy as np

from advisor.flight.signals.messages import Columns
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.words.problems import Problem

GIVEN_UP_AFTER_S = 15.0
"""Time for which a vehicle may be silent, or its elevator unknown, before another one is followed, s.
Parameters and streams take about 15 s to arrive."""
LATELY_S = 5.0
"""Time within which a vehicle must have sent all needed messages, s."""
SERVED_S = 60.0
"""Total usable time after which a vehicle is kept, s: two manoeuvres with their pauses."""

FOLLOW = b"Advisor follows vehicle "
"""Text in the stream when the crew chooses another vehicle, followed by its number."""

TAKE = b"Advisor takes for the elevator output "
"""Text in the stream when the crew accepts a guessed elevator, followed by the output's number."""

_OUTPUTS = frozenset({"SERVO_OUTPUT_RAW", "ACTUATOR_OUTPUT_STATUS"})
_ATTITUDES = frozenset({"ATTITUDE", "ATTITUDE_QUATERNION"})


def chosen(text: bytes, what: bytes) -> int | None:
    """Return the number in an advisor's text, ``FOLLOW`` or ``TAKE``; None for any other text."""
    number = text.removeprefix(what)
    return int(number) if text.startswith(what) and number.isdigit() else None


class Following:
    """Comparison of the vehicles once a second of arrival.

    Parameters
    ----------
    has_elevator
        Function that returns whether the elevator's outputs of a vehicle are known.
    """

    def __init__(self, has_elevator: Callable[[Vehicle], bool]) -> None:
        self._has_elevator = has_elevator
        self._second: int | None = None
        self._heard: dict[int, dict[str, float]] = {}
        self._served: dict[int, int] = {}
        self._useless_since_s: float | None = None

    def better(
        self, piece: Sequence[Columns], vehicle: Vehicle, all_heard: Sequence[Vehicle]
    ) -> Vehicle | None:
        """Return the vehicle that replaces ``vehicle`` after these messages; None to keep ``vehicle``.

        Parameters
        ----------
        piece
            Messages of one second of arrival, from all senders.
        """
        second = int(min(float(c.arrival_s[0]) for c in piece))
        replacement = None
        if self._second is not None and second > self._second:
            replacement = self._weigh(float(second), vehicle, all_heard)
        self._second = max(second, self._second or second)
        for c in piece:
            kind = "output" if c.name in _OUTPUTS else "attitude" if c.name in _ATTITUDES else ""
            newest = self._heard.setdefault(c.system, {})
            newest[""] = newest[kind] = float(c.arrival_s[-1])
        return replacement

    def _weigh(self, now_s: float, vehicle: Vehicle, all_heard: Sequence[Vehicle]) -> Vehicle | None:
        if self._qualifies(vehicle, now_s):
            self._served[vehicle.system] = self._served.get(vehicle.system, 0) + 1
            self._useless_since_s = None
            return None
        if self._useless_since_s is None:
            self._useless_since_s = now_s
        if (
            self._served.get(vehicle.system, 0) >= SERVED_S
            or now_s - self._useless_since_s < GIVEN_UP_AFTER_S
        ):
            return None
        others = [v for v in all_heard if v.system != vehicle.system and self._qualifies(v, now_s)]
        if len(others) != 1:
            return None
        self._useless_since_s = None
        return others[0]

    def _qualifies(self, vehicle: Vehicle, now_s: float) -> bool:
        heard = self._heard.get(vehicle.system, {})
        sends = all(now_s - heard.get(kind, -np.inf) <= LATELY_S for kind in ("output", "attitude"))
        return sends and not vehicle.is_multicopter and self._has_elevator(vehicle)


WINDOW_S = 5.0
"""Length of arrival time over which clock jumps are counted, s."""
LEAST_JUMP_S = 0.5
"""Least backward step of the clock that is counted, s. Packets that a radio delivers late have smaller
steps."""
FEWEST_JUMPS = 3
"""Least number of backward steps within the window for two senders. A reboot sets the clock back only
once."""
NO_PACKET_S = 5.0
"""Largest delay of a packet, s. A larger backward step shows another clock, even if it occurs once."""
LARGEST_SPREAD_S, LEAST_SHARE = 0.5, 0.25
"""Largest spread of the backward steps, s, and least fraction of such steps, for two close clocks. Two clocks
keep their distance and alternate. Late packets meet neither condition.
"""


class SenderWatch:
    """Watch of the ATTITUDE stamps under one system and component id."""

    def __init__(self) -> None:
        self._arrival_s = np.empty(0)
        self._stamp_s = np.empty(0)
        self.seen: Problem | None = None
        """Problem of two senders; None unless detected."""

    def hear(self, columns: Sequence[Columns], component: int) -> None:
        """Take the vehicle's messages in order of arrival."""
        for c in columns:
            if c.name == "ATTITUDE" and c.component == component:
                stamps = np.asarray(c.fields["time_boot_ms"], dtype=np.float64) / 1000.0
                self._arrival_s = np.concatenate((self._arrival_s, c.arrival_s))
                self._stamp_s = np.concatenate((self._stamp_s, stamps))

    def problem(self, system: int, now_s: float) -> Problem | None:
        """Return the problem of two senders at a time of arrival; None for a single clock."""
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
            "Give one vehicle another id (SYSID_THISMAV, MAV_SYSID, MAV_SYS_ID), or take it off the link.",
        )
        return self.seen
