"""The steps after a diagnosis are commands that the program takes, and that do what the step says."""

import re
import shlex
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from advisor.cli.live import _page
from advisor.cli.options import LogsAsked
from advisor.flight.maneuvers.marks import Mark
from advisor.report.facts.sizes import short
from advisor.report.gap_document import next_steps
from advisor.report.gap_screen import command_lines
from tests.gap.test_report_screen import diagnosis
from tests.printed import taken

LOGS = ["my flight.tlog", "second.bin"]
FOUND = diagnosis(effects={"transport_delay": {"delay_s": 0.03}})
SAMPLE = Path(__file__).parents[2] / "logs"
OTHERS = ("python:my_module:make", "fmu:plane.fmu", "log:simulated.tlog")


def steps(simulator, aircraft="mine.yaml", options=()):
    put, prove, *_ = next_steps(FOUND, LOGS, aircraft, simulator, options)
    return put.command, prove.command


@pytest.mark.parametrize("simulator", [None, "linear", "jsbsim:c172p", *OTHERS])
@pytest.mark.parametrize("aircraft", [None, "mine.yaml"])
def test_every_step_is_a_command_that_the_advisor_takes_over_one_line_or_several(simulator, aircraft):
    for line in filter(None, steps(simulator, aircraft)):
        assert [str(log) for log in taken(line)["logs"]] == LOGS
        assert taken("\n".join(command_lines(line, 40))) == taken(line)


@pytest.mark.parametrize("simulator", ["jsbsim:c172p", *OTHERS])
def test_the_users_own_simulator_keeps_its_aircraft_file_in_the_proof(simulator):
    assert "--aircraft mine.yaml" in steps(simulator)[1]


@pytest.mark.parametrize("simulator", OTHERS)
def test_a_simulator_that_reads_none_of_our_files_is_offered_none(simulator):
    put, prove = steps(simulator)
    assert put == ""
    assert f"--simulator {simulator}" in prove


def test_jsbsim_gets_its_own_format():
    put, prove = (taken(line) for line in steps("jsbsim:c172p"))
    assert put["exports"] == ("jsbsim:mine-with-transport-delay.xml",)
    assert prove["specification"] == "jsbsim:c172p"


@pytest.mark.parametrize("simulator", [None, "linear", "jsbsim:c172p"])
def test_the_printed_proof_asks_the_same_again_and_flies_the_change(simulator):
    put, prove = (taken(line) for line in steps(simulator))
    assert prove["proving"] == ("",)
    for name in ("logs", "aircraft_file", "specification"):
        assert prove[name] == put[name]


def test_the_proof_names_the_gap_that_stands_above_it():
    assert f"Prove the change: {short(FOUND.gap.after)} again" in next_steps(FOUND, LOGS, "mine.yaml")[1].text


def test_where_nothing_is_to_correct_no_step_follows():
    assert next_steps(replace(FOUND, verdict="none"), LOGS, "mine.yaml") == []


@pytest.mark.parametrize(
    ("simulator", "written", "flies"),
    [
        (None, "out/better.yaml", "--aircraft mine.yaml --prove"),
        ("jsbsim:c172p", "out/better.xml", "--aircraft mine.yaml --simulator jsbsim:c172p --prove"),
    ],
)
def test_after_the_file_is_written_the_next_step_proves_the_change(simulator, written, flies):
    first, *_ = next_steps(FOUND, LOGS, "mine.yaml", simulator, (), written)
    assert first.text.startswith("Prove the change")
    assert first.command == f"advisor gap 'my flight.tlog' second.bin {flies}"
    assert taken(first.command)


def test_a_log_is_read_as_it_was_read_for_the_answer():
    marks = (Mark(12.0, 24.5, from_log_start=True), Mark(100.25, 110.0))
    asked = LogsAsked((Path("a.tlog"),), target_system=7, marks=marks, no_marks=True)
    _, prove = steps(None, options=asked.reading)
    read = taken(prove.replace("'my flight.tlog' second.bin", "a.tlog"))
    assert (read["target_system"], read["no_marks"]) == (7, True)
    assert [(m.start_s, m.end_s, m.from_log_start) for m in read["marks"]] == [
        (12.0, 24.5, True),
        (100.25, 110.0, False),
    ]


def test_the_page_of_a_live_flight_is_a_command():
    sentence = _page([Path("my flight.tlog")], Path("mine.yaml"))
    assert taken(sentence.partition(": ")[2])["logs"] == (Path("my flight.tlog"),)


@pytest.mark.study
def test_the_steps_of_the_sample_flight_run_as_printed_and_remove_the_gap(tmp_path: Path):
    (tmp_path / "logs").symlink_to(SAMPLE)
    words = "advisor gap logs/arduplane-calm.tlog --aircraft logs/arduplane-calm.yaml"
    shown = run(words, tmp_path)
    put, prove = (line for line in printed_commands(shown))
    run(put, tmp_path)
    (said,) = re.findall(r"gap [\d.,]+ → ([\d.]+) times", shown)
    again = run(prove, tmp_path)
    assert re.findall(r"gap [\d.,]+ → ([\d.]+) times", again) == [said]
    assert "Proof on manoeuvres" in again


def printed_commands(shown: str) -> list[str]:
    """Return the commands under the steps, as they stand on the screen."""
    return [
        "advisor " + rest.split("\n2. ")[0].split("\n3. ")[0]
        for rest in shown.partition("Next:")[2].split("\n   advisor ")[1:]
    ]


def run(line: str, folder: Path) -> str:
    """Return what a command line prints, typed in a folder."""
    words = shlex.split(line.replace("\\\n", ""))
    command = [sys.executable, "-m", *words]
    done = subprocess.run(command, cwd=folder, capture_output=True, encoding="utf-8", check=True)
    return done.stdout
