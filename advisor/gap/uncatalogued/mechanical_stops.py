"""What goes no further than to a stop, wherever it was trimmed: a surface, or a vane."""

from collections.abc import Sequence
from functools import partial

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.candidates.variant import Values, Variant
from advisor.gap.records.flights import Flights
from advisor.gap.simulator.layout import INDEX

SURFACE_STOP, VANE_STOP = "surface_stop", "vane_stop"
_TRIMMED_RAD = 0.002
"""Nearest to its trim that anything may be stopped."""


def surface_stops(flights: Flights) -> list[Variant]:
    """An elevator that moves no further than to a stop, up, down or both."""
    trims = np.array([flight.u_trim for flight in flights.flights])
    flown = np.concatenate([flight.u for flight in flights.flights])
    return _stops(SURFACE_STOP, "input", ("stop_up_rad", "stop_down_rad"), trims, flown)


def vane_stops(flights: Flights) -> list[Variant]:
    """A vane that turns no further than to a stop, up, down or both."""
    trims = np.array([flight.alpha_trim for flight in flights.flights])
    flown = np.concatenate([flight.outputs["alpha"].y for flight in flights.flights])
    return _stops(VANE_STOP, "alpha_sensor", ("vane_stop_up_rad", "vane_stop_down_rad"), trims, flown)


def _stops(
    effect: str, block: str, entries: tuple[str, str], trims: FloatArray, flown: FloatArray
) -> list[Variant]:
    """Stops at the same angles in all manoeuvres, told from the middle of their trims.

    ``trims`` has shape (manoeuvres,), ``flown`` is all that was commanded or read, in rad.
    """
    middle = float(np.median(trims))
    furthest = float(np.max(flown)) - middle, middle - float(np.min(flown))
    up, down = zip(entries, (1.0, -1.0), furthest, strict=True)

    def stopped(ways: Sequence[tuple[str, float, float]], p: FloatArray, values: Values, _: Flights) -> None:
        for (entry, sign, _furthest), value in zip(ways, values, strict=True):
            p[:, INDEX[entry]] = np.maximum(value + sign * (middle - trims), _TRIMMED_RAD)

    variants = []
    for ways in ((up, down), (up,), (down,)):
        most = [way[2] for way in ways]
        if min(most) <= _TRIMMED_RAD:
            continue
        variants.append(
            Variant(
                effect, block, tuple(way[0] for way in ways),
                tuple(tuple(x * m for m in most) for x in (0.5, 0.8)),
                (1e-3,) * len(ways), tuple((_TRIMMED_RAD, 1.5 * m) for m in most), 0.0,
                apply_with=partial(stopped, ways),
            )
        )  # fmt: skip
    return variants
