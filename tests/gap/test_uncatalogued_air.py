"""Air that moves otherwise than turbulence and gusts do has no name: a wave, a wake."""

import pytest

from advisor.aircraft.aircraft import Aircraft
from tests.gap.diagnosed import diagnose
from tests.gap.generator import Setup, fly

pytestmark = pytest.mark.study
"""Whole diagnoses, run by ``make study-gap``."""


def test_a_gust_in_one_manoeuvre_is_no_change_of_mass_and_a_change_of_mass_is_no_gust():
    blown = diagnose(fly(Setup(maneuvers=4, gust_pulse=1.0, seed=3)), Aircraft())
    assert [c.effect for c in blown.causes if c.present] == ["gust"]
    loaded = diagnose(fly(Setup(maneuvers=4, mass_step=0.3, seed=3)), Aircraft())
    assert loaded.causes[0].effect == "mass_change"
