"""Examination of the instruments before the first manoeuvre, from any motion of the aircraft."""

from collections.abc import Callable

import numpy as np

from advisor.flight.instruments.axes.side_instruments import examine_side
from advisor.flight.instruments.examination import examine
from advisor.flight.instruments.examined import ExaminedRecords
from advisor.flight.signals.record import UNITS, Channel

_EVERY_S = 10.0
"""Length of an examined stretch, s: one to two periods of a slow short period."""
_LATE_S = 1.0
"""Length of the newest flight that an examination leaves out, s, because packets may still arrive."""
_ENOUGH = 6
"""Number of stretches with motion after which the watch ends. Errors are then well below the scatter between
instruments."""


class InstrumentWatch:
    """Examination of the instruments, one stretch of the flight after another.

    The stretches end at fixed vehicle times, so that the batches of a log change no result.

    Parameters
    ----------
    cut
        Function that returns a stretch of a channel by name, start and end, s.
    """

    def __init__(self, cut: Callable[[str, float, float], Channel | None]) -> None:
        self._cut = cut
        self.begin()

    def begin(self) -> None:
        """Begin another power-on, or follow another vehicle."""
        self.pitch, self.sideways = ExaminedRecords(examine), ExaminedRecords(examine_side)
        """All stretches so far. No finding is marked as used, because these records give no estimate."""
        self._at_s = -np.inf
        self._moving = 0

    def advance(self, first_s: float, now_s: float) -> None:
        """Make every due examination; vehicle times of the first and the newest message, s."""
        while self._moving < _ENOUGH and now_s - _LATE_S >= max(self._at_s, first_s) + _EVERY_S:
            rate = self._cut("q", max(self._at_s, first_s), now_s - _LATE_S)
            if rate is None:
                return
            end_s = _EVERY_S * (np.floor(rate.t[0] / _EVERY_S) + 1.0)
            if end_s > now_s - _LATE_S:
                return
            self._examine(end_s - _EVERY_S, end_s)
            self._at_s = end_s

    def finish(self, first_s: float, now_s: float) -> None:
        """Examine the last stretch at the end of the stream."""
        self.advance(first_s, now_s)
        if np.isfinite(first_s) and self._moving < _ENOUGH:
            self._examine(max(self._at_s, first_s), now_s)

    def _examine(self, start_s: float, end_s: float) -> None:
        cuts = {name: self._cut(name, start_s, end_s) for name in UNITS}
        channels = {name: c for name, c in cuts.items() if c is not None}
        for stretches in (self.pitch, self.sideways):
            examined = stretches.examined(channels)
            self._moving += "theta_scale" in examined.evidence
            if examined.evidence:
                stretches.count(examined.evidence, examined.findings)
