"""A load drops or fuel is pumped while a manoeuvre is flown: that one tells of neither before nor after."""

import pytest

from advisor.aircraft import Aircraft
from advisor.gap.diagnose import diagnose
from tests.gap.generator import Setup, fly

pytestmark = pytest.mark.study
"""Whole diagnoses, run by ``make study-gap``."""

HARD = {"gust_std": 0.1, "coloured": 0.5, "jitter": 0.003, "speed_change": 0.03}


@pytest.mark.parametrize(
    ("effect", "change", "at_s", "conditions"),
    [
        pytest.param("cg_shift", {"cg_step": -0.25}, 2.5, {}, marks=pytest.mark.study),
        pytest.param("mass_change", {"mass_step": 0.12}, 5.0, HARD, marks=pytest.mark.study),
        ("mass_change", {"mass_step": -0.15}, 1.5, {}),
    ],
)
def test_a_change_that_comes_while_a_manoeuvre_is_flown_is_named_from_the_others(
    effect, change, at_s, conditions
):
    setup = Setup(maneuvers=8, comes_at_s=at_s, seed=int(10 * at_s), **change, **conditions)
    found = diagnose(fly(setup), Aircraft())
    assert found.verdict == "effect"
    assert found.causes[0].effect == effect
    assert {c.effect for c in found.causes if c.present} <= {effect, "turbulence"}
    assert found.causes[0].parameters["step"].value == pytest.approx(next(iter(change.values())), abs=0.02)
    assert "Left out: manoeuvre 5: the change came while it was flown." in found.notes
    assert found.maneuvers == (1, 2, 3, 4, 6, 7, 8)


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
