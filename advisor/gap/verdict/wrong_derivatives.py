"""The aircraft file's own derivatives: their part of the gap, and whether they are wrong."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.evidence.found import Evidence
from advisor.gap.fitting.measure import whole_gap
from advisor.gap.fitting.prior import Distance
from advisor.gap.fitting.uncertainty import distance_from_file
from advisor.gap.result import VISIBLE
from advisor.gap.search.acceptance import JudgedAddition

_BY_NAMES = 0.8
"""Least share of the gap that named effects must explain with the file's own derivatives, for these to be
right."""


@dataclass(frozen=True)
class WrongDerivatives:
    """The part of the gap that comes from the file's derivatives."""

    gap: float
    """Mean square beyond that of fitted derivatives, relative to the floor's square."""
    distance: Distance
    """Distance of the file's derivatives from the fitted ones."""
    are_wrong: bool
    are_imitated: bool
    """Whether the named effects explain the gap with the file's derivatives. Other derivatives then only
    imitate them."""
    outweigh_the_air: bool
    """Whether the part of wrong derivatives exceeds that of moving air, which comes and goes with the day."""


def wrong_derivatives(e: Evidence, named: Sequence[JudgedAddition], still: FloatArray) -> WrongDerivatives:
    """Judge the file's derivatives; ``still`` is the noise floor without moving air, shape (channels,)."""
    gap, beside_air = _beyond_fitted(e, e.floor), _beyond_fitted(e, still)
    of_the_air = whole_gap(e.stages[0].held_out.mean_square, still) if e.air is not None else 0.0
    distance = distance_from_file(e.problem, e.stages[-1].fitted)
    are_wrong = gap > VISIBLE and distance.is_off
    told_by_file = any(judged.variant.twin is not None and judged.prior_gain > 0.0 for judged in named)
    return WrongDerivatives(
        gap, distance, are_wrong, told_by_file or _explain_with_the_file(e), beside_air > of_the_air
    )


def _beyond_fitted(e: Evidence, floor: FloatArray) -> float:
    """Return the mean square of the file's derivatives beyond fitted ones, relative to the floor's square."""
    if e.file_model is None:
        return 0.0
    return float(np.mean((e.file_model.mean_square - e.stages[0].held_out.mean_square) / floor**2))


def _explain_with_the_file(e: Evidence) -> bool:
    """Return whether the named effects explain the gap with the file's own derivatives.

    One effect is likelier than six wrong derivatives that happen to imitate it.
    """
    if e.file_model is None or e.file_model_with_effects is None:
        return False
    was, named, final = (
        whole_gap(h.mean_square, e.floor)
        for h in (e.file_model, e.file_model_with_effects, e.stages[-1].held_out)
    )
    return was - named > _BY_NAMES * (was - final)
