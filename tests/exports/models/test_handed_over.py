"""Roll and yaw that a diagnosis hands over to other programs."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.cli.gap_asked import GapAsked
from advisor.exports.models.axes import handed_over
from advisor.exports.models.axes import handed_over as roll_and_yaw
from advisor.exports.models.axes.handed_over import improved_side
from advisor.exports.models.flown import FlownModel, side_of
from advisor.exports.models.formats.aircraft_format import AircraftFormat
from advisor.exports.models.improvement import STILL_AIR
from advisor.gap.effects import EFFECTS
from advisor.gap.inference.prior import FIELD
from advisor.gap.result import Cause, Value
from advisor.model.axes.lateral import LATERAL, Trim
from tests.campaign.side_builders import estimate
from tests.gap.axis.test_diagnosis import FOUND
from tests.oem.axis.builders import JET

OWN = {name: Value(2.0 * value, 0.1) for name, value in JET.items()}


def handed(monkeypatch, simulator, causes) -> FlownModel:
    """Return the model after a diagnosis with these causes."""
    aircraft = Aircraft(simulator=simulator)
    side = side_of(estimate("aileron", "rudder"), Trim(130.0), STILL_AIR, aircraft)
    monkeypatch.setattr(handed_over, "flown_model", lambda *_: FlownModel(aircraft, None, side))
    monkeypatch.setattr(handed_over, "estimate_axis", lambda *_: estimate("aileron", "rudder"))
    monkeypatch.setattr(handed_over, "accepted_of", lambda _: [])
    gap = replace(FOUND, model=OWN, causes=causes)
    return improved_side(SimpleNamespace(aircraft=aircraft, state=None, diagnosis=gap))


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
    made = handed(monkeypatch, simulator, causes)
    assert made.side.values["L_p"].value == pytest.approx(l_p)
    assert made.side.values.keys() <= set(LATERAL.names.reported)


@pytest.mark.parametrize(
    ("of", "effect", "beyond"),
    [
        ("aileron", "actuator_lag", ()),
        ("rudder", "transport_delay", ()),
        ("aileron", "actuator_backlash", ("aileron actuator backlash",)),
        ("r", "pitch_rate_skew", ("late yaw rate stamps",)),
    ],
)
def test_an_effect_without_a_key_of_the_aircraft_file_is_told(monkeypatch, of, effect, beyond):
    named = " ".join(beyond) or f"{of} {effect}"
    sizes = dict.fromkeys(EFFECTS[effect].keys, Value(0.01, 0.001))
    cause = Cause(effect, of, 0.9, sizes, (), "", 1.0, present=True, of=of, named=named)
    made = handed(monkeypatch, None, (cause,))
    assert made.beyond_keys == beyond
    assert AircraftFormat().made(made, Path("a.yaml")).left_out == beyond


def test_the_command_tells_what_the_improved_file_lacks(monkeypatch, capsys, tmp_path):
    made = handed(monkeypatch, None, ())
    made = replace(made, side=replace(made.side, beyond_keys=("aileron actuator backlash",)))
    out = tmp_path / "better.yaml"
    asked = GapAsked(None, Aircraft(), FIELD, out, None, [], (), why=False, as_json=False)
    assert asked.improved(True, lambda: made) == out
    assert "better.yaml has no key for: aileron actuator backlash." in " ".join(
        capsys.readouterr().err.split()
    )


BIN = Path(__file__).parents[2] / "cases" / "base.bin"


def test_a_flight_without_aileron_and_rudder_inputs_is_read_once_and_judged_never(monkeypatch):
    def judged(*_, **__):
        raise AssertionError

    monkeypatch.setattr(roll_and_yaw, "read_whole", judged)
    assert roll_and_yaw.side_of_logs([BIN], Aircraft()) is None


def test_a_log_that_cannot_be_read_tells_nothing_of_roll_and_yaw(tmp_path):
    (tmp_path / "x.tlog").write_bytes(b"")
    assert roll_and_yaw.side_of_logs([tmp_path / "x.tlog"], Aircraft()) is None


@pytest.mark.parametrize("flies", [True, False])
def test_the_campaign_is_judged_where_a_control_of_roll_and_yaw_was_flown(monkeypatch, flies):
    class JudgedError(Exception):
        pass

    def judged(*_, **__):
        raise JudgedError

    monkeypatch.setattr(roll_and_yaw, "flies_roll_or_yaw", lambda *_: flies)
    monkeypatch.setattr(roll_and_yaw, "read_whole", judged)
    if flies:
        with pytest.raises(JudgedError):
            roll_and_yaw.side_of_logs([BIN], Aircraft())
    else:
        assert roll_and_yaw.side_of_logs([BIN], Aircraft()) is None
