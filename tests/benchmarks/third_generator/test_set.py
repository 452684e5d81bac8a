"""A set of the third generator: the same bytes, the promised shares, and logs that the advisor reads."""

import ast
import json
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
import yaml
from click.testing import CliRunner

import benchmarks.third_generator
from advisor.cli.group import advisor
from benchmarks.third_generator.cases import EFFECTS, NAMED, UNNAMED, Assignment, assignments, draw_case
from benchmarks.third_generator.files import cases, truth
from sim.sealed.cases import key_beside, write_set

BLOCKS = {
    "input",
    "force_equation",
    "moment_equation",
    "air",
    "alpha_sensor",
    "pitch_rate_sensor",
    "accelerometer",
    "attitude_sensor",
    "timing",
}


@pytest.fixture(scope="module")
def quiet(tmp_path_factory) -> Path:
    """Two flights with nothing wrong."""
    folder = tmp_path_factory.mktemp("third") / "cases"
    write_set(folder, cases(2, 31, "none"))
    return folder


def key(folder: Path) -> dict:
    return json.loads(key_beside(folder).read_text())["key"]


def document(*arguments: str) -> dict:
    return json.loads(CliRunner().invoke(advisor, [*arguments, "--json"], standalone_mode=False).stdout)


def test_the_generator_shares_only_records_and_protocol_with_anything_of_the_project():
    shared = set()
    for path in Path(benchmarks.third_generator.__file__).parent.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.level == 0:
                shared.add(str(node.module))
            elif isinstance(node, ast.Import):
                shared |= {name.name for name in node.names}
    ours = {name for name in shared if name.split(".")[0] in ("advisor", "sim", "benchmarks", "tests")}
    shared = {"benchmarks.sealed", "benchmarks.sealed.generator", "benchmarks.sealed.tlog"}
    assert ours == {"sim.sealed.cases", *shared}


def test_a_seed_gives_the_same_bytes_again(quiet, tmp_path):
    write_set(tmp_path / "cases", cases(1, 31, "none"))
    for name in ("0001/flight.tlog", "0001/aircraft.yaml"):
        assert (tmp_path / "cases" / name).read_bytes() == (quiet / name).read_bytes()


def test_another_seed_gives_another_flight(quiet, tmp_path):
    write_set(tmp_path / "cases", cases(1, 32, "none"))
    assert (tmp_path / "cases/0001/flight.tlog").read_bytes() != (quiet / "0001/flight.tlog").read_bytes()


def test_the_classes_have_their_shares():
    kinds = Counter(assignment.kind for assignment in assignments(200, 1, None))
    assert kinds == {"none": 40, "one": 90, "two": 16, "parameters": 14, "outside": 40}


def test_every_effect_comes_before_any_comes_twice():
    names = [assignment.names[0] for assignment in assignments(30, 1, "one")]
    assert sorted(names) == sorted(NAMED)


def test_two_effects_enter_in_different_blocks():
    for assignment in assignments(40, 1, "two"):
        first, second = assignment.names
        assert EFFECTS[first].block != EFFECTS[second].block


def test_every_block_has_kinds_without_a_name():
    assert {effect.block for effect in UNNAMED.values()} == BLOCKS


def test_a_case_with_one_effect_shows_it_above_the_noise():
    case = draw_case(Assignment("one", ("actuator_lag",)), 31, 1)
    assert max(case.wrong[0].seen["dynamic_ratios"].values()) >= 0.6
    assert max(case.wrong[0].seen["beyond_parameters"].values()) >= 0.3


def test_a_wrong_model_keeps_the_trim_of_the_first_manoeuvre():
    case = draw_case(Assignment("parameters", ()), 31, 1)
    level, wrong = case.setup.plan.trims[0], case.believed
    rest = wrong["M_0"] + wrong["M_alpha"] * level.alpha + wrong["M_delta_e"] * level.delta
    assert rest == pytest.approx(0.0, abs=1e-9)
    off = [name for name, value in wrong.items() if value != case.setup.plan.model[name]]
    assert 2 <= len(set(off) - {"Z_0", "M_0"}) <= 4


@pytest.mark.study
def test_the_doctor_finds_the_telemetry_usable(quiet):
    case = quiet / "0001"
    answer = document("doctor", str(case / "flight.tlog"), "--aircraft", str(case / "aircraft.yaml"))
    assert answer["verdict"] in ("ready", "usable with limits")


@pytest.mark.study
def test_the_advisor_accepts_half_the_tests_and_finds_the_derivatives(quiet):
    for name, true in key(quiet).items():
        case = quiet / name
        answer = document("analyze", str(case / "flight.tlog"), "--aircraft", str(case / "aircraft.yaml"))
        accepted = [one for one in answer["maneuvers"] if one["verdict"] == "accepted"]
        assert len(accepted) >= 0.5 * len(true["maneuvers"])
        for derivative in ("M_alpha", "M_delta_e", "M_q"):
            found, value = answer["model"][derivative], true["linear_model"][derivative]
            assert abs(found["value"] - value) < 5.0 * found["std"] + 0.02 * abs(value)


def test_the_aircraft_file_states_the_servo_that_is_flown(quiet):
    for name, true in key(quiet).items():
        stated = yaml.safe_load((quiet / name / "aircraft.yaml").read_text())["elevator"]
        assert (stated["lag_s"] or 0.0) == pytest.approx(true["servo"]["lag_s"], rel=1e-4)


@pytest.mark.study
def test_the_truth_tells_that_an_autopilots_own_angle_of_attack_is_late():
    told = [truth(draw_case(Assignment("none", ()), 31, index)) for index in range(1, 9)]
    made = [one for one in told if "alpha_made_by_autopilot" in one["troubles"]]
    assert 0 < len(made) < len(told)
    assert all(bool(one["also_true"]) == (one in made) for one in told)


@pytest.mark.study
@pytest.mark.parametrize("name", EFFECTS)
def test_every_effect_can_be_drawn(name):
    case = draw_case(Assignment("one" if name in NAMED else "outside", (name,)), 77, 1)
    assert np.all(np.isfinite(case.shown["q"]))
