"""Air that moves otherwise than turbulence and gusts do has no name: a wave, a wake."""

import pytest

from advisor.aircraft import Aircraft
from advisor.gap.diagnose import diagnose
from advisor.gap.noise.quiet import unfiltered
from advisor.gap.records.prepare import prepare
from advisor.gap.search.air import one_stands_out
from advisor.gap.search.baseline import fit_baseline
from tests.gap.generator import Setup, fly

pytestmark = pytest.mark.study
"""Whole diagnoses, run by ``make study-gap``."""

IS_NO_GUST, IS_A_WAVE = 0.25, 0.55


def test_a_gust_has_its_name_and_a_wake_has_none():
    gusts = Setup(maneuvers=6, gust_pulse=1.5, seed=45)
    assert diagnose(fly(gusts), Aircraft()).causes[0].effect == "gust"
    found = diagnose(fly(Setup(maneuvers=6, gust_pulse=1.5, wake=True, seed=45)), Aircraft())
    assert (found.verdict, found.where.block) == ("unknown", "air")


def test_manoeuvres_with_a_gust_stand_out_and_those_of_a_still_flight_do_not():
    """In most manoeuvres the rest is white then, and says nothing of the air in the others."""
    for gust_m_s, stands_out in ((0.6, True), (0.0, False)):
        flights = prepare(fly(Setup(maneuvers=6, gust_pulse=gust_m_s, seed=7)), Aircraft())
        problem, plain = unfiltered(*fit_baseline(flights, Aircraft()))
        assert one_stands_out(problem, plain) == stands_out


def test_turbulence_has_its_name_and_a_wave_has_none():
    turbulent = diagnose(fly(Setup(maneuvers=6, gust_std=0.3, seed=46)), Aircraft())
    assert (turbulent.verdict, turbulent.causes[0].effect) == ("effect", "turbulence")
    found = diagnose(fly(Setup(maneuvers=6, wave_m_s=0.5, wave_s=2.5, seed=46)), Aircraft())
    assert (found.verdict, found.where.block) == ("unknown", "air")
    assert any("every 2." in note for note in found.notes)


def test_a_gust_in_one_manoeuvre_is_no_change_of_mass_and_a_change_of_mass_is_no_gust():
    blown = diagnose(fly(Setup(maneuvers=4, gust_pulse=1.0, seed=3)), Aircraft())
    assert [c.effect for c in blown.causes if c.present] == ["gust"]
    loaded = diagnose(fly(Setup(maneuvers=4, mass_step=0.3, seed=3)), Aircraft())
    assert loaded.causes[0].effect == "mass_change"
