"""Roll and yaw that a diagnosis hands over to other programs."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.exports.models.axes import handed_over
from advisor.exports.models.axes.handed_over import improved_side
from advisor.exports.models.flown import FlownModel, side_of
from advisor.exports.models.improvement import STILL_AIR
from advisor.gap.result import Value
from advisor.model.axes.lateral import LATERAL, Trim
from tests.campaign.side_builders import estimate
from tests.gap.axes.lateral.test_diagnosis import FOUND
from tests.oem.axes.lateral.builders import JET

OWN = {name: Value(2.0 * value, 0.1) for name, value in JET.items()}


@pytest.mark.parametrize(
    ("simulator", "causes", "l_p"),
    [
        (None, FOUND.causes, 2.0 * JET["L_p"]),
        ("linear", FOUND.causes, 2.0 * JET["L_p"]),
        ("jsbsim:c172p", FOUND.causes, JET["L_p"]),
        (None, (), JET["L_p"]),
    ],
)
def test_beside_an_effect_the_derivatives_of_the_diagnosis_are_handed_over(
    monkeypatch, simulator, causes, l_p
):
    aircraft = Aircraft(simulator=simulator)
    side = side_of(estimate("aileron", "rudder"), Trim(130.0), STILL_AIR, aircraft)
    monkeypatch.setattr(handed_over, "flown_model", lambda *_: FlownModel(aircraft, None, side))
    monkeypatch.setattr(handed_over, "estimate_lateral", lambda *_: estimate("aileron", "rudder"))
    monkeypatch.setattr(handed_over, "accepted_of", lambda _: [])
    gap = replace(FOUND, model=OWN, causes=causes)
    made = improved_side(SimpleNamespace(aircraft=aircraft, state=None, gap=gap))
    assert made.side.values["L_p"].value == pytest.approx(l_p)
    assert made.side.values.keys() <= set(LATERAL.names.reported)
