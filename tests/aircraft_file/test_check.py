"""``advisor aircraft check``: what a file lacks, what that costs, and what contradicts a log."""

import json
from pathlib import Path

import pytest

from advisor.aircraft_file.log_facts import KEYS, contradicted
from advisor.aircraft_file.read import parse_aircraft
from advisor.flight.signals.trust import InstrumentFinding
from tests.conftest import Advisor
from tests.schemas import breaches

LOG = Path(__file__).parents[1] / "cases" / "t_base.tlog"


def _lacking(advisor: Advisor, folder: Path, text: str, *options: object) -> dict[str, bool]:
    """Path of each key that the file lacks to whether the log contradicts the key."""
    file = folder / "a.yaml"
    file.write_text(text)
    document = json.loads(advisor("aircraft", "check", file, "--json", *options).stdout)
    assert breaches("aircraft", document) == []
    return {lack["key"]: lack["wrong"] for lack in document["lacks"]}


def test_an_empty_file_lacks_all_that_costs_something(advisor: Advisor, tmp_path: Path) -> None:
    lacking = _lacking(advisor, tmp_path, "")
    assert {"elevator.calibration", "elevator.lag_s", "reference.chord_m", "model"} <= lacking.keys()
    assert not any(lacking.values())


def test_a_key_that_is_given_is_not_missing(advisor: Advisor, tmp_path: Path) -> None:
    text = "elevator: {output: 2, calibration: [[1000, 25], [2000, -25]], lag_s: 0.1}\nsimulator: linear\n"
    lacking = _lacking(advisor, tmp_path, text)
    assert not {"elevator.output", "elevator.calibration", "elevator.lag_s", "model"} & lacking.keys()


def test_a_vanes_arm_is_missing_only_where_there_is_a_vane(advisor: Advisor, tmp_path: Path) -> None:
    assert "alpha.vane_arm_m" not in _lacking(advisor, tmp_path, "")
    assert "alpha.vane_arm_m" in _lacking(advisor, tmp_path, "alpha: {source: named_value:AOA}")


def test_a_log_that_names_the_elevator_stands_in_for_the_key(advisor: Advisor, tmp_path: Path) -> None:
    assert "elevator.output" in _lacking(advisor, tmp_path, "")
    assert "elevator.output" not in _lacking(advisor, tmp_path, "", "--log", LOG)


def test_outputs_of_aileron_and_rudder_are_missing_where_no_parameter_names_surfaces(advisor, tmp_path):
    text, nameless = "elevator: {output: 2}", LOG.parent / "u_base.ulg"
    assert {"aileron.output", "rudder.output"} <= _lacking(advisor, tmp_path, text, "--log", nameless).keys()
    assert "aileron.output" not in _lacking(advisor, tmp_path, text, "--log", LOG)
    given = f"{text}\naileron: {{output: 1}}\nrudder: {{output: 4}}"
    assert "aileron.output" not in _lacking(advisor, tmp_path, given, "--log", nameless)


def test_pulses_beyond_the_calibration_contradict_it(advisor: Advisor, tmp_path: Path) -> None:
    narrow = "elevator: {output: 2, calibration: [[1495, 1], [1505, -1]]}"
    assert _lacking(advisor, tmp_path, narrow, "--log", LOG)["elevator.calibration"]


def test_a_reference_speed_that_was_not_flown_contradicts_the_log(advisor: Advisor, tmp_path: Path) -> None:
    assert _lacking(advisor, tmp_path, "reference_airspeed_m_s: 50", "--log", LOG)["reference_airspeed_m_s"]


def test_every_missing_key_is_told_with_its_cost_and_its_mend(advisor: Advisor, tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text("")
    said = " ".join(advisor("aircraft", "check", tmp_path / "a.yaml").stdout.split())
    for key in KEYS:
        if key.cost and key.path not in ("airspeed_m_s", "alpha.vane_arm_m"):
            assert f"{key.path} {key.cost} -> {key.mend}." in said


def test_a_file_that_is_wrong_ends_with_code_2(advisor: Advisor, tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text("elevatr: 2\n")
    assert advisor("aircraft", "check", tmp_path / "a.yaml").returncode == 2


@pytest.mark.parametrize("key", [key for key in KEYS if key.path != "elevator.calibration"])
def test_the_example_of_every_key_is_read(key) -> None:
    import yaml

    content = yaml.safe_load(key.example)
    for name in reversed(key.path.split(".")):
        content = {name: content}
    parse_aircraft(content)


def test_the_servos_of_aileron_and_rudder_are_missing_where_the_log_has_these_surfaces(advisor, tmp_path):
    lacking = _lacking(advisor, tmp_path, "", "--log", LOG.parent / "base.bin")
    assert {"aileron.lag_s", "rudder.calibration"} <= lacking.keys()
    given = "aileron: {output: 1, calibration: [[1000, 25], [2000, -25]], lag_s: 0.1}"
    assert "aileron.lag_s" not in _lacking(advisor, tmp_path, given)


def test_what_the_motion_of_a_log_contradicts_is_said_as_the_analysis_says_it() -> None:
    reversed_one = InstrumentFinding(
        "aileron", "sign", None, "right", contradicts=True,
        text="no aileron.calibration states the sign of the aileron: a positive one rolls to the right",
        fix="give aileron.calibration with positive to the left",
    )  # fmt: skip
    agreeing = InstrumentFinding("rudder", "sign", "left", "left", text="a positive one yaws to the left")
    (lack,) = contradicted([reversed_one, agreeing])
    assert (lack.key, lack.mend, lack.wrong) == ("aileron.calibration", reversed_one.fix, True)
    assert lack.cost == f"{reversed_one.sentence}."


def test_a_reversed_elevator_is_found_in_its_log(advisor: Advisor, tmp_path: Path) -> None:
    text = "elevator: {output: 2, calibration: [[1100, -25], [1500, 0], [1900, 25]]}\n"
    lacking = _lacking(advisor, tmp_path, text, "--log", LOG)
    assert lacking["elevator.calibration"]
