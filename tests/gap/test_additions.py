"""Acceptance of an effect: each limit, passed from one side to the other on hand-made numbers."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.gap.kit.variant import Variant
from advisor.gap.search.acceptance import JudgedAddition, least_offset_rad

LAG = Variant(
    "alpha_lag",
    "alpha_sensor",
    ("lag_s", "shape"),
    ((0.02, 0.5),),
    (1e-3, 1e-2),
    ((0.0, 0.3), (0.0, 1.0)),
    0.004,
)
PLAIN = JudgedAddition(
    variant=LAG,
    fitted=None,
    held_out=None,
    gain=10.0,
    removed=0.5,
    least=0.05,
    least_certain=0.01,
    smallest=0.006,
    prior_gain=0.0,
    support=3.0,
    value=np.array([0.03, 0.4]),
    std=np.array([0.003, 0.1]),
    sigmas=10.0,
)
"""An effect that every limit lets pass."""


@pytest.mark.parametrize(
    ("name", "refused", "accepted"),
    [
        ("gain", 5.9, 6.1),
        ("removed", 0.049, 0.051),
        ("sigmas", 2.9, 3.1),
        ("value", np.array([0.0055, 0.4]), np.array([0.0065, 0.4])),
        ("value", np.array([0.03, 0.9995]), np.array([0.03, 0.9985])),
        ("support", 0.9, 1.1),
    ],
)
def test_each_limit_alone_refuses_an_effect(name, refused, accepted):
    assert PLAIN.is_accepted
    assert replace(PLAIN, **{name: accepted}).is_accepted
    assert not replace(PLAIN, **{name: refused}).is_accepted


@pytest.mark.parametrize(("gain", "accepted"), [(29.0, False), (31.0, True)])
def test_a_certain_effect_needs_a_smaller_change(gain, accepted):
    assert replace(PLAIN, gain=gain, removed=0.02).is_accepted == accepted


@pytest.mark.parametrize(("gain", "accepted"), [(29.0, False), (31.0, True)])
def test_an_effect_that_one_manoeuvre_shows_needs_more_likelihood(gain, accepted):
    assert replace(PLAIN, gain=gain, sole_maneuver=2, support=0.0).is_accepted == accepted


@pytest.mark.parametrize(("gain", "accepted"), [(29.0, False), (31.0, True)])
def test_what_moves_with_the_air_needs_more_likelihood(gain, accepted):
    assert replace(PLAIN, gain=gain, with_the_air=True).is_accepted == accepted


@pytest.mark.parametrize(
    ("change", "least_rad"),
    [({}, 0.003), ({"std_rad": 8e-4}, 0.004), ({"alone": False}, 0.0087), ({"derived": True}, 0.0087)],
)
def test_the_least_offset_of_alpha_depends_on_its_source_and_its_error(change, least_rad):
    assert least_offset_rad(**({"std_rad": 1e-4} | change)) == pytest.approx(least_rad)
