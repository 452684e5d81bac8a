"""What an unknown moment comes of is told by its course: a tone, the stick, or neither."""

import numpy as np
import pytest

from advisor.aircraft import Aircraft
from advisor.gap.noise.probes import KNOTS_S
from advisor.gap.records.prepare import prepare
from advisor.gap.unnamed.course import is_in_few, is_of_the_air, louder_with_the_stick, tone_of
from tests.gap.generator import Setup, fly


@pytest.fixture(scope="module")
def flights():
    return prepare(fly(Setup(maneuvers=6)), Aircraft()).flights


def times(flights):
    return [np.arange(KNOTS_S, flight.duration_s, KNOTS_S) for flight in flights]


def gusty(flights, seed=1):
    """First-order Gauss-Markov courses of 0.6 s memory, as air that passes makes them."""
    rng = np.random.default_rng(seed)
    keep = np.exp(-KNOTS_S / 0.6)
    courses = []
    for t in times(flights):
        y = np.zeros(len(t))
        for i in range(1, len(t)):
            y[i] = keep * y[i - 1] + rng.standard_normal()
        courses.append(y)
    return courses


def test_a_course_of_gusts_is_of_the_air(flights):
    assert all(is_of_the_air(flights, gusty(flights, seed)) for seed in range(20))


def test_a_hum_under_noise_is_not(flights):
    noise = np.random.default_rng(2)
    hums = [np.sin(2 * np.pi * 1.3 * t) + 0.3 * noise.standard_normal(len(t)) for t in times(flights)]
    assert tone_of(hums) > 0.7
    assert not is_of_the_air(flights, hums)


def test_what_the_stick_sets_off_is_not(flights):
    pushed = [
        course * (1.0 + 2.0 * ((t > f.first_step_s) & (t < f.last_step_s)))
        for f, t, course in zip(flights, times(flights), gusty(flights), strict=True)
    ]
    assert louder_with_the_stick(flights, pushed) > 2.0
    assert not is_of_the_air(flights, pushed)


def test_what_is_in_few_manoeuvres_is_told_from_what_all_have():
    assert is_in_few(np.array([1.0, 1.2, 30.0, 0.9, 1.1, 12.0]))
    assert not is_in_few(np.array([5.0, 8.0, 6.0, 9.0, 1.0, 7.0]))
