"""A word that is nearly right is answered with the right one."""

import click
import pytest
from click.testing import CliRunner

from advisor.aircraft_file.read import parse_aircraft
from advisor.cli import screen
from advisor.cli.group import advisor
from advisor.words.problems import ConfigurationError


@pytest.mark.parametrize(
    ("typed", "meant"), [("analyse", "analyze"), ("anlyze", "analyze"), ("dokter", "doctor")]
)
def test_a_command_that_is_nearly_right_is_guessed(typed: str, meant: str) -> None:
    result = CliRunner().invoke(advisor, [typed, "x.tlog"], standalone_mode=False)
    assert isinstance(result.exception, click.UsageError)
    assert result.exception.message == f"No such command '{typed}': did you mean {meant}?"


def test_a_connection_without_its_option_is_answered_with_the_option() -> None:
    result = CliRunner().invoke(advisor, ["live", "udpin:0.0.0.0:14550"], standalone_mode=False)
    assert str(result.exception) == (
        "Name the connection by its option: advisor live --master udpin:0.0.0.0:14550"
    )


def test_a_log_on_a_live_link_is_answered_with_the_way_to_continue() -> None:
    result = CliRunner().invoke(advisor, ["live", "flight.tlog"], standalone_mode=False)
    assert str(result.exception).startswith("LOG needs --resume")


def test_a_command_that_resembles_none_gets_no_guess() -> None:
    result = CliRunner().invoke(advisor, ["xyzzy"], standalone_mode=False)
    assert "did you mean" not in str(result.exception)


@pytest.mark.parametrize(
    ("content", "meant"),
    [
        ({"reference": {"mass": 3.0}}, "reference.mass: unknown key (did you mean mass_kg?)"),
        ({"elevator": {"lag": 0.1}}, "elevator.lag: unknown key (did you mean lag_s?)"),
        ({"airspeed": 20.0}, "airspeed: unknown key (did you mean airspeed_m_s?)"),
        ({"elevator": {"mass_kg": 3.0}}, "elevator.mass_kg: unknown key (did you mean reference.mass_kg?)"),
    ],
)
def test_a_key_that_is_nearly_right_is_guessed_in_its_own_section(content: object, meant: str) -> None:
    with pytest.raises(ConfigurationError) as caught:
        parse_aircraft(content)
    assert meant in str(caught.value)


@pytest.mark.parametrize(
    ("term", "headless", "tty_out", "tty_err", "lines"),
    [
        ("xterm", "", True, True, False),
        ("dumb", "", True, True, True),
        ("xterm", "1", True, True, True),
        ("xterm", "", True, False, True),
        ("xterm", "", False, True, True),
    ],
)
def test_screens_need_a_terminal_on_both_streams_that_places_a_cursor(
    monkeypatch: pytest.MonkeyPatch, term: str, headless: str, tty_out: bool, tty_err: bool, lines: bool
) -> None:
    monkeypatch.setenv("TERM", term)
    monkeypatch.setenv("HEADLESS", headless)
    for name, is_terminal in (("stdout", tty_out), ("stderr", tty_err)):
        monkeypatch.setattr(f"sys.{name}", type("Stream", (), {"isatty": lambda self, so=is_terminal: so})())
    assert screen.headless() is lines
