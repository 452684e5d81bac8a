"""Wrong derivatives or a named effect: the larger part of the gap decides, on hand-made findings."""

from dataclasses import replace

import pytest

from advisor.gap.fitting.prior import Distance
from advisor.gap.result import Cause
from advisor.gap.verdict import judgement
from advisor.gap.verdict.wrong_derivatives import WrongDerivatives

WRONG = WrongDerivatives(
    1.0, Distance(30.0, 0.0, 8.0), are_wrong=True, are_imitated=False, outweigh_the_air=True
)
EFFECT = Cause("actuator_backlash", "input", 0.9, {}, (), "", 0.0, True)


def verdict(share, derivatives=WRONG, *, bias=None, unknown=False, named=True):
    """Return the verdict where the derivatives make a share of the gap and a named effect the rest."""
    found = judgement._Found(
        named=[EFFECT] if named else [],
        removed=(1.0 - share) / share,
        derivatives=derivatives,
        bias=bias,
        speed=None,
        speed_outweighs=False,
        outside_fit=(),
        unknown=unknown,
    )
    return judgement._verdict(found, (EFFECT,) if named else ())


@pytest.mark.parametrize(("share", "expected"), [(0.6, "effect"), (0.97, "effect"), (0.99, "parameters")])
def test_derivatives_outweigh_a_named_effect_only_above_98_percent_of_the_gap(share, expected):
    assert verdict(share) == expected


def test_without_a_named_effect_wrong_derivatives_are_the_answer():
    assert verdict(0.6, named=False) == "parameters"


def test_derivatives_that_imitate_the_effect_are_not_the_answer():
    assert verdict(0.99, replace(WRONG, are_imitated=True)) == "effect"


def test_derivatives_within_moving_air_are_not_the_answer():
    assert verdict(0.99, replace(WRONG, outweigh_the_air=False)) == "effect"


def test_an_offset_of_the_vane_is_an_effect_next_to_wrong_derivatives():
    assert verdict(0.99, bias=EFFECT) == "effect"


def test_an_unexplained_residual_is_unknown_whatever_else_is_found():
    assert verdict(0.99, unknown=True) == "unknown"
