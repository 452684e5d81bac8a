"""Accelerations along the flight path: the work of an engine, and whether the throttle commanded it."""

from collections.abc import Sequence

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.signals.messages import FloatArray
from advisor.gap.records.flights import PreparedManeuver, PreparedManeuvers
from advisor.gap.records.grid import smooth
from advisor.gap.simulator.layout import HEIGHT, SPEED, THROTTLE, THRUST
from advisor.oem.recursion import accumulated

_ENGINES_S = (0.4, 1.5)
"""Prior: lags of engines in s; engines with a lag between them are nearly mixtures of the two."""
_SMOOTHED_S = 1.0
"""Numerical: length in s of the average over accelerations. Thrust does not vary faster; noise of
accelerometers does."""


def uncommanded_thrust(flights: PreparedManeuvers) -> float | None:
    """Return the varying thrust without throttle, m/s²: the median of its standard deviations in a manoeuvre.

    A pilot sets the speed before and after a manoeuvre, so only the part in between counts. A constant, drag,
    a tilted instrument and the response to the throttle, at once or late, are removed. The result is weighted
    by the share of the energy's variation that it explains, because air speed and height come from other
    instruments. None where accelerations or height were not measured.
    """
    if not measures_path_acceleration(flights) or "height" not in flights.has:
        return None
    columns = []
    for number, flight in enumerate(flights.flights):
        own = np.zeros((flight.n, len(flights)))
        own[:, number] = 1.0
        columns.append(np.column_stack([own, _lift(flight), *_throttle(flight)]))
    stretches = [_while_flown(flight) for flight in flights.flights]
    swings_by, explained, swung = [], 0.0, 0.0
    for flight, flown, rest in zip(
        flights.flights, stretches, _beyond_drag(flights, columns, stretches), strict=True
    ):
        swings_by.append(np.std(smooth(rest, _SMOOTHED_S)))
        gained, energy = _swing(np.cumsum(rest) * flight.h), _swing(energy_speed(flight)[flown])
        explained += float(gained @ energy)
        swung += float(energy @ energy)
    return float(np.median(swings_by)) * explained / max(swung, 1e-300)


def _while_flown(flight: PreparedManeuver) -> slice:
    """Return the part from the first step to a second before the end; all of it where too little would
    remain."""
    first = max(int(flight.first_step_s / flight.h), 0)
    last = flight.n - int(_SMOOTHED_S / flight.h)
    return slice(first, last) if last - first > int(2.0 * _SMOOTHED_S / flight.h) else slice(0, flight.n)


def energy_speed(flight: PreparedManeuver) -> FloatArray:
    """Return √(V² + 2 g h), shape (n,), m/s: the speed without climbs, with h relative to the manoeuvre's
    mean."""
    climbed = flight.slow[HEIGHT] - np.mean(flight.slow[HEIGHT])
    return np.asarray(np.sqrt(np.maximum(flight.slow[SPEED] ** 2 + 2.0 * GRAVITY_M_S2 * climbed, 0.0)))


def _swing(course: FloatArray) -> FloatArray:
    """Return a course without its mean and its linear trend."""
    t = np.linspace(-1.0, 1.0, len(course))
    return np.asarray(course - np.polynomial.Polynomial.fit(t, course, 1)(t))


def measures_path_acceleration(flights: PreparedManeuvers) -> bool:
    """Return whether accelerations along the path were measured."""
    return "a_x" in flights.has and {"alpha", "a_z"} <= set(flights.channels)


def mean_speed(flights: PreparedManeuvers) -> float:
    """Return the mean air speed over all manoeuvres, m/s."""
    return float(np.mean([np.mean(flight.slow[SPEED]) for flight in flights.flights]))


def _lift(flight: PreparedManeuver) -> FloatArray:
    """Return the measured specific force across the path, m/s², shape (n,)."""
    a_z = flight.outputs["a_z"]
    return np.asarray(np.interp((np.arange(flight.n) + 0.5) * flight.h, a_z.t, a_z.y))


def _throttle(flight: PreparedManeuver) -> list[FloatArray]:
    """Return the throttle and its lagged responses, each of shape (n,)."""
    commanded = flight.slow[THROTTLE]
    keeps = [float(np.exp(-flight.h / lag_s)) for lag_s in _ENGINES_S]
    return [commanded, *(commanded[0] + (1.0 - k) * accumulated(commanded - commanded[0], k) for k in keeps)]


def _drag(flight: PreparedManeuver) -> FloatArray:
    """Return V² and (lift/V)², the regressors of a parabolic drag polar, shape (n, 2)."""
    return np.column_stack([flight.slow[SPEED] ** 2, (_lift(flight) / flight.slow[SPEED]) ** 2])


def _beyond_drag(
    flights: PreparedManeuvers, columns: Sequence[FloatArray], stretches: Sequence[slice]
) -> list[FloatArray]:
    """Return by manoeuvre the acceleration along the path that neither drag nor ``columns`` explain, m/s².

    Drag and a propeller's loss of thrust with speed decelerate. A slowly varying thrust moves the speed with
    it and would pass for a negative drag. A part of the polar that accelerates is therefore left out.
    """
    cut = list(zip(flights.flights, columns, stretches, strict=True))
    along = np.concatenate([GRAVITY_M_S2 * flight.slow[THRUST][flown] for flight, _, flown in cut])
    drag = np.vstack([_drag(flight)[flown] for flight, _, flown in cut])
    others = np.vstack([one[flown] for _, one, flown in cut])
    while True:
        X = np.hstack([drag, others])
        scale = np.maximum(np.max(np.abs(X), axis=0), 1e-12)
        parts = np.linalg.lstsq(X / scale, along, rcond=1e-9)[0] / scale
        holds_back = parts[: drag.shape[1]] <= 0.0
        if np.all(holds_back):
            break
        drag = drag[:, holds_back]
    return np.split(along - X @ parts, np.cumsum([flown.stop - flown.start for _, _, flown in cut])[:-1])
