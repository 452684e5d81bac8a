"""How a link is doing: counted frame by frame, read as one snapshot."""

from collections import Counter, deque
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from advisor.mavlink.framing import Frame

RATE_WINDOW_S = 2.0
_LATE_BY_AT_MOST = 64  # sequence numbers count to 256; a step back this far is a late packet, further a loss


@dataclass(frozen=True, slots=True)
class Notice:
    """Something a crew should know about the link."""

    at_s: float
    """Host time, seconds since 1970."""
    text: str


@dataclass(frozen=True, slots=True)
class LinkStatistics:
    """One look at a link."""

    connected: bool = False
    vehicle: tuple[int, int] | None = None
    """System and component listened to; None before the first heartbeat of an autopilot."""
    messages: int = 0
    """Frames taken from every system."""
    messages_per_s: float = 0.0
    """Over the last two seconds."""
    vehicle_messages: int = 0
    """Frames taken from the vehicle."""
    lost: int = 0
    """Frames of the vehicle that its sequence numbers say are missing."""
    duplicated: int = 0
    late: int = 0
    """Frames of the vehicle that arrived after a younger one."""
    bad_crc: int = 0
    garbage_bytes: int = 0
    refused: Mapping[str, int] = field(default_factory=dict)
    """Frames not believed, by reason: ``unsigned``, ``forged``, ``replayed``."""
    silent_s: float = 0.0
    """Time since the vehicle was last heard."""
    reconnects: int = 0
    recording: Path | None = None
    recorded_bytes: int = 0
    recording_problem: str | None = None
    """Why the disk takes nothing at this moment."""

    @property
    def lost_percent(self) -> float:
        """Share of the vehicle's frames that never came."""
        sent = self.vehicle_messages + self.lost
        return 100.0 * self.lost / sent if sent else 0.0


class SequenceCount:
    """Losses, duplicates and late frames of one sender, from its sequence numbers."""

    def __init__(self) -> None:
        self._last: int | None = None
        self._missing = 0
        self.received = 0
        self.duplicated = 0
        self.late = 0

    @property
    def lost(self) -> int:
        """Frames still missing; a late one is missing no more."""
        return max(0, self._missing)

    def add(self, sequence: int) -> None:
        """Count one received frame."""
        self.received += 1
        step = 1 if self._last is None else (sequence - self._last) & 0xFF
        if step == 0:
            self.duplicated += 1
        elif step >= 256 - _LATE_BY_AT_MOST:
            self.late += 1
            self._missing -= 1
        else:
            self._missing += step - 1
            self._last = sequence


class LinkCounters:
    """The counts behind ``LinkStatistics``; times are the monotonic seconds of the reader."""

    def __init__(self) -> None:
        self.messages = 0
        self.refused: Counter[str] = Counter()
        self._senders: dict[tuple[int, int], SequenceCount] = {}
        self._recent: deque[tuple[float, int]] = deque()

    def add(self, frames: list[Frame], now_s: float) -> None:
        """Count a batch of believed frames."""
        self.messages += len(frames)
        self._recent.append((now_s, len(frames)))
        for frame in frames:
            sender = (frame.system, frame.component)
            count = self._senders.get(sender)
            if count is None:
                count = self._senders[sender] = SequenceCount()
            count.add(frame.sequence)
        self._forget(now_s)

    def _forget(self, now_s: float) -> None:
        while self._recent and self._recent[0][0] < now_s - RATE_WINDOW_S:
            self._recent.popleft()

    def rate(self, now_s: float) -> float:
        """Frames per second over the last ``RATE_WINDOW_S``."""
        return sum(n for t, n in tuple(self._recent) if t >= now_s - RATE_WINDOW_S) / RATE_WINDOW_S

    def of(self, sender: tuple[int, int] | None) -> SequenceCount:
        """The counts of one sender; of nobody: none."""
        return self._senders.get(sender, SequenceCount()) if sender else SequenceCount()
