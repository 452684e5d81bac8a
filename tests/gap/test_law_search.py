"""A law without a name, on hand-made powers: what must hold before it is told."""

from types import SimpleNamespace

import numpy as np
import pytest

from advisor.gap.uncatalogued.candidate_laws import RINGING
from advisor.gap.uncatalogued.law_search import _is_law

BEFORE = np.ones((6, 2))


def told(after, gain=50.0, effect="attitude_scale", considered=()):
    """Return whether a law is told that leaves the share ``after`` of each manoeuvre's power."""
    powers = np.repeat(np.reshape(after, (6, 1)), 2, axis=1)
    held, kept = (SimpleNamespace(by_maneuver=by, mean_square=np.mean(by, axis=0)) for by in (BEFORE, powers))
    stage = SimpleNamespace(held_out=held, disputed=None, added=None, considered=considered)
    judged = SimpleNamespace(is_accepted=True, gain=gain, held_out=kept, effect=effect)
    return _is_law(None, [stage], judged, np.array([100.0, 100.0]))


@pytest.mark.parametrize(("better", "is_told"), [(3, False), (4, True)])
def test_a_law_helps_more_than_half_of_the_manoeuvres(better, is_told):
    assert told([0.5] * better + [1.01] * (6 - better)) == is_told


@pytest.mark.parametrize(("gain", "is_told"), [(29.0, False), (31.0, True)])
def test_a_law_is_certain(gain, is_told):
    assert told([0.2] * 6, gain=gain) == is_told


@pytest.mark.parametrize(("left", "is_told"), [(0.4, False), (0.2, True)])
def test_a_servo_that_rings_leaves_little(left, is_told):
    assert told([left] * 6, effect=RINGING.effect) == is_told


@pytest.mark.parametrize(("gain", "is_told"), [(40.0, True), (48.0, False)])
def test_a_law_fits_better_than_an_effect_that_is_too_small_to_be_named(gain, is_told):
    small = SimpleNamespace(gain=gain, is_only_small=True)
    assert told([0.2] * 6, considered=(small,)) == is_told
