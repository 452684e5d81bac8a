"""Roll and yaw of a user's simulator: its surrogate, what the record loses, and what is refused."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Beta, SideControl
from advisor.flight.signals.record import Channel
from advisor.oem.rows import Signal
from advisor.oem.surface import Servo
from advisor.simulators.axes.side_difference import side_without_difference
from advisor.simulators.fmu import FmuSimulator
from advisor.simulators.protocol import Replay
from advisor.words.problems import UnusableInputError
from tests.gap.axis import test_comparison as flights
from tests.oem.axis import builders
from tests.oem.axis.builders import JET
from tests.simulators.small_fmu import SIDE, build
from tests.simulators.test_fmu import NAMES

KNOWN = SideControl(lag_s=0.0, delay_s=0.0)
AIRCRAFT = Aircraft(aileron=KNOWN, rudder=KNOWN, beta=Beta("none"))
BUMP = 0.02
"""Roll rate that the simulator alone shows for a moment, rad/s."""


@dataclass
class Jet:
    """The jet of the builders as a simulator, with a bump of the roll rate that no linear model has."""

    derivatives: dict
    takes = frozenset({"aileron", "rudder"})
    description = "the jet"
    bump: float = 0.0
    changed: dict = None

    def replay(self, condition, inputs, increments=None):
        moved = {name: Signal(inputs.t, y) for name, y in inputs.others.items() if name in self.takes}
        record = builders.flown(
            self.derivatives, **moved, seconds=8.5, airspeed=condition.airspeed_m_s, initial=(0.0,) * 4
        )
        t = record.outputs["p"].t
        level = {name: record.given[name].at(t) for name in ("alpha", "q", "theta")}
        side = {name: signal.y for name, signal in record.outputs.items()}
        side["p"] = side["p"] + self.bump * np.exp(-(((t - 5.0) / 0.2) ** 2))
        speed = np.full(len(t), condition.airspeed_m_s)
        replay = Replay(t, **level, a_z=-9.81 + 0.0 * t, airspeed_m_s=speed, height_m=0.0 * t, **side)
        return replace(replay, **{name: by(replay) for name, by in (self.changed or {}).items()})


@pytest.fixture(scope="module")
def flight():
    at = np.full(len(flights.T), 500.0)
    height = Channel("altitude", flights.T, at, "GLOBAL_POSITION_INT", "measured")
    return [replace(m, channels={**m.channels, "altitude": height}) for m in flights.maneuvers()]


def test_the_simulators_own_derivatives_become_the_model_of_the_comparison(flight):
    weak = JET | {"L_delta_a": 0.8 * JET["L_delta_a"]}
    beside, aircraft = side_without_difference(flight, Jet(weak), AIRCRAFT)
    for name in ("L_p", "L_delta_a", "N_beta", "N_delta_r"):
        assert aircraft.model[name] == pytest.approx(weak[name], rel=0.01), name
    assert aircraft.simulator == "the jet"
    assert aircraft.aileron.lag_s == 0.0
    for before, after in zip(flight, beside, strict=True):
        assert np.ptp(before.channels["p"].y - after.channels["p"].y) < 1e-3


def test_an_fmu_flies_aileron_and_rudder(flight, tmp_path):
    """Derivatives of ROLL and YAW in ``short_period.c``."""
    names = replace(NAMES, **{name: name for name in SIDE})
    simulator = FmuSimulator(build(tmp_path, 2), names, 15.0)
    try:
        _, aircraft = side_without_difference(flight, simulator, AIRCRAFT)
    finally:
        simulator.close()
    due = {"L_beta": -10.0, "L_p": -5.0, "L_delta_a": -20.0, "N_beta": 6.0, "N_r": -1.0, "N_delta_r": -5.0}
    for name, value in due.items():
        assert aircraft.model[name] == pytest.approx(value, rel=0.02), name


def test_what_the_simulator_does_beyond_a_linear_model_is_taken_off_the_record(flight):
    beside, _ = side_without_difference(flight, Jet(JET, bump=BUMP), AIRCRAFT)
    for before, after in zip(flight, beside, strict=True):
        lost = before.channels["p"].y - after.channels["p"].y
        assert lost[np.argmin(np.abs(flights.T - 5.0))] == pytest.approx(BUMP, rel=0.3)
        assert np.max(np.abs(lost[flights.T < 3.5])) < 0.3 * BUMP


def test_the_files_servo_moves_the_simulators_surfaces(flight):
    late = replace(AIRCRAFT, aileron=SideControl(lag_s=0.0, delay_s=0.5))
    seen = []

    class Watched(Jet):
        def replay(self, condition, inputs, increments=None):
            seen.append(inputs)
            return super().replay(condition, inputs, increments)

    side_without_difference(flight, Watched(JET), late)
    moves = seen[0].t[np.flatnonzero(np.abs(seen[0].others["aileron"]) > 0.01)[0]]
    assert moves == pytest.approx(1.5, abs=0.1)


@pytest.mark.parametrize(
    ("simulator", "words"),
    [
        (Jet(JET, changed={"p": lambda _: None}), "returns no p"),
        (Jet(JET, changed={"a_y": lambda _: None, "beta": lambda _: None}), r"returns no a_y \(or beta\)"),
        (Jet(JET, changed={"p": lambda r: -r.p}), "p with the sign reversed"),
        (Jet(JET, changed={"p": lambda r: np.degrees(r.p)}), "p in deg/s"),
        (Jet(JET, changed={"r": lambda r: -r.r}), "r with the sign reversed"),
        (Jet(JET, changed={"beta": lambda r: -r.beta}), "β with the sign reversed"),
        (Jet(JET, changed={"beta": lambda r: np.degrees(r.beta)}), "β in degrees"),
        (Jet(JET, changed={"bank": lambda r: np.degrees(r.bank)}), "the bank angle in degrees"),
        (Jet(JET | {"L_delta_a": 6.3}), "the aileron the wrong direction: it rolls to the other side"),
        (Jet(JET | {"N_delta_r": 1.6}), "the rudder the wrong direction: it yaws to the other side"),
    ],
)
def test_a_simulator_that_cannot_fly_roll_and_yaw_is_refused_in_one_sentence(flight, simulator, words):
    with pytest.raises(UnusableInputError, match=words) as told:
        side_without_difference(flight[:2], simulator, AIRCRAFT)
    assert "\n" not in told.value.problem.text


def test_a_simulator_that_takes_no_rudder_cannot_fly_a_rudder_test(flight):
    class Without(Jet):
        takes = frozenset({"aileron"})

    with pytest.raises(UnusableInputError, match="takes no rudder"):
        side_without_difference(flight[:2], Without(JET), AIRCRAFT)


def test_the_simulators_own_servo_joins_the_files(flight):
    class Slow(Jet):
        def replay(self, condition, inputs, increments=None):
            fine = np.arange(0.0, inputs.t[-1], 0.005)
            lagged = {
                name: np.interp(inputs.t, fine, Servo(0.12).move(inputs.t, y, fine)[0])
                for name, y in inputs.others.items()
            }
            return super().replay(condition, replace(inputs, others=lagged))

    _, aircraft = side_without_difference(
        flight, Slow(JET), replace(AIRCRAFT, rudder=SideControl(lag_s=0.05, delay_s=0.0))
    )
    assert aircraft.aileron.lag_s == pytest.approx(0.12, abs=0.02)
    assert aircraft.rudder.lag_s == pytest.approx(0.17, abs=0.02)
