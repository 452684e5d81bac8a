"""Two effects that resemble others, or wrong derivatives, are found by means of the file's derivatives."""

import pytest

from advisor.aircraft.aircraft import Aircraft
from tests.gap.diagnosed import diagnose
from tests.gap.generator import Setup, fly

pytestmark = pytest.mark.study
"""Whole diagnoses, run by ``make study-gap``."""


@pytest.fixture(scope="module")
def plane() -> Aircraft:
    """Return the aircraft file of the flown aircraft, estimated from a flight without a gap."""
    sound = diagnose(fly(Setup(maneuvers=6, noise=0.005, seed=24)), Aircraft())
    model = {name: number.value for name, number in sound.model.items()}
    return Aircraft(model=model, reference_airspeed_m_s=sound.reference_airspeed_m_s)


def test_a_file_that_does_not_say_at_which_speed_it_holds_is_believed_at_one_that_was_flown(plane):
    powers = {"Z_alpha": 1, "Z_delta_e": 1, "M_alpha": 2, "M_q": 1, "M_delta_e": 2}
    faster = {name: value * 1.05 ** powers.get(name, 0) for name, value in plane.model.items()}
    flown = fly(Setup(maneuvers=6, noise=0.005, speed_change=0.08, seed=24))
    silent = diagnose(flown, Aircraft(model=faster))
    assert silent.verdict == "none"
    assert silent.reference_airspeed_m_s == pytest.approx(1.05 * plane.reference_airspeed_m_s, rel=0.01)
    assert any("state reference_airspeed_m_s" in note for note in silent.notes)
    assert any("At constant speed the simulator would leave a gap" in note for note in silent.notes)
    stated = Aircraft(model=faster, reference_airspeed_m_s=plane.reference_airspeed_m_s)
    wrong = diagnose(flown, stated)
    assert wrong.verdict == "parameters"
    assert not any("one at constant speed" in note for note in wrong.notes)
    # No speed makes one number of them right.
    one = Aircraft(model={**plane.model, "M_alpha": 1.12 * plane.model["M_alpha"]})
    assert diagnose(flown, one).verdict == "parameters"


def test_numbers_that_are_wrong_beside_an_effect_stay_wrong(plane):
    wrong = Aircraft(
        model={**plane.model, "M_delta_e": 0.75 * plane.model["M_delta_e"]},
        reference_airspeed_m_s=plane.reference_airspeed_m_s,
    )
    found = diagnose(fly(Setup(maneuvers=6, switches={"delay": 0.06}, noise=0.01, seed=7)), wrong)
    assert [c.effect for c in found.causes if c.present] == ["transport_delay"]
    assert found.causes[0].parameters["delay_s"].value == pytest.approx(0.06, abs=0.003)
