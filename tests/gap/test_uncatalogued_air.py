"""Air that moves otherwise than turbulence and gusts do has no name: a wave, a wake."""

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.diagnose import diagnose
from advisor.gap.noise.quiet import unfiltered
from advisor.gap.records.prepare import prepare
from advisor.gap.search.air import one_maneuver_stands_out
from advisor.gap.search.baseline import fit_baseline
from tests.gap.generator import Setup, fly

pytestmark = pytest.mark.study
"""Whole diagnoses, run by ``make study-gap``."""

IS_NO_GUST, IS_A_WAVE = 0.25, 0.55


def test_manoeuvres_with_a_gust_stand_out_and_those_of_a_still_flight_do_not():
    """In most manoeuvres the rest is white then, and says nothing of the air in the others."""
    for gust_m_s, stands_out in ((0.6, True), (0.0, False)):
        flights = prepare(fly(Setup(maneuvers=6, gust_pulse=gust_m_s, seed=7)), Aircraft())
        problem, plain = unfiltered(*fit_baseline(flights, Aircraft()))
        assert one_maneuver_stands_out(problem, plain) == stands_out


def test_a_gust_in_one_manoeuvre_is_no_change_of_mass_and_a_change_of_mass_is_no_gust():
    blown = diagnose(fly(Setup(maneuvers=4, gust_pulse=1.0, seed=3)), Aircraft())
    assert [c.effect for c in blown.causes if c.present] == ["gust"]
    loaded = diagnose(fly(Setup(maneuvers=4, mass_step=0.3, seed=3)), Aircraft())
    assert loaded.causes[0].effect == "mass_change"
