"""The running estimate of the manoeuvre being flown, and the moment at which further response adds
nothing."""

from collections import deque
from dataclasses import dataclass

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import Estimate
from advisor.oem.following import Follower

REFRESH_S = 0.2
"""Vehicle time between two estimates, s. Eyes follow no faster."""
SPAN_S = 0.5
"""Further response over which the standard deviations are compared, s."""
GAIN = 0.01
"""Least relative improvement of any standard deviation over ``SPAN_S`` that is worth waiting for."""


@dataclass(frozen=True, slots=True)
class Settled:
    """State of the running manoeuvre's estimate."""

    estimate: Estimate
    enough: str | None


class Settling:
    """Estimates again while the manoeuvre being flown grows."""

    def __init__(self, aircraft: Aircraft) -> None:
        self._follower = Follower(aircraft)
        self._number: int | None = None
        self._newest_s = -np.inf
        self._stds: deque[tuple[float, np.ndarray]] = deque()
        self._settled: Settled | None = None

    def follow(self, flying: Maneuver | None) -> Settled | None:
        """Return the estimate from the data so far; None without one."""
        if flying is None:
            self._number, self._settled = None, None
            return None
        if flying.number != self._number:
            self._number, self._newest_s, self._settled = flying.number, -np.inf, None
            self._stds.clear()
        newest_s = flying.span.end_s
        if newest_s < self._newest_s + REFRESH_S:
            return self._settled
        self._newest_s = newest_s
        estimated = self._follower.refresh(flying)
        if isinstance(estimated, Estimate):
            self._stds.append((newest_s, estimated.std_cr))
            self._settled = Settled(estimated, self._enough(newest_s))
        return self._settled

    def _enough(self, newest_s: float) -> str | None:
        while len(self._stds) > 1 and self._stds[1][0] <= newest_s - SPAN_S:
            self._stds.popleft()
        since_s, before = self._stds[0]
        if newest_s - since_s < 0.9 * SPAN_S:
            return None
        gain = float(np.max(1.0 - self._stds[-1][1] / before))
        return "enough: recover; more free response adds nothing" if gain < GAIN else None
