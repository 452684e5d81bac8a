"""Counts of the messages that a vehicle delivers, window by window."""

from collections import Counter
from collections.abc import Collection


class Delivery:
    """Counts messages of some ids. A window with a pause of the vehicle gives no rates.

    Parameters
    ----------
    messages
        Ids to count.
    window_s
        Length of a window, s.
    """

    def __init__(self, messages: Collection[int], window_s: float) -> None:
        self._messages = frozenset(messages)
        self._window_s = window_s
        self._counts: Counter[int] = Counter()
        self._since_s: float | None = None
        self._heard_s = float("-inf")

    def restart(self) -> None:
        """Begin a new window at the next call of ``look``."""
        self._since_s = None

    def hear(self, message: int, now_s: float) -> None:
        """Count any frame of the vehicle."""
        if now_s - self._heard_s > self._window_s / 2.0:
            self._begin(now_s)
        self._heard_s = now_s
        if message in self._messages:
            self._counts[message] += 1

    def look(self, now_s: float) -> dict[int, float] | None:
        """Return the rate of each message over a window that is complete now, Hz; None for an incomplete
        window."""
        if self._since_s is None:
            self._begin(now_s)
        assert self._since_s is not None
        elapsed_s = now_s - self._since_s
        if elapsed_s < self._window_s:
            return None
        paused = now_s - self._heard_s > self._window_s / 2.0
        rates = {message: self._counts[message] / elapsed_s for message in self._messages}
        self._begin(now_s)
        return None if paused else rates

    def _begin(self, now_s: float) -> None:
        self._since_s = now_s
        self._counts.clear()
