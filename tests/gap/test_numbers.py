"""The numbers of an answer belong together, whatever was found and whatever was kept out."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.oem.arrow import solved_within
from tests.gap.diagnosed import diagnose
from tests.gap.generator import Setup, fly

pytestmark = pytest.mark.study
"""Whole diagnoses, run by ``make study-gap``."""

HEIGHTS = (120.0, 121.0, 119.0)
CAUSES = {
    "transport_delay": Setup(maneuvers=4, switches={"delay": 0.1}, seed=21),
    "alpha_bias": Setup(maneuvers=4, alpha_bias=0.03, seed=22),
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


@pytest.mark.parametrize(
    ("number", "block"), [("Z_alpha", "force_equation"), ("M_delta_e", "moment_equation")]
)
def test_a_wrong_number_is_placed_in_its_equation(sound, number, block):
    flown, right = sound
    model = {name: value.value for name, value in right.model.items()}
    found = diagnose(flown, Aircraft(model={**model, number: 0.75 * model[number]}))
    assert (found.verdict, found.where.block) == ("parameters", block)
