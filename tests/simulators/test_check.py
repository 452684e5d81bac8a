"""The check of a simulator before its physics."""

import json
from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.linalg import expm

from advisor.aircraft.aircraft import Aircraft
from advisor.cli import group as cli
from advisor.simulators.check import check
from advisor.simulators.linear import LinearSimulator
from advisor.simulators.protocol import Condition, Replay
from advisor.words.problems import UnusableInputError
from tests.simulators.makeshift import Level
from tests.simulators.nonlinear import Nonlinear

MODEL = {"Z_alpha": -2.7, "Z_q": 0.0, "Z_delta_e": -0.15, "M_alpha": -23.0, "M_q": -3.4, "M_delta_e": -29.0}
LEVEL = Condition(25.0, 300.0)


@dataclass(frozen=True)
class Stepped:
    """A linear simulator with its own step, which holds the elevator and states the force after its edge."""

    step_s: float
    takes: frozenset[str] = frozenset()
    takes_increments: bool = False
    description: str = "a linear simulator"
    speed_limit_s: float = np.inf

    def replay(self, condition, inputs, increments=None):
        h, speed = self.step_s, condition.airspeed_m_s
        a = np.array([[MODEL["Z_alpha"], 1.0 + MODEL["Z_q"]], [MODEL["M_alpha"], MODEL["M_q"]]])
        b = np.array([MODEL["Z_delta_e"], MODEL["M_delta_e"]])
        joined = np.zeros((3, 3))
        joined[:2, :2], joined[:2, 2] = a, b
        stepped = expm(joined * h)
        t = np.arange(round(inputs.t[-1] / h) + 1) * h
        u = np.interp(t + 0.5 * h, inputs.t, inputs.elevator)
        x, theta, rows = np.zeros(2), 0.0, []
        for deflection in u:
            force = MODEL["Z_alpha"] * x[0] + MODEL["Z_q"] * x[1] + MODEL["Z_delta_e"] * deflection
            rows.append((*x, theta, speed * force - 9.80665))
            after = stepped[:2, :2] @ x + stepped[:2, 2] * deflection
            theta, x = theta + 0.5 * h * (x[1] + after[1]), after
        alpha, q, attitude, a_z = np.array(rows).T
        still = np.full(len(t), speed)
        return Replay(t, alpha, q, attitude, a_z, still, np.full(len(t), condition.height_m))

    def linearise(self, condition):
        """Hand nothing out."""

    def close(self):
        """Do nothing: no process runs."""


class Turned(Nonlinear):
    """Hands its pitch rate out in degrees per second."""

    def replay(self, condition, inputs, increments=None):
        flown = super().replay(condition, inputs, increments)
        flown.q[:] = np.degrees(flown.q)
        return flown


def make_turned() -> Turned:
    return Turned()


def test_dead_time_lag_and_short_period_are_those_of_the_simulator():
    found = check(Nonlinear(delay_s=0.04, lag_s=0.08), LEVEL, Aircraft())
    # A lag and a dead time share the delay between them, and the simulator's own step of 10 ms adds half of
    # itself.
    assert found.dead_time_s + found.lag_s == pytest.approx(0.125, abs=0.012)
    assert found.dead_time_s == pytest.approx(0.04, abs=0.015)
    assert found.omega_rad_s == pytest.approx(np.sqrt(25.0 + 0.5 * 3.0 + 3.0 * 3.5 - 1.5), rel=0.1)
    assert found.lacks == ("aileron", "mass", "rudder", "throttle", "wind")
    assert found.fault is None


def test_a_linear_simulator_shows_its_own_numbers():
    found = check(LinearSimulator(MODEL), LEVEL, Aircraft())
    for name, value in MODEL.items():
        assert found.derivatives[name] == pytest.approx(value, rel=1e-3, abs=1e-4)
    assert found.damping == pytest.approx((2.7 + 3.4) / (2.0 * found.omega_rad_s), rel=0.02)
    assert found.a_z_m_s2 == pytest.approx(-9.80665, abs=0.01)


