"""The command before a record still moves the servo when the record begins."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.elevator.elevator_guess import turned
from advisor.flight.maneuvers.maneuver import CONTROLS, Maneuver
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axis.problem import AxisProblem, lay_out
from advisor.oem.estimate import Estimate
from advisor.oem.estimator import estimate
from advisor.oem.prepare import signal_of
from advisor.oem.rows import Signal
from advisor.oem.surface import Servo
from tests.flights import TWO, recorded
from tests.gap.axis.test_setting import AILERON
from tests.heard import Heard, hear_log
from tests.oem.builders import UAV
from tests.oem.test_instruments import SPEED, equipped

LAG_S = 0.14
JUST_AFTER_A_STEP_S = 1.02


def _cut() -> Maneuver:
    """A record that begins just after a step of the command, while the servo still moves."""
    return equipped(lag_s=LAG_S, noise=0.01).between(JUST_AFTER_A_STEP_S, 9.0)


def _lag(maneuver: Maneuver) -> float:
    found = estimate(maneuver, Aircraft(airspeed_m_s=SPEED))
    assert isinstance(found, Estimate)
    return next(x.value for x in found.instruments if x.name == "servo_lag_s")


def test_a_record_that_begins_while_the_servo_moves_tells_the_servo() -> None:
    assert _lag(_cut()) == pytest.approx(LAG_S, abs=0.01)


def test_a_record_that_begins_while_the_servo_moves_tells_the_moments() -> None:
    found = estimate(_cut(), Aircraft(airspeed_m_s=SPEED))
    assert isinstance(found, Estimate)
    off = np.abs(found.theta - UAV)[[5, 6, 7]]
    assert np.all(off < 2.5 * found.std[[5, 6, 7]])


def test_without_the_earlier_command_the_servo_is_wrong() -> None:
    assert abs(_lag(replace(_cut(), before={})) - LAG_S) > 0.02


@pytest.fixture(scope="module")
def heard(tmp_path_factory: pytest.TempPathFactory) -> Heard:
    """A recorded flight of two manoeuvres."""
    return hear_log(recorded("linear", 1.0, maneuvers=TWO))


def test_a_record_keeps_the_commands_of_two_seconds_before_it(heard: Heard) -> None:
    (_, maneuver) = heard.maneuvers
    before, record = maneuver.before["elevator"], maneuver.channels["elevator"]
    assert record.t[0] - before.t[0] == pytest.approx(2.0, abs=0.1)  # commands that still move a servo
    assert record.t[0] - before.t[-1] == pytest.approx(1.0 / record.rate_hz, rel=0.3)
    assert maneuver.before.keys() <= set(CONTROLS)


def test_a_reversed_elevator_is_reversed_before_the_record_too(heard: Heard) -> None:
    maneuver = heard.maneuvers[1]
    np.testing.assert_array_equal(turned(maneuver).before["elevator"].y, -maneuver.before["elevator"].y)


def test_a_servo_follows_the_earlier_command_exactly() -> None:
    maneuver, servo = equipped(), Servo(LAG_S)
    cut, whole = maneuver.between(JUST_AFTER_A_STEP_S, 9.0), signal_of(maneuver.channels["elevator"])
    t = cut.channels["elevator"].t
    short = servo.move(*signal_of(cut.command("elevator")), t)[0]
    assert short == pytest.approx(servo.move(*whole, whole.t)[0][-len(t) :], abs=1e-12)


def test_in_roll_and_yaw_the_aileron_begins_where_its_servo_is() -> None:
    aileron = AILERON.inputs["aileron"]
    cut = aileron.t > JUST_AFTER_A_STEP_S
    early, record = (Signal(*(part[at] for part in aileron)) for at in (~cut, cut))
    begun = replace(AILERON, inputs={"aileron": record}, before={"aileron": early})
    first = []
    for one in (begun, replace(AILERON, inputs={"aileron": aileron})):
        laid = lay_out(AxisProblem(LATERAL, (one,), values={("aileron", "lag_s"): LAG_S}))
        first.append(laid.grid.inputs[:, LATERAL.inputs.index("aileron")])
    assert first[0][-1] == pytest.approx(first[1][-1], abs=1e-9)
    assert first[0][0] == pytest.approx(first[1][0], abs=1e-9)
