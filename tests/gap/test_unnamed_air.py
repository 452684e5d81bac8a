"""Air that moves otherwise than turbulence and gusts do has no name: a wave, a wake."""

import numpy as np
import pytest
from scipy.signal import lfilter

from advisor.aircraft import Aircraft
from advisor.gap.diagnose import diagnose
from advisor.gap.noise.probes import KNOTS_S
from advisor.gap.noise.quiet import unfiltered
from advisor.gap.records.prepare import prepare
from advisor.gap.search.air import one_stands_out
from advisor.gap.search.baseline import fit_baseline
from advisor.gap.unnamed.unnamed_air import unlike_gusts, wave_in
from tests.gap.generator import Setup, fly

pytestmark = pytest.mark.study
"""Whole diagnoses, run by ``make study-gap``."""

T = KNOTS_S * np.arange(80)
IS_NO_GUST, IS_A_WAVE = 0.25, 0.55


def bump(middle_s: float, length_s: float) -> np.ndarray:
    inside = np.abs(T - middle_s) < 0.5 * length_s
    return inside * (0.5 + 0.5 * np.cos(2 * np.pi * (T - middle_s) / length_s))


def wandering(rng: np.random.Generator, std: float) -> np.ndarray:
    """First-order noise with a memory of 0.6 s, as the course of quiet air is estimated."""
    keep = np.exp(-KNOTS_S / 0.6)
    return lfilter([np.sqrt(1 - keep**2) * std], [1.0, -keep], rng.standard_normal(len(T)))


@pytest.mark.parametrize("length_s", [0.4, 1.0, 3.0])
def test_a_gust_of_any_length_either_way_and_cut_off_by_the_record_is_one(length_s):
    rng = np.random.default_rng(41)
    courses = [wandering(rng, 0.05) for _ in range(9)]
    for i, middle_s in enumerate((0.1, 2.03, 4.4, 7.8)):
        courses[2 * i] += (1, -1)[i % 2] * bump(middle_s, length_s)
    assert unlike_gusts(courses) < 0.5 * IS_NO_GUST


@pytest.mark.parametrize("apart_s", [0.4, 0.8, 1.6])
def test_two_cores_of_a_wake_are_no_gust(apart_s):
    rng = np.random.default_rng(42)
    courses = [wandering(rng, 0.05) for _ in range(9)]
    for course in courses[::2]:
        course += bump(3.0, 0.8) - bump(3.0 + apart_s, 0.8)
    assert unlike_gusts(courses) > 1.2 * IS_NO_GUST


def test_turbulence_has_no_period_whatever_its_memory():
    rng = np.random.default_rng(43)
    for memory_s in (0.1, 0.5, 2.0):
        keep = np.exp(-KNOTS_S / memory_s)
        for _ in range(30):
            courses = [lfilter([1.0], [1.0, -keep], rng.standard_normal(len(T))) for _ in range(6)]
            assert wave_in(courses)[1] < 0.9 * IS_A_WAVE


def test_a_wave_under_wandering_air_is_found_with_its_period_whatever_its_phase():
    rng = np.random.default_rng(44)
    courses = [np.sin(2 * np.pi * T / 2.7 + rng.uniform(0, 6)) + wandering(rng, 0.4) for _ in range(6)]
    period_s, share = wave_in(courses)
    assert period_s == pytest.approx(2.7, rel=0.05)
    assert share > IS_A_WAVE


def test_a_wave_longer_than_half_a_record_cannot_be_told_from_turbulence():
    courses = [np.sin(2 * np.pi * T / 12.0 + phase) for phase in range(6)]
    assert wave_in(courses)[1] < IS_A_WAVE
    assert wave_in([course[:8] for course in courses]) == (0.0, 0.0)


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
