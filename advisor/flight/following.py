"""Which of several vehicles is followed, decided from the stream alone, so that a log and a link agree.

The first vehicle heard is followed. One that falls silent, or that has no elevator, is left for the only
other one that has an elevator and sends. One that has served for a while is kept, however long it is silent:
its flight test shall not end in that of another aircraft. Where no choice is plain, the crew is asked.
"""

from collections.abc import Callable, Sequence

import numpy as np

from advisor.flight.messages import Columns
from advisor.flight.vehicle import Vehicle

GIVEN_UP_AFTER_S = 15.0
"""So long may a vehicle be silent, or its elevator unknown, before another is followed, s: as long as
parameters and streams take to arrive after a vehicle is first heard."""
LATELY_S = 5.0
"""A vehicle sends when all that it needs came within this time, s."""
SERVED_S = 60.0
"""A vehicle that served so long in all is kept, s: two manoeuvres with their pauses."""

FOLLOW = b"Advisor follows vehicle "
"""How the advisor writes into its own stream that a hand chose another vehicle; a number ends the text."""

TAKE = b"Advisor takes for the elevator output "
"""How the advisor writes into its own stream that a hand took a guess; the output's number ends the text."""

_OUTPUTS = frozenset({"SERVO_OUTPUT_RAW", "ACTUATOR_OUTPUT_STATUS"})
_ATTITUDES = frozenset({"ATTITUDE", "ATTITUDE_QUATERNION"})


def chosen(text: bytes, what: bytes) -> int | None:
    """Return the number that a text of the advisor, ``FOLLOW`` or ``TAKE``, gives; None for any other
    text."""
    number = text.removeprefix(what)
    return int(number) if text.startswith(what) and number.isdigit() else None


class Following:
    """Weighs the vehicles against each other once a second of arrival.

    Parameters
    ----------
    has_elevator
        Whether the outputs of a vehicle that make its elevator are known.
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
        """Return the vehicle to be followed from this piece on in place of ``vehicle``; None: the same.

        Parameters
        ----------
        piece
            Messages of one second of arrival, whoever sent them.
        vehicle
            Who is followed.
        all_heard
            Every vehicle that has sent a heartbeat.
        """
        second = int(min(float(c.arrival_s[0]) for c in piece))
        found = None
        if self._second is not None and second > self._second:
            found = self._weigh(float(second), vehicle, all_heard)
        self._second = max(second, self._second or second)
        for c in piece:
            kind = "output" if c.name in _OUTPUTS else "attitude" if c.name in _ATTITUDES else ""
            newest = self._heard.setdefault(c.system, {})
            newest[""] = newest[kind] = float(c.arrival_s[-1])
        return found

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
