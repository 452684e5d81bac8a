"""``advisor gap --export``: mistakes are refused before any work, and each file is written whole or not."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
import yaml
from click.testing import CliRunner

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.aircraft.reference import PARAMETERS
from advisor.aircraft_file.read import load_aircraft
from advisor.analysis import gap as reading
from advisor.cli import group as cli
from advisor.exports.models.flown import improved_model
from advisor.exports.models.formats import ardupilot_format
from advisor.exports.models.write import ExportOrder, carry_out, order_of
from advisor.gap.result import Diagnosis, Value
from advisor.simulators.compare import Compared
from advisor.words.problems import ConfigurationError
from tests.exports.models.cases import CALIBRATION, MODEL, REFERENCE, air_at
from tests.gap.test_report_screen import diagnosis

AIRCRAFT = Aircraft(name="glider", reference=REFERENCE, elevator=Elevator(calibration=CALIBRATION))
FILE = {
    "name": "glider",
    "elevator": {"calibration": [list(pair) for pair in CALIBRATION]},
    "reference": {"mass_kg": 10.0, "wing_area_m2": 0.8, "chord_m": 0.3, "iyy_kg_m2": 0.9},
}
NO_SIDE = "roll and yaw, which no flight and no file gives"


def found(**changes: object) -> Diagnosis:
    """A diagnosis with all eight parameters and a late, slow servo."""
    model = {name: Value(value, abs(value) / 50.0) for name, value in MODEL.items()}
    effects = {"transport_delay": {"delay_s": 0.03}, "actuator_lag": {"lag_s": 0.08}}
    return replace(diagnosis(), **{"model": model, "effects": effects, **changes})


def gap(folder: Path, monkeypatch, *arguments: str, content: object = FILE, answer: Diagnosis | None = None):
    """``advisor gap`` on a log whose diagnosis is known, in a folder."""
    monkeypatch.chdir(folder)
    (folder / "mine.yaml").write_text(yaml.safe_dump(content))
    (folder / "flight.tlog").write_bytes(b"")
    if answer is not None:
        monkeypatch.setattr(reading, "named_simulator", lambda *_: None)
        monkeypatch.setattr(reading, "compare_logs", lambda _, aircraft, *__: Compared(answer, aircraft))
    given = ["gap", "flight.tlog", "--aircraft", "mine.yaml", *arguments]
    return CliRunner().invoke(cli.advisor, given, standalone_mode=False)


@pytest.mark.parametrize(
    ("order", "sentence"),
    [
        ("simulink:x.mdl", "'simulink' is none of the formats jsbsim, ardupilot, matlab, aircraft"),
        ("matlab", "name the file behind a colon, as in matlab:FILE"),
        ("matlab:", "name the file behind a colon"),
        ("matlab:nowhere/x.m", "there is no folder nowhere"),
        ("matlab:.", "is a folder; name a file in it"),
        ("aircraft:mine.yaml", "is already read or written by this command"),
        ("matlab:flight.tlog", "is already read or written by this command"),
        (
            "ardupilot:plane.txt",
            r"must end in \.json \(coefficients, with the servos in plane\.parm\) or \.parm",
        ),
        ("jsbsim:out.xml", "give yours with simulator: jsbsim:MODEL"),
    ],
)
def test_an_order_that_cannot_be_carried_out_is_refused_before_the_log_is_read(
    tmp_path, monkeypatch, order, sentence
):
    result = gap(tmp_path, monkeypatch, "--export", order)
    assert type(result.exception).__name__ == "ConfigurationError"
    assert result.exception is not None
    assert "\n" not in str(result.exception)
    with pytest.raises(Exception, match=sentence):
        raise result.exception


def test_two_orders_for_one_file_are_refused(tmp_path, monkeypatch):
    result = gap(tmp_path, monkeypatch, "--export", "matlab:x.m", "--export", "aircraft:x.m")
    assert "is already read or written by this command" in str(result.exception)


def test_the_reference_that_coefficients_lack_is_named_before_the_log_is_read(tmp_path, monkeypatch):
    lacking = FILE | {"reference": {"mass_kg": 10.0, "chord_m": 0.3}}
    result = gap(tmp_path, monkeypatch, "--export", "ardupilot:x.json", content=lacking)
    assert "need wing_area_m2, iyy_kg_m2; give them under reference:" in str(result.exception)


def test_the_simulators_own_aircraft_is_not_overwritten(tmp_path, monkeypatch):
    (tmp_path / "plane.xml").write_text("<fdm_config/>")
    content = FILE | {"simulator": "jsbsim:plane.xml"}
    result = gap(tmp_path, monkeypatch, "--export", "jsbsim:plane.xml", content=content)
    assert "is the simulator's own aircraft; name another file" in str(result.exception)
    assert (tmp_path / "plane.xml").read_text() == "<fdm_config/>"


def test_the_document_lists_the_files_written_and_what_they_do_not_carry(tmp_path, monkeypatch):
    orders = ["--export", "matlab:x.m", "--export", "ardupilot:x.parm"]
    result = gap(tmp_path, monkeypatch, "--json", *orders, answer=found())
    assert result.return_value == 0
    assert json.loads(result.stdout)["exports"] == [
        {"format": "matlab", "file": "x.m", "left_out": [NO_SIDE]},
        {"format": "ardupilot", "file": "x.parm", "left_out": []},
    ]
    assert all((tmp_path / name).is_file() for name in ("x.m", "x.parm"))
    assert f"x.m: written (matlab); it does not carry: {NO_SIDE}." in result.stderr


def test_a_format_that_fails_after_the_diagnosis_leaves_the_diagnosis_and_the_other_files(
    tmp_path, monkeypatch
):
    def refused(*_):
        raise ConfigurationError("--export ardupilot: no coefficients.")

    monkeypatch.setattr(ardupilot_format, "_pitch", refused)
    orders = ["--export", "ardupilot:x.json", "--export", "matlab:x.m"]
    result = gap(tmp_path, monkeypatch, "--json", *orders, answer=found())
    assert result.return_value == 2
    assert [one["format"] for one in json.loads(result.stdout)["exports"]] == ["matlab"]
    assert "no coefficients" in result.stderr
    assert not (tmp_path / "x.json").exists()


def test_without_orders_the_document_lists_none(tmp_path, monkeypatch):
    result = gap(tmp_path, monkeypatch, "--json", answer=found())
    assert json.loads(result.stdout)["exports"] == []


def test_the_aircraft_file_is_the_one_that_out_writes(tmp_path, monkeypatch):
    orders = ["--out", "by-out.yaml", "--export", "aircraft:by-export.yaml"]
    gap(tmp_path, monkeypatch, *orders, answer=found())
    assert (tmp_path / "by-out.yaml").read_text() == (tmp_path / "by-export.yaml").read_text()
    improved = load_aircraft(tmp_path / "by-export.yaml")
    assert set(improved.model) == set(PARAMETERS)
    assert improved.effects["transport_delay"] == {"delay_s": 0.03}


def test_where_nothing_was_found_the_model_can_still_be_exported(tmp_path):
    plain = found(verdict="none", effects={})
    orders = [ExportOrder("matlab", tmp_path / "x.m"), ExportOrder("aircraft", tmp_path / "x.yaml")]
    script, aircraft = carry_out(orders, improved_model(plain, AIRCRAFT, None))
    assert script.problem == ""
    assert "there is nothing to improve" in aircraft.problem


def test_without_an_air_speed_no_derivative_is_given_to_another_program(tmp_path):
    with pytest.raises(ConfigurationError, match="needs the air speed flown"):
        improved_model(found(reference_airspeed_m_s=None), AIRCRAFT, None)


def test_a_disk_that_refuses_is_told_in_one_sentence(tmp_path, monkeypatch):
    order = ExportOrder("matlab", tmp_path / "gone" / "x.m")
    (one,) = carry_out([order], improved_model(found(), AIRCRAFT, None))
    assert one.problem.endswith("was not written: No such file or directory.")


def test_the_servo_that_the_file_states_is_part_of_what_is_exported(tmp_path):
    stated = replace(AIRCRAFT, elevator=replace(AIRCRAFT.elevator, lag_s=0.05))
    carry_out([ExportOrder("matlab", tmp_path / "x.m")], improved_model(found(), stated, None))
    assert "servo.lag_s = 0.13;" in (tmp_path / "x.m").read_text()


def test_the_height_recorded_gives_the_density(tmp_path):
    slopes = []
    for height_m in (0.0, 1100.0):
        model = improved_model(found(air=air_at(height_m)), AIRCRAFT, None)
        carry_out([ExportOrder("ardupilot", tmp_path / "x.json")], model)
        lines = (tmp_path / "x.json").read_text().splitlines()
        written = json.loads("\n".join(line for line in lines if not line.startswith("#")))
        slopes.append(written["c_lift_a"])
    # The standard atmosphere has 1.225 and 1.1008 kg/m³ there.
    assert slopes[1] / slopes[0] == pytest.approx(1.225 / 1.1008, rel=1e-4)


def test_a_path_with_colons_is_a_path():
    assert order_of("matlab:C:/models/x.m") == ExportOrder("matlab", Path("C:/models/x.m"))


def test_the_simulators_aircraft_is_corrected_where_the_aircraft_file_names_one(tmp_path):
    model = {
        "Z_alpha": -2.9, "Z_q": -0.04, "Z_delta_e": -0.24, "M_alpha": -33.0, "M_q": -5.5, "M_delta_e": -31.0
    }  # fmt: skip
    changed = model | {"M_alpha": -20.0, "Z_0": 0.1, "M_0": 0.2}
    flown = found(
        verdict="parameters", reference_airspeed_m_s=53.0, effects={},
        model={n: Value(v, 0.01 * abs(v)) for n, v in changed.items()},
    )  # fmt: skip
    mine = replace(AIRCRAFT, simulator="jsbsim:c172p", model=model)
    (one,) = carry_out([ExportOrder("jsbsim", tmp_path / "x.xml")], improved_model(flown, mine, None))
    assert one.problem == ""
    assert "M_alpha as flown" in (tmp_path / "x.xml").read_text()
