"""Health of a link: counters, a snapshot, and the report of its process through restarts."""

import math
import time
from collections import Counter, deque
from collections.abc import Mapping, Sized
from dataclasses import dataclass, field, replace
from math import inf
from pathlib import Path

from advisor.process.liveness import OLD_AFTER_S

RATE_WINDOW_S = 2.0


@dataclass(frozen=True, slots=True)
class LinkStatistics:
    """Counts of a link at one moment."""

    connected: bool = False
    vehicle: tuple[int, int] | None = None
    """System and component id of the followed vehicle. None before the first heartbeat of an autopilot."""
    messages: int = 0
    """Number of frames received from all systems."""
    messages_per_s: float = 0.0
    """Rate of frames over the last two seconds, 1/s."""
    vehicle_messages: int = 0
    """Number of frames received from the vehicle, each counted once."""
    lost: int = 0
    """Number of the vehicle's frames that are missing in its sequence numbers."""
    repeated: int = 0
    """Number of the vehicle's frames that a second path repeated."""
    repeated_after_s: float = math.nan
    """Mean delay of a repeat after the first copy, s."""
    late: int = 0
    """Number of the vehicle's frames that arrived after a later one."""
    bad_crc: int = 0
    refused: Mapping[str, int] = field(default_factory=dict)
    """Number of refused frames by reason: ``unsigned``, ``forged``, ``replayed``."""
    silent_s: float = 0.0
    """Time since the vehicle's last frame, s."""
    reconnects: int = 0
    first_s: float = math.nan
    """Host time of the first record that the link's process heard, seconds since 1970."""
    newest_s: float = math.nan
    """Host time of the newest record, seconds since 1970. NaN before the first record arrives."""
    bank_rad: float = math.nan
    """Bank of the vehicle from its newest ATTITUDE, rad. NaN before the first."""
    airspeed_m_s: float = math.nan
    """Air speed of the vehicle from its newest VFR_HUD, m/s. NaN before the first."""
    unanswered_s: float = 0.0
    """Time for which the link's process has not answered its reader, s."""
    recording: Path | None = None
    recorded_bytes: int = 0
    recording_problem: str | None = None
    """Reason why the recording cannot be written at this moment; None while it can."""

    @property
    def lost_percent(self) -> float:
        """Share of the vehicle's frames that did not arrive, per cent."""
        sent = self.vehicle_messages + self.lost
        return 100.0 * self.lost / sent if sent else 0.0

    @property
    def repeated_percent(self) -> float:
        """Share of the vehicle's frames that arrived twice, per cent."""
        return 100.0 * self.repeated / self.vehicle_messages if self.vehicle_messages else 0.0


class LinkCounters:
    """Counters from which ``LinkStatistics`` is made. Times are monotonic seconds of the reader."""

    def __init__(self) -> None:
        self.messages = 0
        self.refused: Counter[str] = Counter()
        self._recent: deque[tuple[float, int]] = deque()

    def add(self, frames: Sized, now_s: float) -> None:
        """Count a batch of accepted frames."""
        self.messages += len(frames)
        self._recent.append((now_s, len(frames)))
        self._forget(now_s)

    def _forget(self, now_s: float) -> None:
        while self._recent and self._recent[0][0] < now_s - RATE_WINDOW_S:
            self._recent.popleft()

    def rate(self, now_s: float) -> float:
        """Return the rate of frames over the last ``RATE_WINDOW_S``, 1/s."""
        return sum(n for t, n in tuple(self._recent) if t >= now_s - RATE_WINDOW_S) / RATE_WINDOW_S


STARTED_WITHIN_S = 0.5
"""Largest time between the start of a new process and the first connection to it, s."""


class ReportedHealth:
    """Newest health report of a link's process, with facts from an earlier process."""

    def __init__(self) -> None:
        self._newest = LinkStatistics()
        self._connected_s = self._vehicle_heard_s = -inf
        self._unanswered_s = 0.0

    @property
    def statistics(self) -> LinkStatistics:
        return replace(self._newest, unanswered_s=self._unanswered_s)

    def reconnected(self) -> None:
        """Prepare for the reports of a new process behind the link."""
        self._connected_s = time.monotonic()

    def take(self, statistics: LinkStatistics) -> None:
        """Take a health report of the link's process. The vehicle and its silence are kept over a restart of
        the process."""
        now_s = time.monotonic()
        heard_s = now_s - statistics.silent_s
        # A process counts the silence from its own start.
        if heard_s > self._connected_s + STARTED_WITHIN_S:
            self._vehicle_heard_s = heard_s
        vehicle = statistics.vehicle or self._newest.vehicle
        self._newest = replace(statistics, vehicle=vehicle, silent_s=now_s - self._vehicle_heard_s)

    def waited(self, seconds: float) -> bool:
        """Add a wait without a message, and return whether the process counts as not answering.

        The process sends a message every 0.2 s.
        """
        before_s, self._unanswered_s = self._unanswered_s, self._unanswered_s + seconds
        return before_s < OLD_AFTER_S <= self._unanswered_s

    def answered(self) -> bool:
        """Record the arrival of a message, and return whether the process answers again."""
        ends = self._unanswered_s >= OLD_AFTER_S
        self._unanswered_s = 0.0
        return ends
