"""A manoeuvre that is refused only for its cost, although it is larger than earlier manoeuvres and they
predicted it.

The cost J = det R does not account for the size of the motion. The unexplained part of a response grows with
the motion. In two channels the cost doubles if each residual variance grows by 1.41, that is for a motion
1.19 times as large. Eqs. (10) and (11) then refuse a manoeuvre with more information than the earlier ones.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median

import numpy as np

from advisor.decision.course import CriterionCourse
from advisor.decision.history import CandidateManeuver, usable_ones
from advisor.oem.estimate import Estimate


@dataclass(frozen=True, slots=True)
class Larger:
    """Size of a refused manoeuvre relative to the manoeuvre that set its limit."""

    ratio: float
    """Ratio of the pitch rate ranges of both manoeuvres."""
    setter: int | None
    """Number of the manoeuvre that set the cost limit. None if a median set the limit."""


def larger_and_agreeing(
    history: Sequence[CandidateManeuver], accepted: Sequence[bool], course: CriterionCourse
) -> Larger | None:
    """Return the newest manoeuvre's relative size, if it is larger than the manoeuvre that set the limit, and
    was predicted.

    Parameters
    ----------
    history
        Manoeuvres up to the newest one, which the paper's rule ``course.plan.rule`` refused.
    accepted
        Whether the paper's rule accepts each manoeuvre.

    Returns
    -------
    Larger or None
        None if the manoeuvre is not larger at the printed precision, or contradicts the earlier ones.
    """
    before, newest = history[:-1], history[-1]
    setters = [i for i, flown in enumerate(before) if flown.usable]
    if course.plan.rule == "continuous":
        setters = [i for i in setters if accepted[i]][-1:]
    if not newest.usable:
        return None
    reference = median(_range(history[i]) for i in setters)
    ratio = _range(newest) / reference if reference > 0.0 else 1.0
    if round(ratio, 1) <= 1.0 or not course.standing(usable_ones(history)).predicted:
        return None
    return Larger(ratio, setters[0] + 1 if len(setters) == 1 else None)


def _range(flown: CandidateManeuver) -> float:
    """Return the range of the fitted pitch rate, rad/s."""
    assert isinstance(flown.estimate, Estimate)
    return float(np.ptp(flown.estimate.fits[0]["q"].fitted))
