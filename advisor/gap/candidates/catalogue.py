"""All variants of the effects that the recorded channels allow."""

import numpy as np

from advisor.gap.candidates import force, input, moment, sensors, timing
from advisor.gap.candidates.traits import TRAITS
from advisor.gap.candidates.variant import Variant
from advisor.gap.records.flights import SPEED_CHANGE, PreparedManeuvers
from advisor.gap.simulator.layout import HEIGHT, THROTTLE

_LEAST_S = 0.004
_FILTERED_S = 0.02
"""Least delay that is named, s: of a raw sensor (4 ms), and of a channel that an autopilot filtered (20
ms)."""
_THROTTLE_MOVES, _HEIGHT_MOVES_M = 0.02, 0.2
"""Least change within a manoeuvre that makes the channel informative: of the throttle as a share of its
range, and of the height in m."""
_TWO_POWERS = 0.1
"""Relative change of the air speed above which moments and lift can have separate powers of the speed."""


def variants_for(flights: PreparedManeuvers) -> list[Variant]:
    """Return all variants whose channels were recorded and whose input varied."""
    # An autopilot's own estimates have passed its filters, and the delay of a filter is no fault.
    least_s = _FILTERED_S if flights.alpha_is_derived else _LEAST_S
    instruments = sensors.variants(least_s, flights)
    within = [*input.variants(flights), *instruments, *timing.variants(flights, least_s)]
    between = [*moment.variants(flights), *force.variants(flights)]
    return [v for v in (*within, *between) if _possible(v, flights)]


def _possible(v: Variant, flights: PreparedManeuvers) -> bool:
    if not v.needs <= flights.has or not {TRAITS[v.effect].channel} <= {"", *flights.channels}:
        return False
    if v.effect == "thrust_moment":
        return any(float(np.ptp(f.slow[THROTTLE])) > _THROTTLE_MOVES for f in flights.flights)
    if v.effect == "airspeed_variation":
        return flights.speed_moves >= (_TWO_POWERS if len(v.names) > 1 else SPEED_CHANGE)
    if v.effect == "ground_effect":
        return any(float(np.ptp(f.slow[HEIGHT])) > _HEIGHT_MOVES_M for f in flights.flights)
    return True
