"""Noticing that a stream has slowed down: another ground station can cut 50 Hz to 4 Hz in flight."""

from collections import Counter

from advisor.mavlink.definitions import DEFINITIONS
from advisor.mavlink.framing import Frame

WATCHED = ("ATTITUDE", "SERVO_OUTPUT_RAW", "AOA_SSA")
WINDOW_S = 3.0
FALLEN = 0.6
"""Share of its best rate below which a stream counts as cut."""
RECOVERED = 0.8

_NAMES = {DEFINITIONS[name].id: name for name in WATCHED}


class RateWatch:
    """Counts the indispensable messages of one vehicle, window by window.

    Silence is not its business: a window with a pause in it tells nothing of rates.
    """

    def __init__(self) -> None:
        self._counts: Counter[int] = Counter()
        self._since_s = float("-inf")
        self._heard_s = float("-inf")
        self._best_hz: dict[int, float] = {}
        self._cut: set[int] = set()

    def look(self, from_vehicle: list[Frame], now_s: float) -> list[str]:
        """Sentences for what the vehicle's newest frames reveal."""
        if not from_vehicle:
            return []
        paused = now_s - self._heard_s > WINDOW_S / 2.0
        self._heard_s = now_s
        if paused:
            self._start_window(now_s)
        self._counts.update(frame.message_id for frame in from_vehicle if frame.message_id in _NAMES)
        elapsed_s = now_s - self._since_s
        if elapsed_s < WINDOW_S:
            return []
        rates = {message: self._counts[message] / elapsed_s for message in _NAMES}
        self._start_window(now_s)
        return [sentence for message, rate in rates.items() for sentence in self._judge(message, rate)]

    def _start_window(self, now_s: float) -> None:
        self._since_s = now_s
        self._counts.clear()

    def _judge(self, message: int, rate_hz: float) -> list[str]:
        best_hz = self._best_hz[message] = max(rate_hz, self._best_hz.get(message, 0.0))
        if message not in self._cut and rate_hz < FALLEN * best_hz:
            self._cut.add(message)
            return [
                f"{_NAMES[message]} fell from {best_hz:.0f} Hz to {rate_hz:.1f} Hz: another ground station "
                "may have changed the stream rates"
            ]
        if message in self._cut and rate_hz > RECOVERED * best_hz:
            self._cut.remove(message)
            return [f"{_NAMES[message]} is back at {rate_hz:.0f} Hz"]
        return []
