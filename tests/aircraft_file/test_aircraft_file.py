"""The aircraft file: what is read, and how mistakes are told."""

from pathlib import Path

import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator, ElevatorOutput, Markers
from advisor.aircraft_file.read import load_aircraft, parse_aircraft
from advisor.gap.effects import EFFECTS
from advisor.words.problems import ConfigurationError
from sim.effects.terms import problems_with

CONTRACT_EXAMPLE = """
name: my aircraft
elevator:
  output: auto
  calibration: [[1100, -25.0], [1500, 0.0], [1900, 25.0]]
  lag_s: null
  delay_s: null
alpha: {source: auto, vane_arm_m: null}
accelerometer: {arm_m: null}
airspeed_m_s: null
reference_airspeed_m_s: null
reference: {mass_kg: null, wing_area_m2: null, chord_m: null, iyy_kg_m2: null,
            cg_percent_chord: null, air_temperature_c: null}
model: {Z_0: 0.04, Z_alpha: -1.0, Z_q: 0.0, Z_delta_e: -0.1, M_0: 0.47,
        M_alpha: -4.9, M_q: -1.5, M_delta_e: -7.2}
campaign: {rule: continuous, window: 3, limit_percent: 25}
limits: {bank_deg: 30, airspeed_change_percent: 15, alpha_deg: null}
"""


def test_no_file_means_the_defaults() -> None:
    assert load_aircraft(None) == Aircraft()


def test_the_example_of_the_contract_is_read(tmp_path: Path) -> None:
    path = tmp_path / "aircraft.yaml"
    path.write_text(CONTRACT_EXAMPLE)
    aircraft = load_aircraft(path)
    assert aircraft.name == "my aircraft"
    assert aircraft.elevator.calibration == ((1100.0, -25.0), (1500.0, 0.0), (1900.0, 25.0))
    assert aircraft.model["M_alpha"] == -4.9
    assert aircraft.limits.alpha_deg is None


def test_outputs_of_the_elevator_are_read_with_a_calibration_and_a_weight_each() -> None:
    pairs = [[1100, -25], [1500, 0], [1900, 25]]
    outputs = [{"output": 1, "calibration": pairs}, {"output": 7, "calibration": pairs, "weight": 0.3}]
    elevator = parse_aircraft({"elevator": {"outputs": outputs}}).elevator
    assert [(one.output, one.weight) for one in elevator.outputs] == [(1, 1.0), (7, 0.3)]
    assert elevator.outputs[1].calibration == ((1100.0, -25.0), (1500.0, 0.0), (1900.0, 25.0))
    assert elevator.is_calibrated


def test_the_ends_of_several_outputs_are_those_of_their_weighted_mean() -> None:
    wide, narrow = ((1000.0, -30.0), (2000.0, 20.0)), ((1000.0, 10.0), (2000.0, -10.0))
    elevator = Elevator(outputs=(ElevatorOutput(1, wide), ElevatorOutput(2, narrow, 0.25)))
    assert elevator.ends_deg == pytest.approx((-26.0, 18.0))
    assert Elevator(calibration=wide).ends_deg == (-30.0, 20.0)
    assert Elevator(outputs=(ElevatorOutput(1),)).ends_deg is None


def test_markers_are_read() -> None:
    markers = parse_aircraft(
        {"markers": {"rc": 9, "above_us": 1600, "text": ["MARK ON", "MARK OFF"]}}
    ).markers
    assert markers == Markers(rc=9, above_us=1600.0, text=("MARK ON", "MARK OFF"))


def test_an_empty_file_and_empty_sections_mean_the_defaults(tmp_path: Path) -> None:
    path = tmp_path / "aircraft.yaml"
    path.write_text("")
    assert load_aircraft(path) == Aircraft()
    assert parse_aircraft({"elevator": None, "model": None}) == Aircraft()


def test_every_mistake_is_listed_at_once_with_its_path() -> None:
    with pytest.raises(ConfigurationError) as caught:
        parse_aircraft(
            {
                "elevator": {"calibration": [[1500, 0.0], [1100, 25.0]], "lagg_s": 0.1},
                "limits": {"bank_deg": "steep"},
                "model": {"Z_alfa": -1.0},
                "campaign": {"rule": "best", "window": 0, "parameters": ["M_alpha", "M_beta"]},
                "wingspan": 2.0,
            }
        )
    message = str(caught.value)
    for part in (
        "elevator.calibration[1]",
        "elevator.lagg_s: unknown key",
        "limits.bank_deg",
        "model.Z_alfa: unknown key",
        "campaign.rule",
        "campaign.window",
        "campaign.parameters[1]: 'M_beta' is none of Z_0",
        "wingspan: unknown key",
    ):
        assert part in message


