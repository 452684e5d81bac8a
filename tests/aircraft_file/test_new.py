"""``advisor aircraft new``: what a log or a crew says becomes a commented file that loads."""

import shlex
import shutil
from pathlib import Path

import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.aircraft_file.log_facts import KEYS, LogFacts
from advisor.aircraft_file.proposal import proposed
from advisor.aircraft_file.read import load_aircraft
from advisor.flight.elevator.elevator_guess import Guess
from advisor.flight.elevator.elevator_outputs import find_elevator
from advisor.flight.vehicle.ardupilot_wiring import WORDS
from advisor.flight.vehicle.mixers import ELEVONS
from advisor.flight.vehicle.surfaces import Scale, Wiring
from advisor.flight.vehicle.vehicle import Vehicle
from tests.conftest import Advisor

CASES = Path(__file__).parents[1] / "cases"
LOGS = Path(__file__).parents[2] / "logs"


@pytest.mark.parametrize("log", [CASES / "t_base.tlog", CASES / "base.bin"])
def test_a_log_tells_the_elevators_output_and_the_air_speed(advisor, tmp_path, log):
    file = tmp_path / "a.yaml"
    assert advisor("aircraft", "new", "--from", log, "-o", file).returncode == 0
    aircraft = load_aircraft(file)
    assert aircraft.elevator.output == 2
    assert aircraft.reference_airspeed_m_s == pytest.approx(24.0, abs=1.5)


def test_the_end_points_of_the_servo_stand_in_the_file_as_an_example(advisor, tmp_path):
    file = tmp_path / "a.yaml"
    advisor("aircraft", "new", "--from", CASES / "t_base.tlog", "-o", file)
    assert "# calibration: [[1100, 25.0], [1500, 0.0], [1900, -25.0]]" in file.read_text()
    assert not load_aircraft(file).elevator.is_calibrated


def test_an_unknown_elevator_is_said_and_left_out(advisor: Advisor, tmp_path: Path) -> None:
    file = tmp_path / "a.yaml"
    run = advisor("aircraft", "new", "--from", CASES / "u_base.ulg", "-o", file)
    assert "The elevator is unknown" in run.stdout
    assert "! The outputs of aileron and rudder are not known." in run.stdout
    assert load_aircraft(file).elevator.output == "auto"


def test_a_file_that_exists_is_written_over_by_force_alone(advisor: Advisor, tmp_path: Path) -> None:
    file = tmp_path / "a.yaml"
    file.write_text("name: mine\n")
    refused = advisor("aircraft", "new", "--from", CASES / "t_base.tlog", "-o", file)
    assert (refused.returncode, file.read_text()) == (2, "name: mine\n")
    assert "--force" in refused.stderr
    assert advisor("aircraft", "new", "--from", CASES / "t_base.tlog", "-o", file, "--force").returncode == 0


def test_a_log_that_is_none_ends_with_code_3(advisor: Advisor, tmp_path: Path) -> None:
    run = advisor("aircraft", "new", "--from", tmp_path / "no.tlog", "-o", tmp_path / "a.yaml")
    assert run.returncode == 3
    assert not (tmp_path / "a.yaml").exists()


@pytest.mark.parametrize("blank", [[], ["--blank"]])
def test_a_file_without_a_log_holds_every_key_as_a_comment(
    advisor: Advisor, tmp_path: Path, blank: list[str]
) -> None:
    advisor("aircraft", "new", *blank, "-o", tmp_path / "a.yaml")
    text = (tmp_path / "a.yaml").read_text()
    assert load_aircraft(tmp_path / "a.yaml") == Aircraft()
    assert [key.path for key in KEYS if f"# {key.path.rpartition('.')[2]}: {key.example}" not in text] == []


def test_elevons_are_found_by_the_parameters_and_both_are_described() -> None:
    left, right = ELEVONS
    scale = Scale(1000.0, 1500.0, 2000.0, reversed=True)
    wiring = Wiring(WORDS, {1: left, 2: right}, {1: scale, 2: scale}, frozenset({1, 2}))
    surface = find_elevator(Elevator(), wiring)
    vehicle = Vehicle(1, 1, "ardupilot", 1)
    facts = LogFacts(vehicle, surface, None, wiring, {1: (1400.0, 1600.0)}, None, None, None, "unknown", ())
    draft = proposed(facts, "a.tlog")
    assert draft.values["elevator.output"] == "auto"
    assert "1000/1500/2000 us, reversed" in draft.comments["elevator.calibration"]
    assert "from 1400 to 1600 us" in draft.comments["elevator.calibration"]
    assert draft.unsure == ["a.tlog has no air speed: write airspeed_m_s, the speed that was flown."]


def test_a_guessed_elevator_is_marked_for_a_check() -> None:
    vehicle, nothing = Vehicle(1, 1, "ardupilot", 1), Wiring(WORDS)
    unknown = find_elevator(Elevator(), nothing)
    guess = Guess(3, 0.6, 0.01)
    facts = LogFacts(vehicle, unknown, guess, nothing, {}, (9.0, 10.0, 11.0), 1e5, None, "unknown", (10.5,))
    draft = proposed(facts, "a.tlog")
    assert (draft.values["elevator.output"], draft.values["reference_airspeed_m_s"]) == (3, 10.5)
    assert draft.comments["elevator.output"].startswith("GUESS")
    assert "1000 hPa" in draft.head[1]


def test_the_next_commands_run_as_they_are_printed(advisor: Advisor, tmp_path: Path) -> None:
    log = tmp_path / "a flight.tlog"
    shutil.copy(CASES / "t_base.tlog", log)
    told = advisor(
        "aircraft", "new", "--from", log, "-o", tmp_path / "my aircraft.yaml", "--target-system", 1
    )
    printed = [shlex.split(line) for line in told.stdout.splitlines() if line.startswith("  advisor ")]
    assert [words[1] for words in printed] == ["aircraft", "doctor"]
    for _, *words in printed:
        assert advisor(*words).returncode == 0
        assert words[-2:] == ["--target-system", "1"]


def test_a_log_tells_the_outputs_of_aileron_and_rudder(advisor: Advisor, tmp_path: Path) -> None:
    file = tmp_path / "a.yaml"
    advisor("aircraft", "new", "--from", CASES / "base.bin", "-o", file)
    aircraft = load_aircraft(file)
    assert (aircraft.aileron.output, aircraft.rudder.output) == (1, 4)
    assert "# Output 1 by SERVOn_MIN/TRIM/MAX: 1100/1500/1900 us." in file.read_text()


def test_a_blank_file_names_the_keys_of_roll_and_yaw_and_their_signs(advisor, tmp_path):
    advisor("aircraft", "new", "--blank", "-o", tmp_path / "a.yaml")
    text = " ".join((tmp_path / "a.yaml").read_text().replace("#", "").split())
    for key in ("aileron: ", "rudder: ", "beta: ", "span_m: ", "ixx_kg_m2: ", "L_delta_a: "):
        assert key in text
    assert "A positive aileron rolls to the left, a positive rudder yaws to the left." in text
