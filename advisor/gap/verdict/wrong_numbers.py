"""What the aircraft file's own derivatives do to the gap, and whether they are wrong."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.fitting.measure import whole_gap
from advisor.gap.fitting.prior import Distance
from advisor.gap.fitting.uncertainty import CLEAR_GAP, distance_from_file
from advisor.gap.result import VISIBLE
from advisor.gap.search.acceptance import Judged
from advisor.gap.verdict.evidence import Evidence

_BY_NAMES = 0.8
"""Share of the gap that names must explain beside the file's own derivatives, if these are to be right."""
_FAR_MORE = 3.0
"""Gap of wrong numbers beside the air's from which on it is not the air that they bend to."""


@dataclass(frozen=True)
class WrongNumbers:
    """What the file's derivatives do to the gap."""

    gap: float
    """What they leave beyond fitted ones, mean square over the floor's."""
    distance: Distance
    """How far the file's derivatives are from the fitted ones."""
    are_wrong: bool
    are_imitated: bool
    """What was named leaves the file right: that other numbers explain the gap, too, is a likeness."""
    outweigh_the_air: bool
    """Moving air comes with the day, wrong numbers stay; but the larger part of the gap is the answer."""


def wrong_numbers(e: Evidence, named: Sequence[Judged], still: FloatArray) -> WrongNumbers:
    """``still`` is the floor without what the air does, shape (channels,)."""
    gap, beside_air = _beyond_fitted_numbers(e, e.floor), _beyond_fitted_numbers(e, still)
    of_the_air = whole_gap(e.stages[0].held_out.mean_square, still) if e.air is not None else 0.0
    # Fitted numbers bend to the air's motion, and take up a part of it.
    clear_gap = gap > CLEAR_GAP and beside_air > _FAR_MORE * of_the_air
    distance = distance_from_file(e.problem, e.stages[-1].fitted, clear_gap)
    are_wrong = gap > VISIBLE and distance.is_off
    told_by_file = any(judged.variant.twin is not None and judged.prior_gain > 0.0 for judged in named)
    return WrongNumbers(
        gap, distance, are_wrong, told_by_file or _need_no_numbers(e), beside_air > of_the_air
    )


def _beyond_fitted_numbers(e: Evidence, floor: FloatArray) -> float:
    """What the file's own derivatives leave beyond fitted ones, mean square over the floor's."""
    if e.file_model is None:
        return 0.0
    return float(np.mean((e.file_model.mean_square - e.stages[0].held_out.mean_square) / floor**2))


def _need_no_numbers(e: Evidence) -> bool:
    """Whether what was named explains the gap with the file's own derivatives, too.

    One name that does so is likelier than six wrong numbers that happen to imitate it.
    """
    if e.file_model is None or e.file_model_with_effects is None:
        return False
    was, named, final = (
        whole_gap(h.mean_square, e.floor)
        for h in (e.file_model, e.file_model_with_effects, e.stages[-1].held_out)
    )
    return was - named > _BY_NAMES * (was - final)
