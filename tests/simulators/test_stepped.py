"""An environment that only steps, wrapped: trimmed, flown, with increments, in each convention."""

from math import cos, sin

import numpy as np
import pytest

from advisor.simulators.increments import lagging
from advisor.simulators.interface import interface_fault
from advisor.simulators.protocol import Condition, Inputs
from advisor.simulators.stepped import Stepped
from advisor.words.problems import UnusableInputError
from tests.simulators.makeshift import Constant

G = 9.80665
T = 0.005 * (np.arange(600) + 0.5)
DOUBLET = 0.02 * (((T > 0.5) & (T < 1.0)) * 1.0 - ((T > 1.0) & (T < 1.5)) * 1.0)
LEVEL = Condition(25.0, 400.0)


class Glides:
    """A small aircraft, stepped by Euler in ten parts; its servo lags, and its engine balances the drag."""

    def __init__(self, lag_s: float = 0.0, deaf: bool = False) -> None:
        self._lag_s, self._deaf = lag_s, deaf

    def reset(self, speed: float, height: float, alpha: float, theta: float) -> None:
        self.v, self.h, self.alpha, self.theta, self.q, self.surface = speed, height, alpha, theta, 0.0, None

    def step(self, dt, elevator=0.0, throttle=0.5, force=0.0, moment=0.0):
        command = 0.0 if self._deaf else elevator
        self.surface = command if self.surface is None or not self._lag_s else self.surface
        for _ in range(10):
            h = dt / 10.0
            if self._lag_s:
                self.surface += h * (command - self.surface) / self._lag_s
            lift = 0.04 * self.v * (self.alpha + 0.1 * self.surface)
            path = self.theta - self.alpha
            alpha_dot = self.q + G / self.v * cos(path) - lift + force
            q_dot = self.v**2 * (4e-4 - 0.01 * self.alpha - 0.02 * self.surface) - 0.08 * self.v * self.q
            self.v += h * (4.0 * (throttle - 0.3) - 0.001 * self.v**2 - G * sin(path))
            self.h += h * self.v * sin(path)
            self.alpha += h * alpha_dot
            self.theta += h * self.q
            self.q += h * (q_dot + moment)

    def observe(self):
        lift = 0.04 * self.v * (self.alpha + 0.1 * (self.surface or 0.0))
        return {"alpha": self.alpha, "q": self.q, "theta": self.theta, "a_z": -lift * self.v,
                "airspeed": self.v, "height": self.h}  # fmt: skip


def wrapped(**habits: object) -> Stepped:
    return Stepped(Glides(**habits), "Glides", controls=("throttle",), trims_throttle=True, increments=True)


def test_the_trim_search_finds_steady_flight_and_tells_its_controls():
    flown = wrapped().replay(LEVEL, Inputs(T, 0.0 * T))
    assert np.max(np.abs(flown.q)) < 1e-3
    assert np.ptp(flown.airspeed_m_s) < 0.01
    # Lift carries the weight, no moment turns, and thrust balances drag.
    alpha, elevator = np.linalg.solve([[0.04 * 25.0, 0.1], [0.01, 0.02]], [G / 25.0, 4e-4])
    assert flown.alpha[0] == pytest.approx(alpha, abs=2e-3)
    assert flown.trim["elevator"] == pytest.approx(elevator, abs=2e-3)
    assert flown.trim["throttle"] == pytest.approx(0.3 + 0.625 / 4.0, abs=5e-3)
    assert interface_fault(flown) is None


def test_the_inputs_are_departures_from_the_trim():
    flown = wrapped().replay(LEVEL, Inputs(T, DOUBLET))
    assert np.min(flown.q[(flown.t > 0.5) & (flown.t < 1.0)]) < -0.05
    assert np.max(flown.q[(flown.t > 1.0) & (flown.t < 1.5)]) > 0.05
    faster = wrapped().replay(LEVEL, Inputs(T, 0.0 * T, {"throttle": np.full(T.size, 0.2)}))
    assert faster.airspeed_m_s[-1] > 26.0


def test_a_lag_of_the_environment_keeps_its_time_constant():
    small = Inputs(T, np.where(T > 0.5, 0.004, 0.0))
    quick, slow = (wrapped(lag_s=lag).replay(LEVEL, small) for lag in (0.0, 0.1))
    sizes = np.arange(0.05, 0.15, 0.002)
    misses = [np.std(lagging(quick.q, 0.01, size) - slow.q) for size in sizes]
    assert sizes[int(np.argmin(misses))] == pytest.approx(0.1, rel=0.05)


def test_a_moment_added_turns_the_environment_by_that_much():
    plain = wrapped().replay(LEVEL, Inputs(T[:20], 0.0 * T[:20]))
    pushed = wrapped().replay(LEVEL, Inputs(T[:20], 0.0 * T[:20]), Constant(0.0, 0.5))
    assert (pushed.q - plain.q)[4] == pytest.approx(0.5 * 0.04, rel=0.06)


def test_an_environment_whose_elevator_moves_nothing_has_no_trim_and_says_so():
    with pytest.raises(UnusableInputError, match="Glides finds no steady flight at 25 m/s and 400 m"):
        wrapped(deaf=True).replay(LEVEL, Inputs(T, DOUBLET))


def test_an_observation_without_a_needed_quantity_is_named():
    class Blind(Glides):
        def observe(self):
            return {"alpha": self.alpha, "q": self.q}

    with pytest.raises(UnusableInputError, match="observes no theta, a_z"):
        Stepped(Blind(), "Blind").replay(LEVEL, Inputs(T, DOUBLET))


def test_roll_and_yaw_are_handed_out_where_the_environment_observes_them():
    class Rolls(Glides):
        def observe(self):
            return {**super().observe(), "p": 2.0 * self.q, "a_y": 0.5}

    flown = Stepped(Rolls(), "Rolls").replay(LEVEL, Inputs(T, DOUBLET))
    assert flown.p == pytest.approx(2.0 * flown.q)
    assert np.all(flown.a_y == 0.5)
    assert flown.r is None


class OfThrottle(Glides):
    """Steps with a throttle that has no default."""

    def step(self, dt, elevator, throttle):
        super().step(dt, elevator, throttle)


def test_a_control_that_is_named_is_sent_also_where_the_flight_did_not_log_it():
    flown = Stepped(OfThrottle(), controls=("throttle",)).replay(LEVEL, Inputs(T, DOUBLET))
    assert np.ptp(flown.q) > 0.0


@pytest.mark.parametrize(
    ("environment", "controls", "words"),
    [
        (OfThrottle(), (), r"step\(\) missing a required argument: 'throttle'"),
        (Glides(), ("aileron",), r"step\(\) got an unexpected keyword argument 'aileron'"),
    ],
)
def test_arguments_that_step_does_not_take_are_named_before_the_flight(environment, controls, words):
    with pytest.raises(UnusableInputError, match=words):
        Stepped(environment, controls=controls).replay(LEVEL, Inputs(T, DOUBLET))


def test_an_observation_that_is_no_number_is_named():
    class Blind(Glides):
        def observe(self):
            return super().observe() | {"q": np.nan}

    with pytest.raises(UnusableInputError, match="observes q as nan at the start of the flight"):
        Stepped(Blind()).replay(LEVEL, Inputs(T, DOUBLET))