@pytest.mark.parametrize("step_s", [0.005, 0.02])
def test_a_simulator_with_its_own_step_shows_its_numbers_to_a_thousandth(step_s):
    found = check(Stepped(step_s), LEVEL, Aircraft())
    for name, value in MODEL.items():
        assert found.derivatives[name] == pytest.approx(value, rel=1e-3, abs=1e-4)
        assert found.std[name] < 1e-3
    assert found.lag_s == pytest.approx(0.0, abs=1e-4)


def test_the_interval_of_a_simulator_with_curves_contains_its_slope_in_trim():
    found = check(Nonlinear(), LEVEL, Aircraft())
    # q̇ = -25 α - 3 q - 30 δ - 0.5 α̇, with α̇ = (1 + Z_q) q - 3 α - 0.1 δ.
    for name, slope in {"Z_alpha": -3.0, "M_alpha": -23.5, "M_q": -3.5, "M_delta_e": -29.95}.items():
        assert found.derivatives[name] == pytest.approx(slope, rel=0.03)
        assert 0.0 < found.std[name] < 0.1 * abs(slope)


def test_a_simulator_with_play_is_said_to_answer_out_of_proportion():
    found = check(Nonlinear(half_play_rad=0.004), LEVEL, Aircraft())
    assert any("not proportional" in note for note in found.notes)


def test_an_elevator_that_pitches_up_trailing_edge_down_is_a_fault():
    found = check(LinearSimulator(MODEL | {"M_delta_e": 29.0, "Z_delta_e": 0.15}), LEVEL, Aircraft())
    assert found.fault is not None
    assert "the wrong direction: it pitches up" in found.fault.observed


def test_an_elevator_in_degrees_is_a_fault():
    weak = {name: value / np.degrees(1.0) for name, value in MODEL.items() if name.endswith("delta_e")}
    found = check(LinearSimulator(MODEL | weak), LEVEL, Aircraft())
    assert found.fault is not None
    assert "It expects degrees" in found.fault.fix


def test_a_simulator_that_stands_still_is_refused():
    with pytest.raises(UnusableInputError, match="does not move: through a 3-2-1-1"):
        check(Level(), LEVEL, Aircraft())


@dataclass(frozen=True)
class Rolls(Nonlinear):
    """Flies pitch, and roll by the aileron with L_p = -4 and L_δa = -20; ``sense`` turns the aileron."""

    takes: frozenset[str] = frozenset({"aileron"})
    sense: float = 1.0

    def replay(self, condition, inputs, increments=None):
        flown = super().replay(condition, inputs, increments)
        aileron = np.interp(flown.t, inputs.t, inputs.others.get("aileron", np.zeros(inputs.t.size)))
        p, bank = np.zeros(flown.t.size), np.zeros(flown.t.size)
        for k, h in enumerate(np.diff(flown.t)):
            p[k + 1] = p[k] + h * (-4.0 * p[k] - 20.0 * self.sense * aileron[k])
            bank[k + 1] = bank[k] + 0.5 * h * (p[k] + p[k + 1])
        still = np.zeros(flown.t.size)
        return replace(flown, p=p, bank=bank, r=still, beta=still)


def test_the_aileron_is_flown_and_its_roll_is_known():
    found = check(Rolls(), LEVEL, Aircraft())
    assert found.fault is None
    assert found.side["L_delta_a"] == pytest.approx(-20.0, rel=0.05)


def test_an_aileron_that_rolls_to_the_other_side_is_a_fault():
    found = check(Rolls(sense=-1.0), LEVEL, Aircraft())
    assert found.fault is not None
    assert "it rolls to the other side" in found.fault.observed


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
    assert "does not take mass: the simulator flies at its own mass" in out


def test_the_check_says_which_effects_of_the_file_it_leaves_out(capsys, monkeypatch, tmp_path):
    """Advisor gap flies the simulator with the file's servo and effects, so that its motion is later."""
    file = tmp_path / "mine.yaml"
    file.write_text("airspeed_m_s: 25\nelevator: {lag_s: 0.1}\neffects: {transport_delay: {delay_s: 0.06}}\n")
    arguments = ("python:tests.simulators.nonlinear:make", "--aircraft", file)
    code, out, _ = said(capsys, monkeypatch, *arguments)
    assert code == 0
    assert (
        "It leaves out the parts that advisor gap adds from the aircraft file: servo lag, transport delay."
        in out
    )


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
