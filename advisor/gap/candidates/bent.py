"""What bends with an angle: about the trim of each manoeuvre, or about one angle for all of them.

Linear models know deviations from trim only. A wing or an elevator knows its angle: where speeds differ, so
do the trims, and each manoeuvre is flown on another part of the same curve.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.candidates.variant import Values, Variant
from advisor.gap.records.flights import Flights
from advisor.gap.simulator.layout import INDEX

_APART = 0.1
"""Share of the largest deviation from trim by which trims must differ to tell the two apart."""


def bent_in_alpha(variant: Variant, slope: str, flights: Flights) -> Variant:
    """With ``variant``, a square and a cube of α, also about one angle; ``slope`` is linear in α."""
    if "alpha" not in flights.channels:
        return variant
    moved = max(float(np.max(np.abs(f.outputs["alpha"].y - f.alpha_trim))) for f in flights.flights)
    return _either_way(variant, slope, [f.alpha_trim for f in flights.flights], moved)


def bent_in_elevator(variant: Variant, slope: str, flights: Flights) -> Variant:
    """With ``variant``, a square and a cube of δe, also about one angle; ``slope`` is linear in δe."""
    moved = max(float(np.max(np.abs(f.u - f.u_trim))) for f in flights.flights)
    return _either_way(variant, slope, [f.u_trim for f in flights.flights], moved)


def _either_way(variant: Variant, slope: str, trims: Sequence[float], moved: float) -> Variant:
    """(x + D)² and (x + D)³ written out in x, D being a manoeuvre's trim less the usual one."""
    square, cube = (INDEX[entry] for entry in variant.entries)
    apart = np.array(trims) - np.median(trims)
    if np.max(np.abs(apart)) < _APART * moved:
        return variant

    def about_one_angle(p: FloatArray, values: Values, _: Flights) -> None:
        p[:, INDEX[slope]] += (2.0 * values[0] + 3.0 * values[1] * apart) * apart
        p[:, square] += values[0] + 3.0 * values[1] * apart
        p[:, cube] += values[1]

    # A cube about each trim may be far too much about one angle; the square's is of the right size.
    once = replace(variant, entries=(), apply_with=about_one_angle, carried=_square_alone)
    return replace(variant, likewise=(once,))


def _square_alone(values: FloatArray) -> Values:
    return (float(values[0]), 0.0)
