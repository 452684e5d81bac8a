"""Sentences for the crew about the link: silence, interruption, recovery, a second vehicle, a
slower stream.
"""

import struct
from collections.abc import Collection

import numpy as np

from advisor.flight.signals.clocks import BootClock
from advisor.mavlink.link.delivery import Delivery
from advisor.mavlink.link.intake import Intake, who_sets_rates
from advisor.mavlink.wire.definitions import DEFINITIONS
from advisor.mavlink.wire.framing import Frame

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
