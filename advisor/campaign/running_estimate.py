"""Running estimate of the manoeuvre in flight. The module decides when its numbers may be shown, and when
more response adds nothing.

A fit of half an input explains the data so far with wrong values and narrow intervals. Numbers are shown only
after the input is over, the servo is known, and the estimate agrees with the manoeuvres before.
"""

from collections import deque
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS, SPEED_EXPONENTS
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import Estimate
from advisor.oem.estimator import lag_is_unknown
from advisor.oem.following import Follower
from advisor.process.arrays import FloatArray

REFRESH_S = 0.2
"""Vehicle time between two running estimates, s. Readers cannot read numbers that change faster."""
SPAN_S = 0.5
"""Additional response time over which the standard deviations are compared, s."""
GAIN = 0.01
"""Least relative improvement of any standard deviation over ``SPAN_S`` that justifies more response time."""
SHOWN = ("Z_alpha", "M_alpha", "M_q", "M_delta_e")
"""Derivatives that screens show during a manoeuvre."""
AGREES_BELOW = float(chdtri(len(SHOWN), 0.05))
"""Largest squared distance from the joint estimate, in standard deviations, that chance exceeds in 5 % of
cases."""


@dataclass(frozen=True, slots=True)
class Settled:
    """State of the running estimate of a manoeuvre."""

    estimate: Estimate
    readable: bool
    """Whether the estimate's numbers may be shown."""
    enough: str | None
    """Advice to recover, given when more free response would not improve the estimate."""


class Settling:
    """Repeats the estimate of a manoeuvre while the manoeuvre is being flown."""

    def __init__(self) -> None:
        self._follower: Follower | None = None
        self._aircraft: Aircraft | None = None
        self._number: int | None = None
        self._newest_s = -np.inf
        self._stds: deque[tuple[float, np.ndarray]] = deque()
        self._settled: Settled | None = None

    def follow(self, flying: Maneuver | None, aircraft: Aircraft, model: Estimate | None) -> Settled | None:
        """Return the estimate from the data so far; None if there is none.

        Parameters
        ----------
        aircraft
            The crew's aircraft, with the servo's lag from earlier manoeuvres.
        """
        if flying is None:
            self._number, self._settled = None, None
            return None
        if self._follower is None or aircraft is not self._aircraft:
            self._follower, self._aircraft = Follower(aircraft), aircraft
        if flying.number != self._number:
            self._number, self._newest_s, self._settled = flying.number, -np.inf, None
            self._stds.clear()
        newest_s = flying.span.end_s
        if newest_s < self._newest_s + REFRESH_S:
            return self._settled
        self._newest_s = newest_s
        estimated = self._follower.refresh(flying)
        if isinstance(estimated, Estimate):
            over = flying.span.input_is_over
            if over:
                self._stds.append((newest_s, estimated.std_cr))
            is_known = over and not lag_is_unknown(aircraft) and agrees(estimated, model)
            self._settled = Settled(estimated, is_known, self._enough(newest_s) if over else None)
        return self._settled

    def _enough(self, newest_s: float) -> str | None:
        while len(self._stds) > 1 and self._stds[1][0] <= newest_s - SPAN_S:
            self._stds.popleft()
        since_s, before = self._stds[0]
        if newest_s - since_s < 0.9 * SPAN_S:
            return None
        gain = float(np.max(1.0 - self._stds[-1][1] / before))
        return "enough: recover; more free response adds nothing" if gain < GAIN else None


def agrees(estimate: Estimate, model: Estimate | None) -> bool:
    """Return whether an estimate agrees with the joint estimate within both errors; True without a joint
    estimate.

    The distance uses the derivatives that screens show, at the joint estimate's air speed.
    """
    if model is None:
        return True
    rows = [PARAMETERS.index(name) for name in SHOWN]
    scale = np.ones(len(SHOWN))
    if model.airspeed_m_s and estimate.airspeed_m_s:
        powers = np.array([SPEED_EXPONENTS[name] for name in SHOWN])
        scale = (model.airspeed_m_s / estimate.airspeed_m_s) ** powers
    apart: FloatArray = scale * estimate.theta[rows] - model.theta[rows]
    inside = np.ix_(rows, rows)
    covariance = np.outer(scale, scale) * estimate.covariance[inside] + model.covariance[inside]
    return bool(float(apart @ np.linalg.solve(covariance, apart)) <= AGREES_BELOW)
