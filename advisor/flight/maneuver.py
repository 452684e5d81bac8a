"""A manoeuvre: the stretch of flight that one estimate is made from."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

from advisor.flight.record import Channel
from advisor.flight.trust import Distrust

InputKind = Literal["3-2-1-1", "reverse 3-2-1-1", "doublet", "pulse", "multisine", "other"]


@dataclass(frozen=True, slots=True)
class Span:
    """Where a manoeuvre lies in the stream of elevator samples, as the segmenter found it."""

    record_from_s: float
    """First stamp of the record: the lead-in before the first step, used by the fit."""
    start_s: float
    """Onset of the first elevator step."""
    last_step_s: float
    """Onset of the last elevator step (the return to trim)."""
    end_s: float
    """End of the free response; last stamp of the record."""
    kind: InputKind
    steps: tuple[tuple[float, float], ...]
    """The input as told apart: (onset s, level in rad from trim), one a step."""
    closed_by: str
    """Why it ended: ``quiet``, ``mode change``, ``next input``, ``gap``, ``end of log``, ``no rest``;
    or who marked it: ``marked by hand``, ``marked by a switch``, ``marked by a text of the vehicle``."""


@dataclass(frozen=True, slots=True)
class Maneuver:
    """A span with its data. ``channels`` holds at least ``elevator``; every channel at its own stamps."""

    number: int
    boot: int
    """Which power-on of the vehicle, 0 for the first in the log or link."""
    span: Span
    channels: Mapping[str, Channel]
    mode: str = ""
    """Flight mode in which it was flown, as the autopilot names or numbers it."""
    distrusts: tuple[Distrust, ...] = ()
    """Channels that cannot be right. A specific force that stands still is not in ``channels``."""
    flight: int = 0
    """Which log or link of the campaign the record is of, 0 for the first."""

    @property
    def power_on(self) -> tuple[int, int]:
        """Flight and power-on in which the manoeuvre was recorded."""
        return self.flight, self.boot

    def later(self, by_s: float) -> "Maneuver":
        """Return the same on a clock that shows ``by_s`` more."""
        span = replace(
            self.span,
            record_from_s=self.span.record_from_s + by_s,
            start_s=self.span.start_s + by_s,
            last_step_s=self.span.last_step_s + by_s,
            end_s=self.span.end_s + by_s,
            steps=tuple((onset + by_s, level) for onset, level in self.span.steps),
        )
        channels = {name: replace(c, t=c.t + by_s) for name, c in self.channels.items()}
        return replace(self, span=span, channels=channels)
