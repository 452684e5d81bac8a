"""The numbers of an answer belong together, whatever was found and whatever was kept out."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.diagnose import diagnose
from advisor.oem.arrow import solved_within
from tests.gap.generator import Setup, fly

pytestmark = pytest.mark.study
"""Whole diagnoses, run by ``make study-gap``."""

HEIGHTS = (120.0, 121.0, 119.0)
CAUSES = {
    "transport_delay": Setup(maneuvers=4, switches={"delay": 0.1}, seed=21),
    "alpha_bias": Setup(maneuvers=4, alpha_bias=0.03, seed=22),
    "airspeed_variation": Setup(
        maneuvers=6, surge=0.8, surge_hz=0.1, logs_throttle=True, heights_m=HEIGHTS, seed=202
    ),
}


@pytest.mark.parametrize("holdout", [None, 2])
@pytest.mark.parametrize("effect", CAUSES)
def test_waterfall_manoeuvres_and_interval_tell_of_the_same_gap_as_the_total(effect, holdout):
    found = diagnose(fly(CAUSES[effect]), Aircraft(), holdout=holdout)
    assert found.causes[0].effect == effect
    assert found.waterfall[-1][1] == pytest.approx(found.gap.after, rel=1e-9, abs=1e-12)
    kept = [before for number, before, _ in found.gap.by_maneuver if number in found.shrink.holdout]
    assert found.gap.before == pytest.approx(np.mean(kept), rel=0.1)
    assert found.shrink.percent > 90.0
    assert found.shrink.ci95_percent[0] > 50.0
    # The total has the lead-in, too, where nothing is flown.
    assert max(found.gap.by_phase.values()) > found.gap.before


def test_what_is_plotted_as_after_is_what_the_channel_read_where_its_offset_is_the_cause():
    found = diagnose(fly(CAUSES["alpha_bias"]), Aircraft())
    trace = next(t for t in found.traces if t.channel == "alpha")
    assert np.mean(trace.measured - trace.before) == pytest.approx(0.03, abs=0.004)
    assert np.mean(trace.measured - trace.after) == pytest.approx(0.0, abs=0.001)


@pytest.fixture(scope="module")
def sound():
    """Return a flight without a gap, and its diagnosis."""
    flown = fly(Setup(maneuvers=4, seed=5))
    return flown, diagnose(flown, Aircraft())


def test_terms_at_zero_angles_are_those_of_the_reference_speed(sound):
    flown, at_flown = sound
    model = diagnose(flown, Aircraft(reference_airspeed_m_s=27.0)).model
    ratio = 27.0 / at_flown.reference_airspeed_m_s
    # Lift at zero angles, N_0 = Z_0 - g/V, goes with V as all other aerodynamic terms of Eq. (1) do.
    weight, there = 9.80665 / at_flown.reference_airspeed_m_s, 9.80665 / 27.0
    assert model["Z_alpha"].value == pytest.approx(ratio * at_flown.model["Z_alpha"].value, rel=0.02)
    assert model["Z_0"].value - there == pytest.approx(
        ratio * (at_flown.model["Z_0"].value - weight), abs=0.03
    )
    assert model["M_0"].value == pytest.approx(ratio**2 * at_flown.model["M_0"].value, abs=0.4)


def test_a_number_at_its_bound_leaves_the_others_at_their_best_beside_it():
    H, g = np.array([[2.0, 1.9], [1.9, 2.0]]), np.array([1.0, -1.0])
    free = np.linalg.solve(H, g)
    assert solved_within(H, g, np.full(2, -100.0), np.full(2, 100.0)) == pytest.approx(free)
    bounded = solved_within(H, g, np.array([-100.0, -100.0]), np.array([3.0, 100.0]))
    assert bounded == pytest.approx([3.0, (g[1] - H[1, 0] * 3.0) / H[1, 1]])


def test_a_file_without_the_terms_at_zero_angles_has_wrong_numbers_all_the_same(sound):
    flown, right = sound
    six = {name: value.value for name, value in right.model.items() if not name.endswith("_0")}
    wrong = Aircraft(model={**six, "M_alpha": 0.6 * six["M_alpha"]})
    assert diagnose(flown, wrong).verdict == "parameters"


def test_wrong_numbers_that_make_nearly_all_of_a_gap_are_the_answer_though_a_moment_bends_a_little(sound):
    _, right = sound
    model = {name: value.value for name, value in right.model.items()}
    wrong = Aircraft(model={**model, "M_alpha": 0.45 * model["M_alpha"], "M_q": 1.3 * model["M_q"]})
    found = diagnose(fly(Setup(maneuvers=6, switches={"cm_a2": 1.6}, seed=5)), wrong)
    assert [c.effect for c in found.causes if c.present] == ["nonlinear_pitching_moment"]
    assert found.verdict == "parameters"
    assert "wrong numbers" in found.sentence
    assert "nonlinear pitching moment" in found.sentence
    assert found.shrink.by_numbers_percent > 98.0


@pytest.mark.parametrize(
    ("number", "block"), [("Z_alpha", "force_equation"), ("M_delta_e", "moment_equation")]
)
def test_a_wrong_number_is_placed_in_its_equation(sound, number, block):
    flown, right = sound
    model = {name: value.value for name, value in right.model.items()}
    found = diagnose(flown, Aircraft(model={**model, number: 0.75 * model[number]}))
    assert (found.verdict, found.where.block) == ("parameters", block)


@pytest.mark.parametrize(
    ("gust_m_s", "off", "verdict", "said"),
    [
        (2.0, {"M_delta_e": 0.88}, "parameters", "the air makes the rest"),
        (6.0, {"Z_alpha": 0.8}, "effect", "its parameters are wrong too"),
    ],
)
def test_of_a_gust_and_wrong_numbers_the_larger_part_of_the_gap_is_the_answer(
    sound, gust_m_s, off, verdict, said
):
    _, right = sound
    model = {name: off.get(name, 1.0) * value.value for name, value in right.model.items()}
    given = Aircraft(model=model, reference_airspeed_m_s=right.reference_airspeed_m_s)
    found = diagnose(fly(Setup(maneuvers=4, gust_pulse=gust_m_s, seed=26)), given)
    assert found.verdict == verdict
    assert said in found.sentence
    assert [c.effect for c in found.causes if c.present] == ["gust"]


@pytest.mark.study
def test_beside_something_unknown_what_was_named_stays():
    setup = Setup(maneuvers=6, switches={"delay": 0.06, "beat": 0.004}, seed=21)
    found = diagnose(fly(setup), Aircraft())
    assert found.verdict == "unknown"
    assert found.causes[0].effect == "transport_delay"
    assert found.causes[0].present
    assert "in addition to what looks like transport delay" in found.sentence
    assert found.effects["transport_delay"]["delay_s"] == pytest.approx(0.06, abs=0.005)