def test_wrong_effects_are_listed_beside_a_wrong_model() -> None:
    with pytest.raises(ConfigurationError) as caught:
        parse_aircraft(
            {
                "effects": {
                    "transport_delay": {"delay_s": -3},
                    "foo": {},
                    "gust": {"length_m": "long", "height_m": 2.0},
                    "alpha_scale": 0.1,
                },
                "model": {"M_alpha": "abc"},
            }
        )
    for part in (
        "model.M_alpha: ",
        "effects.transport_delay.delay_s: must not be below 0, is -3",
        "effects.foo: unknown effect",
        "effects.gust.length_m: ",
        "effects.gust.height_m: unknown key",
        "effects.alpha_scale: ",
    ):
        assert part in str(caught.value)


def test_effects_of_a_file_are_those_of_the_gap_analysis_and_the_simulator_flies_them_all() -> None:
    assert problems_with({name: effect.keys for name, effect in EFFECTS.items()}) == []


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        ([1, 2], "must hold keys"),
        ("text", "must hold keys"),
        ({"elevator": 5}, "elevator: must hold keys"),
        ({"reference": {"cg_percent_chord": 2500}}, "reference.cg_percent_chord: 2500"),
        ({"reference": {"air_temperature_c": 288.15}}, "reference.air_temperature_c: 288.15"),
        ({"elevator": {"calibration": [[1100]]}}, "elevator.calibration[0]"),
        ({"elevator": {"calibration": [[1100, 1.0], [1500, 1.0]]}}, "rise all the way or fall"),
        ({"elevator": {"output": 40}}, "elevator.output"),
        ({"elevator": {"output": 2, "outputs": [{"output": 1}]}}, "elevator.outputs: replaces"),
        (
            {"elevator": {"calibration": [[1100, 1.0], [1500, 2.0]], "outputs": [{"output": 1}]}},
            "elevator.outputs: replaces",
        ),
        ({"elevator": {"outputs": [{"output": 0}]}}, "elevator.outputs[0].output: 0 is not a servo output"),
        (
            {"elevator": {"outputs": [{"output": 1}, {"output": 1}]}},
            "elevator.outputs[1].output: 1 is listed",
        ),
        ({"elevator": {"outputs": [{"output": 1, "weight": 0}]}}, "elevator.outputs[0].weight"),
        ({"elevator": {"outputs": [{"output": 1, "scale": 2}]}}, "elevator.outputs[0].scale: unknown key"),
        ({"elevator": {"outputs": [{"calibration": None}]}}, "elevator.outputs[0].output"),
        ({"elevator": {"outputs": 3}}, "elevator.outputs"),
        (
            {"elevator": {"outputs": [{"output": 1, "calibration": [[1500, 0.0], [1100, 25.0]]}]}},
            "elevator.outputs[0].calibration[1]: PWM must rise",
        ),
        (
            {
                "elevator": {
                    "outputs": [{"output": 1, "calibration": [[1100, 0.0], [1500, 25.0]]}, {"output": 2}]
                }
            },
            "elevator.outputs[1].calibration: give one for every output, or for none",
        ),
        ({"campaign": {"window": 1}}, "campaign.window"),
        ({"campaign": {"tolerance": {"M_beta": 1.0}}}, "campaign.tolerance.M_beta"),
        ({"campaign": {"tolerance": {"M_q": 0.0}}}, "campaign.tolerance.M_q"),
        ({"elevator": {"lag_s": -0.1}}, "elevator.lag_s"),
        ({"alpha": {"source": "vane"}}, "alpha.source"),
        ({"airspeed_m_s": 0}, "airspeed_m_s"),
        ({"markers": {"rc": 19}}, "markers.rc: 19 is not a channel 1..18"),
        ({"markers": {"rc": 9, "above_us": 3000}}, "markers.above_us"),
        ({"markers": {"text": ["ON"]}}, "markers.text"),
        ({"markers": {"text": ["ON", "ON"]}}, "markers.text: needs two different texts"),
        ({"markers": {"switch": 9}}, "markers.switch: unknown key"),
        ({"airspeed_m_s": float("nan")}, "airspeed_m_s"),
    ],
)
def test_a_mistake_is_told_by_its_path(content: object, expected: str) -> None:
    with pytest.raises(ConfigurationError, match="aircraft file: ") as caught:
        parse_aircraft(content)
    assert expected in str(caught.value)


def test_a_file_that_is_no_yaml_is_told_with_its_line(tmp_path: Path) -> None:
    path = tmp_path / "aircraft.yaml"
    path.write_text("name: x\nelevator: [1, 2\n")
    with pytest.raises(ConfigurationError, match="not a YAML file, line"):
        load_aircraft(path)


def test_a_missing_file_is_told(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match="cannot be read"):
        load_aircraft(tmp_path / "none.yaml")
