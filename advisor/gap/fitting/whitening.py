"""Whitening: a filter of the flight's noise that residuals and sensitivities pass before any fit.

Moving air and coloured instruments correlate successive residuals, so least squares overweights them. The
Kalman filter of ``advisor.oem.driven_motion`` turns residuals and sensitivities into white innovations. After
the filter, fit, screening and hold-out are ordinary least squares.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import INDEX, SPEED, short_period
from advisor.oem.driven_motion.kalman_filter import Gains, driven_filter, steps_of
from advisor.oem.driven_motion.setting import Linear, Noise
from advisor.oem.short_period_motion import short_period_motion
from advisor.oem.turbulence import ALPHA
from advisor.process.arrays import FloatArray


class Whitening(Protocol):
    """A filter that turns residuals and sensitivities of a flight into innovations."""

    def innovations(self, i: int, columns: FloatArray) -> FloatArray:
        """Return whitened columns of manoeuvre ``i``, shape (rows, k), in stacked order."""


@dataclass(frozen=True)
class Weighting:
    """White noise of different size in every sample: each row is weighted by the precision of its stamp."""

    weights: tuple[FloatArray, ...]
    """Per manoeuvre, shape (rows,): weight of each row, 1 for a sample with the channel's noise alone."""

    def innovations(self, i: int, columns: FloatArray) -> FloatArray:
        """Return the columns of manoeuvre ``i`` with each row multiplied by its weight."""
        return columns * self.weights[i][:, None]


@dataclass(frozen=True)
class Filters:
    """Kalman filters for moving air or coloured instruments, one for every manoeuvre."""

    gains: tuple[Gains, ...]
    order: tuple[np.ndarray, ...]
    """Per manoeuvre: indices of the stacked rows in order of time."""

    @property
    def is_sound(self) -> bool:
        """Whether all Kalman gains are finite. On a very unstable aircraft rounding errors outgrow all noise
        within a manoeuvre."""
        return all(np.all(np.isfinite(g.std)) and np.all(np.isfinite(g.gain)) for g in self.gains)

    def innovations(self, i: int, columns: FloatArray) -> FloatArray:
        """Return the filtered columns of manoeuvre ``i``, in units of each innovation's standard
        deviation."""
        return self.gains[i].innovations(columns, self.order[i])


def filters_for(
    flights: PreparedManeuvers, p: FloatArray, noises: Sequence[Noise], extra: Sequence[FloatArray]
) -> Filters:
    """Return one Kalman filter for each manoeuvre.

    Parameters
    ----------
    p
        Shape (manoeuvres, entries), in the order of ``gap.simulator.layout.ENTRIES``: driving numbers, which
        hold the response to moving air and the positions of the instruments.
    noises
        Per manoeuvre: noise of the air and of the instruments.
    extra
        Per manoeuvre, shape (rows,) in stacked order: variance beyond the channels' noise.
    """
    gains, orders = [], []
    for i, noise in enumerate(noises):
        t, channel, order = rows_in_time(flights, i, p[i])
        motion = motion_of(flights, i, p[i])
        white = noise.white[channel] ** 2 + extra[i][order]
        # Every manoeuvre has its own initial states in the fit, so none are left to the filter.
        at = steps_of(t), channel, motion.all_seen, noise.driving(motion)
        gains.append(driven_filter(*at, white, noise.coloured, noise.memory_s))
        orders.append(order)
    return Filters(tuple(gains), tuple(orders))


def motion_of(flights: PreparedManeuvers, i: int, p: FloatArray) -> Linear:
    """Return the linear motion of one manoeuvre by its driving numbers ``p``, shape (entries,)."""
    arms = float(p[INDEX["vane_arm_m"]]), float(p[INDEX["imu_arm_m"]])
    speed = float(np.mean(flights.flights[i].slow[SPEED]))
    return short_period_motion(short_period(p), speed, arms, seen_by_alpha=not flights.alpha_is_derived)


def rows_in_time(
    flights: PreparedManeuvers, i: int, p: FloatArray
) -> tuple[FloatArray, np.ndarray, np.ndarray]:
    """Return times and channels (indices into ``OUTPUTS``) of one manoeuvre in order of time, and that order.

    ``p``, shape (entries,), may delay the vane. The rows of a delayed vane have the time of the measurement,
    which lies before the stamp.
    """
    flight = flights.flights[i]
    late_s = 0.0 if flights.alpha_is_derived else float(p[INDEX["alpha_skew_s"]] + p[INDEX["alpha_lag_s"]])
    t = flight.stamps - late_s * (flight.output == ALPHA)
    order = np.argsort(t, kind="stable")
    return t[order], flight.output[order], order
