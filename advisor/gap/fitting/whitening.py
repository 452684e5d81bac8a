"""Whitening: a filter of the flight's noise that residuals and sensitivities pass before any fit.

Moving air and coloured instruments correlate successive residuals, so least squares overweights them. The
Kalman filter of ``advisor.oem.innovations`` turns residuals and sensitivities into white innovations. After
the filter, fit, screening and hold-out are ordinary least squares.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import INDEX, SPEED, short_period
from advisor.oem.innovations import ALPHA, AirModel, gains_of
from advisor.oem.kalman import Gains
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
        return all(np.all(np.isfinite(g.root)) and np.all(np.isfinite(g.gain)) for g in self.gains)

    def innovations(self, i: int, columns: FloatArray) -> FloatArray:
        """Return the filtered columns of manoeuvre ``i``, in units of each innovation's standard
        deviation."""
        return self.gains[i].innovations(columns, self.order[i])


def filters_for(
    flights: PreparedManeuvers, p: FloatArray, airs: Sequence[AirModel], extra: Sequence[FloatArray]
) -> Filters:
    """Return one Kalman filter for each manoeuvre.

    Parameters
    ----------
    p
        Shape (manoeuvres, entries), in the order of ``gap.simulator.layout.ENTRIES``: driving numbers, which
        hold the response to moving air and the positions of the instruments.
    airs
        Per manoeuvre: model of the air and of the instruments.
    extra
        Per manoeuvre, shape (rows,) in stacked order: variance beyond the channels' noise.
    """
    gains, orders = [], []
    for i, flight in enumerate(flights.flights):
        t, channel, order = rows_in_time(flights, i, p[i])
        system = np.array([*short_period(p[i]), float(np.mean(flight.slow[SPEED]))])
        arms = (float(p[i, INDEX["vane_arm_m"]]), float(p[i, INDEX["imu_arm_m"]]))
        # Every manoeuvre has its own initial states in the fit, so none are left to the filter.
        gains.append(gains_of(t, channel, system, airs[i], 0.0, extra[i][order], arms))
        orders.append(order)
    return Filters(tuple(gains), tuple(orders))


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
