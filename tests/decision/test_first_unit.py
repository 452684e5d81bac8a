"""The step of each control's first input: by estimates, by the aircraft file, or as usual."""

from dataclasses import replace

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS
from advisor.decision.first_unit import first_unit_s
from tests.campaign.side_builders import estimate as of_side
from tests.decision.campaigns import THETA, estimate

PITCH = estimate(std_percent=5.0)
QUICK = replace(PITCH, theta=4.0 * PITCH.theta)


@pytest.mark.parametrize(
    ("control", "model", "unit_s"),
    [
        ("elevator", dict(zip(PARAMETERS, THETA.tolist(), strict=True)), 0.8),
        ("elevator", {"Z_alpha": -8.0, "M_alpha": -48.3, "M_q": -4.2}, 0.2),
        ("aileron", {"L_p": -9.0}, 0.5),
        ("aileron", {"L_p": -2.0}, 1.0),
        ("rudder", {"N_beta": 4.0}, 1.6),
    ],
)
def test_the_model_of_the_file_times_the_first_input(control, model, unit_s):
    assert first_unit_s(control, Aircraft(model=model)) == unit_s


@pytest.mark.parametrize(("control", "unit_s"), [("elevator", 0.5), ("aileron", 1.0), ("rudder", 1.0)])
def test_without_a_model_and_an_estimate_the_step_is_the_usual_one(control: str, unit_s: float) -> None:
    assert first_unit_s(control, Aircraft()) == unit_s


@pytest.mark.parametrize(
    ("control", "shown", "model", "unit_s"),
    [("elevator", QUICK, {"Z_alpha": -1.0, "M_alpha": -1.0, "M_q": -1.0}, 0.3),
     ("rudder", of_side("rudder"), {"N_beta": 4.0}, 1.8)],
)  # fmt: skip
def test_an_estimate_times_it_where_no_rule_uses_it_after_the_file_and_accepted_before(
    control: str, shown: object, model: dict[str, float], unit_s: float
) -> None:
    assert first_unit_s(control, Aircraft(), others=[shown]) == unit_s
    assert first_unit_s(control, Aircraft(model=model), others=[shown]) != unit_s
    assert first_unit_s(control, Aircraft(model=model), accepted=[shown]) == unit_s


def test_of_several_estimates_the_median_counts() -> None:
    assert first_unit_s("elevator", Aircraft(), [QUICK, QUICK, PITCH]) == first_unit_s(
        "elevator", Aircraft(), [QUICK]
    )
