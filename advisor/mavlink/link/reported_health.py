"""Health of a link as its process reports it, through restarts of that process."""

import time
from dataclasses import replace
from math import inf

from advisor.mavlink.link.health import LinkStatistics
from advisor.process.liveness import OLD_AFTER_S

STARTED_WITHIN_S = 0.5
"""Time before the first connection to a new process, s, at most, within which that process began."""


class ReportedHealth:
    """Keeps the newest report of a link's process, with what an earlier process knew."""

    def __init__(self) -> None:
        self._newest = LinkStatistics()
        self._connected_s = self._vehicle_heard_s = -inf
        self._unanswered_s = 0.0

    @property
    def statistics(self) -> LinkStatistics:
        """Health of the link, as reported last."""
        return replace(self._newest, unanswered_s=self._unanswered_s)

    def reconnected(self) -> None:
        """Take note of a new process behind the link."""
        self._connected_s = time.monotonic()

    def take(self, statistics: LinkStatistics) -> None:
        """Take a report. The vehicle and its silence outlast the process that heard them."""
        now_s = time.monotonic()
        heard_s = now_s - statistics.silent_s
        # A process counts the silence from its own start.
        if heard_s > self._connected_s + STARTED_WITHIN_S:
            self._vehicle_heard_s = heard_s
        vehicle = statistics.vehicle or self._newest.vehicle
        self._newest = replace(statistics, vehicle=vehicle, silent_s=now_s - self._vehicle_heard_s)

    def waited(self, seconds: float) -> bool:
        """Take a wait without a message; return whether with it the process counts as not answering.

        The process says something every 0.2 s.
        """
        before_s, self._unanswered_s = self._unanswered_s, self._unanswered_s + seconds
        return before_s < OLD_AFTER_S <= self._unanswered_s

    def answered(self) -> bool:
        """Take the arrival of a message; return whether a silence of the process ends with it."""
        ends = self._unanswered_s >= OLD_AFTER_S
        self._unanswered_s = 0.0
        return ends
