"""Lift with hysteresis: gradual like a play, or sudden like a relay."""

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.kit.variant import Values, Variant
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import INDEX

LIFT_MEMORY, FLOW_LETS_GO = "lift_memory", "flow_lets_go"
_FORCE = "force_equation"


def lift_memory(flights: PreparedManeuvers) -> Variant:
    """Return lift with the hysteresis of a play, the elementary one of a gradual stall."""
    swing = float(np.median([np.ptp(f.outputs["alpha"].y) for f in flights.flights]))
    return Variant(
        LIFT_MEMORY, _FORCE, ("Z_memory", "half_width_rad"),
        tuple((0.0, share * swing) for share in (0.1, 0.3)), (0.05, 0.01 * swing),
        ((-20.0, 0.0), (0.01 * swing, 0.6 * swing)), 0.0,
        entries=("Z_memory", "memory_rad"), places=("half_width_rad",),
    )  # fmt: skip


def flow_lets_go(flights: PreparedManeuvers) -> Variant:
    """Return lift that is lost at one angle of attack and returns at a lower one, like a relay."""
    trims = np.array([flight.alpha_trim for flight in flights.flights])
    above = [float(np.max(f.outputs["alpha"].y)) - f.alpha_trim for f in flights.flights]
    most, middle = float(np.median(above)), float(np.median(trims))

    def let_go(p: FloatArray, values: Values, _: PreparedManeuvers) -> None:
        lost, at, band = values
        p[:, INDEX["Z_separated"]] = lost
        p[:, INDEX["separation_rad"]] = at + middle - trims
        p[:, INDEX["attachment_rad"]] = at - band + middle - trims

    starts = tuple((0.0, at * most, band * most) for at in (0.4, 0.6, 0.8) for band in (0.2, 0.4, 0.7))
    return Variant(
        FLOW_LETS_GO, _FORCE, ("Z_separated", "at_rad", "band_rad"), starts,
        (0.005, 0.05 * most, 0.05 * most), ((-1.0, 1.0), (0.0, 1.2 * most), (0.01, 1.5 * most)), 0.0,
        apply_with=let_go, places=("at_rad", "band_rad"),
    )  # fmt: skip
