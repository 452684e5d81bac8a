"""A gust is told by its peak and where it passed; a change between two manoeuvres leaves none out."""

import pytest

from advisor.aircraft.aircraft import Aircraft
from tests.gap.diagnosed import diagnose
from tests.gap.generator import Setup, fly

pytestmark = pytest.mark.study
"""Whole diagnoses, run by ``make study-gap``."""


def test_a_change_between_two_manoeuvres_leaves_none_out():
    found = diagnose(fly(Setup(maneuvers=8, cg_step=-0.25, seed=25)), Aircraft())
    assert found.causes[0].effect == "cg_shift"
    assert found.maneuvers == tuple(range(1, 9))


@pytest.mark.parametrize("pulse_m_s", [0.12, 0.2])
def test_a_gust_that_passes_in_two_of_six_manoeuvres_is_told_by_its_peak(pulse_m_s):
    found = diagnose(fly(Setup(maneuvers=6, gust_pulse=pulse_m_s, coloured=0.5, seed=26)), Aircraft())
    assert [c.effect for c in found.causes if c.present] == ["gust"]
    assert found.causes[0].parameters["amplitude_m_s"].value == pytest.approx(pulse_m_s, rel=0.35)


def test_a_gust_is_told_from_where_it_passed_though_a_drift_elsewhere_leaves_more():
    found = diagnose(fly(Setup(maneuvers=9, gust_pulse=0.25, seed=2)), Aircraft())
    assert [c.effect for c in found.causes if c.present] == ["gust"]
    assert found.causes[0].parameters["amplitude_m_s"].value == pytest.approx(0.25, rel=0.35)


def test_a_gust_in_one_manoeuvre_is_no_change():
    found = diagnose(fly(Setup(maneuvers=3, gust_pulse=2.0, seed=26)), Aircraft())
    assert [c.effect for c in found.causes if c.present] == ["gust"]
    assert found.maneuvers == (1, 2, 3)
