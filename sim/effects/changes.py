"""Changes of the aircraft in flight: mass, centre of gravity, ice, engine."""

import math
from typing import Any

from ..motion import Motion


class Onset:
    """Progress of a change: 0 before ``at_s``, rising to 1 within ``ramp_s``."""

    def __init__(self, at_s: float, ramp_s: float) -> None:
        self.at_s, self.ramp_s = at_s, ramp_s

    def share(self, time_s: float) -> float:
        """Return the share of the change at ``time_s``."""
        if self.ramp_s <= 0.0:
            return 1.0 if time_s >= self.at_s else 0.0
        return min(max((time_s - self.at_s) / self.ramp_s, 0.0), 1.0)


class FieldChange:
    """Fields of the aircraft's record that change to new values with time."""

    def __init__(self, onset: Onset, factors: dict[str, float], offsets: dict[str, float]) -> None:
        self.onset, self.factors, self.offsets = onset, factors, offsets
        self._plain: dict[str, float] | None = None

    def apply(self, time_s: float, motion: Motion, engine: Any) -> None:
        """Set the fields for ``time_s``. ``factors`` are relative changes, and ``offsets`` are absolute
        changes.
        """
        record = engine.record
        if self._plain is None:
            self._plain = {name: float(record[name][0]) for name in (*self.factors, *self.offsets)}
        share = self.onset.share(time_s)
        for name, change in self.factors.items():
            record[name] = self._plain[name] * (1.0 + share * change)
        for name, change in self.offsets.items():
            record[name] = self._plain[name] + share * change


class EngineSurge:
    """An engine whose thrust, and with it the airspeed, oscillates slowly."""

    def __init__(self, share: float, period_s: float) -> None:
        self.share, self.period_s = share, period_s
        self._plain: float | None = None

    def apply(self, time_s: float, motion: Motion, engine: Any) -> None:
        """Set the full-throttle thrust for ``time_s``."""
        if self._plain is None:
            self._plain = float(engine.record["thrust_max"][0])
        swing = math.sin(2 * math.pi * time_s / self.period_s)
        engine.record["thrust_max"] = self._plain * (1.0 + self.share * swing)
