"""A constant offset of the angle of attack, which the climb of the flight path alone shows.

Trims absorb an offset in every model, so that only the answer "nothing" excludes an offset.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from advisor.flight.instruments.kinematics import KinematicCheck
from advisor.flight.instruments.measured import AlphaOffset
from advisor.gap.decision import SIGMAS
from advisor.gap.inference.explanation import Explanation, Row
from advisor.gap.inference.posterior import NONE, relabelled, stated_as
from advisor.gap.inference.prior import FieldPrior
from advisor.gap.result import Cause, Value

E = TypeVar("E", bound=Explanation)
OFFSET = stated_as("alpha_bias")
_SET_WITHIN_RAD = {True: 0.009, False: 0.0035}
"""Prior: standard deviation of α's offset without a fault, rad, for an autopilot's estimate and for a vane.
ArduPlane's estimate is off by 0.2 to 0.5 degrees; a vane's zero is set to 0.2 degrees."""
_OFF_BY_RAD = 0.03
"""Prior: standard deviation of a faulty α offset, rad."""


def is_removed(offset: AlphaOffset) -> bool:
    """Return whether an offset is subtracted before the fit. The trim would carry it into the lift."""
    return offset.stays and abs(offset.rad) > SIGMAS * offset.std_rad


def with_offset(
    rows: Sequence[Row[E]], offset: AlphaOffset, is_computed: bool, prior: FieldPrior, names: int
) -> list[Row[E]]:
    """Return the rows with a constant offset of α as one more explanation.

    Parameters
    ----------
    is_computed
        Whether an autopilot computes the angle; else a vane measures it.
    names
        Number of candidate effects.
    """
    if not offset.stays or not np.isfinite(offset.rad):
        return list(rows)
    natural = np.hypot(_SET_WITHIN_RAD[is_computed], offset.std_rad)
    faulty = np.hypot(_OFF_BY_RAD, offset.std_rad)
    gain = 0.5 * offset.rad**2 * (natural**-2 - faulty**-2) - float(np.log(faulty / natural))
    gain += float(np.log(prior.effect / max(names, 1) / prior.none))
    none = [row for row in rows if row.alternative == NONE]
    others = (_gaining(row, max(0.0, gain)) for row in rows if row.alternative != NONE)
    faults = (relabelled(_gaining(row, gain), OFFSET) for row in none)
    return [*none, *others, *faults]


def _gaining(row: Row[E], nats: float) -> Row[E]:
    return replace(row, terms={**row.terms, "offset": nats})


def cause_of_offset(kinematics: KinematicCheck, probability: float, gap_after: float, present: bool) -> Cause:
    """Return the offset as a cause, with its size from the motion."""
    offset = kinematics.offset
    return Cause(
        OFFSET.name, OFFSET.block, probability, {"bias_rad": Value(offset.rad, offset.std_rad)},
        ("an offset of the attitude's zero", "steady up- or downwash"),
        "level the attitude reference on the ground; fly in still air", gap_after, present,
    )  # fmt: skip
