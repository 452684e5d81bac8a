"""What the accelerations along the path show: the work of an engine, and whether anyone asked for it."""

from collections.abc import Sequence

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.records.flights import Flight, Flights
from advisor.gap.records.prepare import smooth
from advisor.gap.simulator.layout import SPEED, THROTTLE, THRUST
from advisor.gravity import GRAVITY_M_S2
from advisor.oem.recursion import accumulated

_ENGINES_S = (0.4, 1.5)
"""Lags of engines; those between are nearly mixtures of the two."""
_SMOOTHED_S = 1.0
"""Thrust does not swing faster, accelerometers do."""


def work(flights: Flights) -> float | None:
    """How much work beyond drag's would make the speed swing within a manoeuvre, relative to the mean speed.

    What the accelerations show along the path is freed of what goes with V² and with lift squared over V²
    (the two parts of a parabolic polar) in all manoeuvres alike, and integrated. None where they were not
    measured.
    """
    if not felt_along(flights):
        return None
    constant = [np.ones((flight.n, 1)) for flight in flights.flights]
    beyond = _beyond(flights, [np.hstack(pair) for pair in zip(constant, _drag(flights), strict=True)])
    gained = [np.std(np.cumsum(b) * flight.h) for b, flight in zip(beyond, flights.flights, strict=True)]
    return float(np.mean(gained)) / mean_speed(flights)


def unasked(flights: Flights) -> tuple[float, float] | None:
    """Thrust that swings though the throttle does not: m/s², and the speed it makes relative to the mean.

    Medians over the manoeuvres of standard deviations within them. What the accelerations show along the path
    is freed of a constant in each manoeuvre, of drag, of an instrument that leans, and of what follows the
    throttle, at once or late. None where they were not measured.
    """
    if not felt_along(flights):
        return None
    columns = []
    for number, (flight, drag) in enumerate(zip(flights.flights, _drag(flights), strict=True)):
        own = np.zeros((flight.n, len(flights)))
        own[:, number] = 1.0
        columns.append(np.column_stack([own, drag, _lift(flight), *_throttle(flight)]))
    beyond = _beyond(flights, columns)
    swings_by, gained = [], []
    for flight, rest in zip(flights.flights, beyond, strict=True):
        swings_by.append(np.std(smooth(rest, _SMOOTHED_S)))
        gained.append(np.std(np.cumsum(rest) * flight.h))
    return float(np.median(swings_by)), float(np.median(gained)) / mean_speed(flights)


def felt_along(flights: Flights) -> bool:
    """Whether accelerations along the path were measured."""
    return "a_x" in flights.has and {"alpha", "a_z"} <= set(flights.channels)


def mean_speed(flights: Flights) -> float:
    """Over all manoeuvres, m/s."""
    return float(np.mean([np.mean(flight.slow[SPEED]) for flight in flights.flights]))


def _lift(flight: Flight) -> FloatArray:
    """Shape (n,): specific force across the path, as it was measured, m/s²."""
    a_z = flight.outputs["a_z"]
    return np.asarray(np.interp((np.arange(flight.n) + 0.5) * flight.h, a_z.t, a_z.y))


def _throttle(flight: Flight) -> list[FloatArray]:
    """Each of shape (n,): the throttle, and what engines make of it that follow late."""
    asked = flight.slow[THROTTLE]
    keeps = [float(np.exp(-flight.h / lag_s)) for lag_s in _ENGINES_S]
    return [asked, *(asked[0] + (1.0 - k) * accumulated(asked - asked[0], k) for k in keeps)]


def _drag(flights: Flights) -> list[FloatArray]:
    """Per manoeuvre, shape (n, 2): what the two parts of a parabolic polar go with."""
    return [np.column_stack([f.slow[SPEED] ** 2, (_lift(f) / f.slow[SPEED]) ** 2]) for f in flights.flights]


def _beyond(flights: Flights, columns: Sequence[FloatArray]) -> list[FloatArray]:
    """Per manoeuvre, shape (n,): the acceleration along the path that the columns do not explain, m/s²."""
    along = [GRAVITY_M_S2 * flight.slow[THRUST] for flight in flights.flights]
    X = np.vstack(columns)
    scale = np.maximum(np.max(np.abs(X), axis=0), 1e-12)
    parts = np.linalg.lstsq(X / scale, np.concatenate(along), rcond=1e-9)[0] / scale
    return [felt - taken @ parts for felt, taken in zip(along, columns, strict=True)]
