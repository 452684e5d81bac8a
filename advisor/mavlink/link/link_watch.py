"""Sentences for the crew about the link: silence, interruption, recovery, a second vehicle, a
slower stream.

Messages are counted in windows of the vehicle's own clock. After a pause of the advisor or of the computer,
waiting packets arrive all at once. By the clock of arrival their rate would be a multiple of the true rate.
"""

import struct
from collections import Counter
from collections.abc import Collection

import numpy as np

from advisor.flight.signals.clocks import BootClock
from advisor.mavlink.link.intake import Intake, who_sets_rates
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


SILENCE_S = 5.0

_REFUSED = {
    "unsigned": "unsigned packets are refused; the vehicle must sign with this key",
    "forged": "packets signed with another key are refused",
    "replayed": "signed packets with an old time are refused: a replay, or a sender whose clock was set back",
}


class LinkWatch:
    """Sentences about arriving frames and about their absence. Times are the reader's monotonic seconds."""

    def __init__(self, connection: str) -> None:
        self._connection = connection
        self._heard_s = 0.0
        self._silence_told = False
        self._cut_s: float | None = None
        self._others_told: set[int] = set()
        self._refusals_told: set[str] = set()
        self._rates = RateWatch()
        self._reboots = RebootWatch()
        self.reconnects = 0

    def begin(self, now_s: float) -> None:
        """Record the opening of the connection, at which silence begins to count."""
        self._heard_s = now_s

    def start_again(self) -> None:
        """Forget the rates after the choice of another vehicle."""
        self._rates.restart()
        self._reboots = RebootWatch()

    def silent_s(self, now_s: float) -> float:
        """Return the time since the vehicle's last frame, s. Without a vehicle, return the time since any
        sender's last frame.
        """
        return max(0.0, now_s - self._heard_s)

    def cut(self, why: str, now_s: float) -> str:
        """Record an interruption of the connection, and return a sentence about it."""
        if self._cut_s is None:
            self._cut_s = now_s
        return f"{self._connection}: connection lost ({why}), trying again"

    def look(self, intake: Intake, frames: list[Frame], now_s: float) -> list[str]:
        """Return sentences about these frames, or about their absence."""
        said = []
        vehicle = intake.vehicle
        relevant = [frame for frame in frames if vehicle is None or frame.system == vehicle[0]]
        if relevant:
            said += self._heard(now_s)
            for frame in relevant if vehicle else []:
                if self._reboots.hear(frame):
                    self._rates.restart()
            said += self._rates.look(relevant if vehicle else [], now_s, intake.ground_stations)
        elif not self._silence_told and self._cut_s is None and self.silent_s(now_s) >= SILENCE_S:
            self._silence_told = True
            who = f"vehicle {vehicle[0]} is" if vehicle else f"{self._connection}: no vehicle heard,"
            said.append(f"{who} silent for {SILENCE_S:.0f} s{_instead(intake)}")
        for system in sorted(intake.other_vehicles - self._others_told):
            said.append(f"vehicle {system} is heard too and ignored; choose with --target-system")
        self._others_told |= intake.other_vehicles
        refused = intake.counters.refused.keys() - self._refusals_told
        said += [f"{self._connection}: {_REFUSED[why]}" for why in sorted(refused)]
        self._refusals_told |= refused
        return said

    def _heard(self, now_s: float) -> list[str]:
        said = []
        if self._cut_s is not None:
            self.reconnects += 1
            said.append(f"{self._connection}: reconnected after {now_s - self._cut_s:.1f} s")
        elif self._silence_told:
            said.append(f"{self._connection}: heard again after {self.silent_s(now_s):.1f} s")
        self._cut_s = None
        self._silence_told = False
        self._heard_s = now_s
        return said


def _instead(intake: Intake) -> str:
    """Return a clause about another vehicle that could be followed."""
    others = sorted(intake.other_vehicles)
    if intake.vehicle is None or not others:
        return ""
    return f"; heard is vehicle {', '.join(map(str, others))}: --target-system {others[0]} follows it"


WATCHED = ("ATTITUDE", "SERVO_OUTPUT_RAW", "AOA_SSA")
WINDOW_S = 3.0
FALLEN = 0.6
"""Share of its best rate below which a stream counts as slowed down."""
RECOVERED = 0.8
LEAST_HZ = 2.0
"""Least best rate of a watched stream, Hz. A window contains too few messages of a slower stream."""

_NAMES = {DEFINITIONS[name].id: name for name in WATCHED}


class RateWatch:
    """Comparison of one vehicle's indispensable messages with their best rates, window by window.

    Silence is watched elsewhere, because a window with a pause gives no rates.
    """

    def __init__(self) -> None:
        self._delivery = Delivery(_NAMES, WINDOW_S)
        self._best_hz: dict[int, float] = {}
        self._cut: set[int] = set()

    def restart(self) -> None:
        """Forget the best rates after a reboot."""
        self._best_hz.clear()
        self._cut.clear()
        self._delivery.restart()

    def look(self, from_vehicle: list[Frame], now_s: float, stations: Collection[int] = ()) -> list[str]:
        """Return sentences about streams that slowed down or recovered in the vehicle's newest frames.

        Parameters
        ----------
        now_s
            Monotonic seconds.
        """
        if not from_vehicle:
            return []
        for frame in from_vehicle:
            self._delivery.hear(frame, now_s)
        fell, back = [], []
        for message, rate_hz in (self._delivery.look(now_s) or {}).items():
            best_hz = self._best_hz[message] = max(rate_hz, self._best_hz.get(message, 0.0))
            name = _NAMES[message]
            if message not in self._cut and best_hz >= LEAST_HZ and rate_hz < FALLEN * best_hz:
                self._cut.add(message)
                fell.append(f"{name} fell from {best_hz:.0f} Hz to {rate_hz:.1f} Hz")
            elif message in self._cut and rate_hz > RECOVERED * best_hz:
                self._cut.remove(message)
                back.append(f"{name} is back at {rate_hz:.0f} Hz")
        return [f"{', '.join(fell)}: {who_sets_rates(stations)}", *back] if fell else back


_ATTITUDE = DEFINITIONS["ATTITUDE"].id


class RebootWatch:
    """Detection of a reboot from the clock of ATTITUDE, by the rules of the flight's stream."""

    def __init__(self) -> None:
        self._clock = BootClock()

    def hear(self, frame: Frame) -> bool:
        """Take a frame of the vehicle, and return whether it confirms a reboot."""
        if frame.message_id != _ATTITUDE:
            return False
        boot = self._clock.boot
        (stamp,) = struct.unpack_from("<I", frame.payload.ljust(4, b"\0"))
        self._clock.advance(np.array([stamp], dtype=np.int64))
        return self._clock.boot != boot
