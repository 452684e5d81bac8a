"""Health of a link: counted frame by frame, read as a snapshot, reported by its process through restarts."""

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
class LinkNotice:
    """A message about the link for the crew."""

    at_s: float
    """Host time, seconds since 1970."""
    text: str


@dataclass(frozen=True, slots=True)
class LinkStatistics:
    """Counts of a link at one moment."""

    connected: bool = False
    vehicle: tuple[int, int] | None = None
    """System and component of the followed vehicle. None before the first heartbeat of an autopilot."""
    messages: int = 0
    """Frames taken from every system."""
    messages_per_s: float = 0.0
    """Rate of frames over the last two seconds."""
    vehicle_messages: int = 0
    """Frames taken from the vehicle, each counted once."""
    lost: int = 0
    """Frames of the vehicle missing by its sequence numbers."""
    repeated: int = 0
    """Frames of the vehicle that a second path brought again."""
    repeated_after_s: float = math.nan
    """Mean delay of a repeat after the first copy, s."""
    late: int = 0
    """Frames of the vehicle that arrived after a younger one."""
    bad_crc: int = 0
    garbage_bytes: int = 0
    refused: Mapping[str, int] = field(default_factory=dict)
    """Refused frames by reason: ``unsigned``, ``forged``, ``replayed``."""
    silent_s: float = 0.0
    """Time since the vehicle was last heard."""
    reconnects: int = 0
    first_s: float = math.nan
    """Host time of the first record that the link's process heard, seconds since 1970."""
    newest_s: float = math.nan
    """Host time of the newest record, seconds since 1970. NaN before the first record arrives."""
    bank_rad: float = math.nan
    """Bank of the vehicle by its newest ATTITUDE, rad. NaN before the first."""
    airspeed_m_s: float = math.nan
    """Air speed of the vehicle by its newest VFR_HUD, m/s. NaN before the first."""
    unanswered_s: float = 0.0
    """Time for which the process of the link has not answered its reader, s."""
    recording: Path | None = None
    recorded_bytes: int = 0
    recording_problem: str | None = None
    """Reason for which the disk accepts nothing at this moment."""

    @property
    def lost_percent(self) -> float:
        """Share of the vehicle's frames that never came."""
        sent = self.vehicle_messages + self.lost
        return 100.0 * self.lost / sent if sent else 0.0

    @property
    def repeated_percent(self) -> float:
        """Share of the vehicle's frames that came twice."""
        return 100.0 * self.repeated / self.vehicle_messages if self.vehicle_messages else 0.0


class LinkCounters:
    """Counts behind ``LinkStatistics``. Times are the monotonic seconds of the reader."""

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
        """Return frames per second over the last ``RATE_WINDOW_S``."""
        return sum(n for t, n in tuple(self._recent) if t >= now_s - RATE_WINDOW_S) / RATE_WINDOW_S


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
