"""Noticing that a stream has slowed down: another ground station can cut 50 Hz to 4 Hz in flight."""

from collections.abc import Collection

from advisor.mavlink.company import who_sets_rates
from advisor.mavlink.definitions import DEFINITIONS
from advisor.mavlink.delivery import Delivery
from advisor.mavlink.framing import Frame

WATCHED = ("ATTITUDE", "SERVO_OUTPUT_RAW", "AOA_SSA")
WINDOW_S = 3.0
FALLEN = 0.6
"""Share of its best rate below which a stream counts as cut."""
RECOVERED = 0.8
LEAST_HZ = 2.0
"""Least best rate of a stream that can be cut, Hz: a window holds too few messages of a slower one."""

_NAMES = {DEFINITIONS[name].id: name for name in WATCHED}


class RateWatch:
    """Holds the indispensable messages of one vehicle against their best rates, window by window.

    Silence is not its business: a window with a pause in it tells nothing of rates.
    """

    def __init__(self) -> None:
        self._delivery = Delivery(_NAMES, WINDOW_S)
        self._best_hz: dict[int, float] = {}
        self._cut: set[int] = set()

    def restart(self) -> None:
        """The vehicle rebooted: its streams begin at their own rates."""
        self._best_hz.clear()
        self._cut.clear()
        self._delivery.restart()

    def look(self, from_vehicle: list[Frame], now_s: float, stations: Collection[int] = ()) -> list[str]:
        """Return sentences for what the vehicle's newest frames reveal.

        Parameters
        ----------
        from_vehicle
            Its frames since the last look.
        now_s
            Monotonic seconds.
        stations
            System ids of the ground stations heard.
        """
        if not from_vehicle:
            return []
        for frame in from_vehicle:
            self._delivery.hear(frame.message_id, now_s)
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
