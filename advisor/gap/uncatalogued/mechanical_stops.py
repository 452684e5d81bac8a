"""Mechanical stops of a surface or of a vane, at the same angles in all manoeuvres."""

from collections.abc import Sequence
from functools import partial

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.kit.variant import Values, Variant
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import INDEX

SURFACE_STOP, VANE_STOP = "surface_stop", "vane_stop"
_TRIMMED_RAD = 0.002
"""Numerical: least distance of a stop from trim, rad."""


def surface_stops(flights: PreparedManeuvers) -> list[Variant]:
    """Return an elevator with a stop up, down or both."""
    trims = np.array([flight.u_trim for flight in flights.flights])
    flown = np.concatenate([flight.u for flight in flights.flights])
    return _stops(SURFACE_STOP, "input", ("stop_up_rad", "stop_down_rad"), trims, flown)


def vane_stops(flights: PreparedManeuvers) -> list[Variant]:
    """Return a vane with a stop up, down or both."""
    trims = np.array([flight.alpha_trim for flight in flights.flights])
    flown = np.concatenate([flight.outputs["alpha"].y for flight in flights.flights])
    return _stops(VANE_STOP, "alpha_sensor", ("vane_stop_up_rad", "vane_stop_down_rad"), trims, flown)


def _stops(
    effect: str, block: str, entries: tuple[str, str], trims: FloatArray, flown: FloatArray
) -> list[Variant]:
    """Return stops at the same angles in all manoeuvres, given relative to the median trim.

    ``trims`` has shape (manoeuvres,); ``flown`` has all commands or readings, rad.
    """
    middle = float(np.median(trims))
    furthest = float(np.max(flown)) - middle, middle - float(np.min(flown))
    up, down = zip(entries, (1.0, -1.0), furthest, strict=True)

    def stopped(
        ways: Sequence[tuple[str, float, float]], p: FloatArray, values: Values, _: PreparedManeuvers
    ) -> None:
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
