"""The noise of the flight, known: residuals and sensitivities pass through one filter before any fit.

With moving air or coloured instruments, neighbouring residuals are alike and least squares believes
them too much. The Kalman filter of ``advisor.oem.innovations`` turns both into innovations, which are not;
from there on everything (fit, screening, hold-out, errors) is ordinary least squares again.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.records.flights import Flights
from advisor.gap.simulator.layout import INDEX, SPEED, short_period
from advisor.oem.innovations import ALPHA, AirModel, Gains, gains_of


class Whitening(Protocol):
    """What turns residuals and sensitivities of a flight into innovations."""

    def innovations(self, i: int, columns: FloatArray) -> FloatArray:
        """Columns of manoeuvre ``i``, shape (rows, k) in stacked order, whitened, in the same order."""


@dataclass(frozen=True)
class Weighting:
    """White noise that is not alike in every sample: each row counts by what its stamp is worth."""

    weights: tuple[FloatArray, ...]
    """Per manoeuvre, shape (rows,): 1 for a sample with the channel's noise alone."""

    def innovations(self, i: int, columns: FloatArray) -> FloatArray:
        """Columns, each row with its weight."""
        return columns * self.weights[i][:, None]


@dataclass(frozen=True)
class Filters:
    """Moving air or coloured instruments: a Kalman filter for every manoeuvre."""

    airs: tuple[AirModel, ...]
    gains: tuple[Gains, ...]
    order: tuple[np.ndarray, ...]
    """Per manoeuvre: rows of the stacked channels in order of time."""

    @property
    def is_sound(self) -> bool:
        """False for an aircraft so unstable that rounding outgrows all noise within a manoeuvre."""
        return all(np.all(np.isfinite(g.root)) and np.all(np.isfinite(g.gain)) for g in self.gains)

    def innovations(self, i: int, columns: FloatArray) -> FloatArray:
        """Columns passed through the filter, in units of each innovation's standard deviation."""
        return self.gains[i].innovations(columns, self.order[i])


def filters_for(
    flights: Flights,
    p: FloatArray,
    airs: Sequence[AirModel],
    extra: Sequence[FloatArray],
) -> Filters:
    """Make the filters ready.

    Parameters
    ----------
    p
        Shape (manoeuvres, entries), as in ``gap.simulator.layout``: how the aircraft answers the air, and
        where its instruments sit.
    airs
        Per manoeuvre: its air and its instruments.
    extra
        Per manoeuvre, shape (rows,) in stacked order: variance beyond the channels' noise.
    """
    gains, orders = [], []
    for i, flight in enumerate(flights.flights):
        t, channel, order = rows_in_time(flights, i, p[i])
        system = np.array([*short_period(p[i]), float(np.mean(flight.slow[SPEED]))])
        arms = (float(p[i, INDEX["vane_arm_m"]]), float(p[i, INDEX["imu_arm_m"]]))
        # Every manoeuvre has initial states of its own in the fit: none are left to the filter.
        gains.append(gains_of(t, channel, system, airs[i], 0.0, extra[i][order], arms))
        orders.append(order)
    return Filters(tuple(airs), tuple(gains), tuple(orders))


def rows_in_time(flights: Flights, i: int, p: FloatArray) -> tuple[FloatArray, np.ndarray, np.ndarray]:
    """Times and channels (indices into ``OUTPUTS``) of one manoeuvre in order of time, and that order.

    A vane that is late by ``p``, shape (entries,), saw the air before its stamp: it is put in order by that.
    """
    flight = flights.flights[i]
    late_s = 0.0 if flights.alpha_is_derived else float(p[INDEX["alpha_skew_s"]] + p[INDEX["alpha_lag_s"]])
    t = flight.stamps - late_s * (flight.output == ALPHA)
    order = np.argsort(t, kind="stable")
    return t[order], flight.output[order], order
