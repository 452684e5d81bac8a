"""What the accelerations along the path show: the work of an engine, and whether anyone asked for it."""

from collections.abc import Sequence

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.records.flights import Flight, Flights
from advisor.gap.records.grid import smooth
from advisor.gap.simulator.layout import HEIGHT, SPEED, THROTTLE, THRUST
from advisor.oem.recursion import accumulated
from advisor.standard_gravity import GRAVITY_M_S2

_ENGINES_S = (0.4, 1.5)
"""Lags of engines; those between are nearly mixtures of the two."""
_SMOOTHED_S = 1.0
"""Thrust does not swing faster, accelerometers do."""


def energy_swing(flights: Flights) -> float | None:
    """How much work beyond drag's would make the speed swing within a manoeuvre, relative to the mean speed.

    What the accelerations show along the path is freed of a constant and of drag in all manoeuvres alike, and
    integrated. None where they were not measured.
    """
    if not measures_path_acceleration(flights):
        return None
    everywhere = [slice(0, flight.n) for flight in flights.flights]
    beyond = _beyond_drag(flights, [np.ones((flight.n, 1)) for flight in flights.flights], everywhere)
    gained = [np.std(np.cumsum(b) * flight.h) for b, flight in zip(beyond, flights.flights, strict=True)]
    return float(np.mean(gained)) / mean_speed(flights)


def uncommanded_thrust(flights: Flights) -> float | None:
    """Thrust that swings though the throttle does not, m/s²: median of standard deviations in a manoeuvre.

    What the accelerations show along the path while it is flown (a pilot sets the speed before and after) is
    freed of a constant in each manoeuvre, of drag, of an instrument that leans, and of what follows the
    throttle, at once or late. It counts for the share of the energy's swing that it accounts for: air speed
    and height were measured by other instruments, and know nothing of an accelerometer's noise. None where
    accelerations or height were not measured.
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


def _while_flown(flight: Flight) -> slice:
    """From the first step on, without the last second; all of it where next to nothing would be left."""
    first = max(int(flight.first_step_s / flight.h), 0)
    last = flight.n - int(_SMOOTHED_S / flight.h)
    return slice(first, last) if last - first > int(2.0 * _SMOOTHED_S / flight.h) else slice(0, flight.n)


def energy_speed(flight: Flight) -> FloatArray:
    """√(V² + 2 g h), shape (n,), m/s, heights from the manoeuvre's mean: the speed without climbs."""
    climbed = flight.slow[HEIGHT] - np.mean(flight.slow[HEIGHT])
    return np.asarray(np.sqrt(np.maximum(flight.slow[SPEED] ** 2 + 2.0 * GRAVITY_M_S2 * climbed, 0.0)))


def _swing(course: FloatArray) -> FloatArray:
    """What is left of a course without its mean and its steady change."""
    t = np.linspace(-1.0, 1.0, len(course))
    return np.asarray(course - np.polynomial.Polynomial.fit(t, course, 1)(t))


def measures_path_acceleration(flights: Flights) -> bool:
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
    commanded = flight.slow[THROTTLE]
    keeps = [float(np.exp(-flight.h / lag_s)) for lag_s in _ENGINES_S]
    return [commanded, *(commanded[0] + (1.0 - k) * accumulated(commanded - commanded[0], k) for k in keeps)]


def _drag(flight: Flight) -> FloatArray:
    """Shape (n, 2): V² and (lift / V)², what the parts of a parabolic polar go with."""
    return np.column_stack([flight.slow[SPEED] ** 2, (_lift(flight) / flight.slow[SPEED]) ** 2])


def _beyond_drag(
    flights: Flights, columns: Sequence[FloatArray], stretches: Sequence[slice]
) -> list[FloatArray]:
    """Per manoeuvre, in its stretch: acceleration along the path that neither drag nor columns explain, m/s².

    Drag and a propeller's loss of thrust with speed hold an aircraft back. A thrust that swings slowly moves
    the speed with it and would pass for the contrary: a part of the polar that pushes is left out.
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
