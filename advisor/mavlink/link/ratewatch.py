"""Detection of a stream that slows down: another ground station can cut 50 Hz to 4 Hz in flight."""

from collections.abc import Collection

from advisor.mavlink.link.delivery import Delivery
from advisor.mavlink.link.ground_stations import who_sets_rates
from advisor.mavlink.wire.definitions import DEFINITIONS
from advisor.mavlink.wire.framing import Frame

WATCHED = ("ATTITUDE", "SERVO_OUTPUT_RAW", "AOA_SSA")
WINDOW_S = 3.0
FALLEN = 0.6
"""Share of its best rate below which a stream counts as slowed down."""
RECOVERED = 0.8
LEAST_HZ = 2.0
"""Least best rate of a watched stream, Hz. A window holds too few messages of a slower one."""

_NAMES = {DEFINITIONS[name].id: name for name in WATCHED}


class RateWatch:
    """Compares the indispensable messages of one vehicle with their best rates, window by window.

    Silence is not watched here: a window with a pause gives no rates.
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
        """Return sentences on streams that slowed down or recovered in the vehicle's newest frames.

        Parameters
        ----------
        from_vehicle
            Frames of the vehicle since the last look.
        now_s
            Monotonic seconds.
        stations
            System ids of the ground stations heard.
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
