"""The check of a simulator before its physics."""

import json

import numpy as np
import pytest

from advisor.cli import group as cli
from advisor.simulators.check import check
from advisor.simulators.linear import LinearSimulator
from advisor.simulators.protocol import Condition
from tests.simulators.nonlinear import Nonlinear

MODEL = {"Z_alpha": -2.7, "Z_q": 0.0, "Z_delta_e": -0.15, "M_alpha": -23.0, "M_q": -3.4, "M_delta_e": -29.0}
LEVEL = Condition(25.0, 300.0)


class Turned(Nonlinear):
    """Hands its pitch rate out in degrees per second."""

    def replay(self, condition, inputs, increments=None):
        flown = super().replay(condition, inputs, increments)
        flown.q[:] = np.degrees(flown.q)
        return flown


def make_turned() -> Turned:
    return Turned()


def test_dead_time_lag_and_short_period_are_those_of_the_simulator():
    found = check(Nonlinear(delay_s=0.04, lag_s=0.08), LEVEL)
    # A lag and a dead time share the delay between them, and the simulator's own step of 10 ms adds half of
    # itself.
    assert found.dead_time_s + found.lag_s == pytest.approx(0.125, abs=0.012)
    assert found.dead_time_s == pytest.approx(0.04, abs=0.015)
    assert found.omega_rad_s == pytest.approx(np.sqrt(25.0 + 0.5 * 3.0 + 3.0 * 3.5 - 1.5), rel=0.1)
    assert found.lacks == ("aileron", "mass", "rudder", "throttle", "wind")
    assert found.fault is None


def test_a_linear_simulator_shows_its_own_numbers():
    found = check(LinearSimulator(MODEL), LEVEL)
    for name, value in MODEL.items():
        assert found.derivatives[name] == pytest.approx(value, rel=0.02, abs=0.02)
    assert found.damping == pytest.approx((2.7 + 3.4) / (2.0 * found.omega_rad_s), rel=0.02)
    assert found.a_z_m_s2 == pytest.approx(-9.80665, abs=0.01)


def test_an_elevator_that_pitches_up_trailing_edge_down_is_said():
    found = check(LinearSimulator(MODEL | {"M_delta_e": 29.0, "Z_delta_e": 0.15}), LEVEL)
    assert any("the elevator is reversed, unless it is a canard" in note for note in found.notes)


def said(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, *arguments: object) -> tuple:
    monkeypatch.setattr("sys.argv", ["advisor", "simulator", "check", *map(str, arguments)])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    told = capsys.readouterr()
    return ended.value.code, told.out, told.err


def test_the_command_prints_what_answers_and_what_is_not_taken(capsys, monkeypatch):
    code, out, _ = said(capsys, monkeypatch, "python:tests.simulators.nonlinear:make", "--airspeed", 25)
    assert code == 0
    assert "at rest     a_z -9.79 m/s²" in out
    assert "dead time" in out
    assert "does not take mass: it flies at its own mass" in out


def test_a_wrong_unit_is_exit_code_3_and_one_sentence(capsys, monkeypatch):
    arguments = ("python:tests.simulators.test_check:make_turned", "--airspeed", 25, "--json")
    code, out, err = said(capsys, monkeypatch, *arguments)
    assert code == 3
    assert json.loads(out)["problems"][0]["code"] == "simulator_interface"
    assert "gives q in deg/s. Give the pitch rate in rad/s." in err


def test_without_an_air_speed_the_sentence_says_where_to_give_it(capsys, monkeypatch):
    code, _, err = said(capsys, monkeypatch, "python:tests.simulators.nonlinear:make")
    assert code == 2
    assert "give --airspeed" in err
