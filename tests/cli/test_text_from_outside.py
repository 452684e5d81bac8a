"""What files and vehicles call themselves is shown, never obeyed."""

from pathlib import Path

import pytest

from advisor.flight.maneuvers.maneuver import Notice
from advisor.flight.stream.identity import READER
from advisor.mavlink.logs.formats.telemetry import read_tlog
from advisor.process.yaml_file import read_yaml
from advisor.words.problems import ConfigurationError, Problem, printable
from tests.cli.processes import flight
from tests.conftest import Advisor
from tests.mavlink.builders import START_US, Sender, dialect, record

ESCAPE = "\x1b[31m\x9b1m\x1b]0;pwn\x07"
NAME = f"[bold]{ESCAPE}\n[red]ñ.tlog"
SHOWN = "[bold][31m1m]0;pwn [red]ñ.tlog"


def hostile(folder: Path) -> Path:
    """A good flight under a bad name, whose vehicle says and is named what a terminal would obey."""
    vehicle = Sender()
    texts = [
        f"ArduPlane V4.5.6{ESCAPE} [red]".encode(),
        READER + f"{ESCAPE}[blink] sensor".encode(),
        READER + b"\xff\xfe[/]",
    ]
    said = [dialect.MAVLink_statustext_message(4, text[:50]) for text in texts]
    names = [f"SERVO\x1b[{n}_FUN".encode() for n in range(3)]
    said += [dialect.MAVLink_param_value_message(name, 19.0, 9, 3, 0) for name in names]
    log = folder / NAME
    first = b"".join(record(vehicle.frame(message), START_US) for message in said)
    log.write_bytes(flight().read_bytes()[:3000] + first + flight().read_bytes())
    return log


@pytest.mark.usefixtures("recorded_analyses")
@pytest.mark.parametrize("command", [["analyze"], ["analyze", "--all"], ["doctor"], ["replay"], ["gap"]])
def test_no_control_character_of_a_log_reaches_the_terminal(command, advisor, tmp_path, monkeypatch):
    monkeypatch.setenv("HEADLESS", "1")
    log = hostile(tmp_path)
    assert sum(len(columns) for batch in read_tlog(log) for columns in batch) > 1000
    speed = ["--speed", "max"] if command == ["replay"] else []
    run = advisor(*command, log, *speed)
    for line in (run.stdout + run.stderr).split("\n"):
        assert line.isprintable()
    if command[0] == "analyze":
        assert SHOWN in run.stdout


@pytest.mark.parametrize("command", ["analyze", "doctor", "gap", "replay"])
def test_a_name_in_a_refusal_is_shown_on_one_line(command: str, advisor: Advisor, tmp_path: Path) -> None:
    (tmp_path / NAME).write_bytes(b"no log")
    run = advisor(command, tmp_path / NAME)
    assert run.returncode == 3
    assert run.stderr.count("\n") == 1
    assert run.stderr.rstrip("\n").isprintable()
    assert SHOWN in run.stderr


def test_arguments_in_a_usage_error_are_shown(advisor: Advisor) -> None:
    run = advisor("study", f"b{ESCAPE}")
    assert run.returncode == 2
    assert all(line.isprintable() for line in run.stderr.split("\n"))


def test_escapes_in_a_yaml_file_stay_text(tmp_path: Path) -> None:
    file = tmp_path / "aircraft.yaml"
    file.write_text('name: "\\e[31mred\\n\\u202Etxt ü"\n"\\ekey": 1\n')
    assert read_yaml(file) == {"name": "[31mred\ntxt ü", "key": 1}


def test_every_sentence_can_be_shown() -> None:
    assert str(Problem("code", f"{ESCAPE}a", f"b{ESCAPE}")).isprintable()
    assert str(ConfigurationError(f"a{ESCAPE}")).isprintable()
    assert Notice("code", f"a{ESCAPE}").text.isprintable()


@pytest.mark.parametrize("text", ["M_α −7 ± 0.1", "полёт 飛行 ✈", "[red]", ""])
def test_printable_text_is_left_alone(text: str) -> None:
    assert printable(text) == text


def test_what_is_no_character_is_marked_and_what_has_no_shape_is_left_out() -> None:
    assert printable("a\udcff\u200b\tb\r\n") == "a\ufffd b  "
