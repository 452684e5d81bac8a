"""PX4's elevator is found in its own log, whatever the version of the firmware and the wiring."""

from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.flight.vehicle.px4_wiring import allocation
from advisor.flight.vehicle.surfaces import Surface
from advisor.mavlink.logs.logs import open_log
from tests.heard import hear_log
from tests.mavlink.px4_logs import PX4Log, every, flight, flown, pulses, stick

PLANE = {
    "CA_SV_CS_COUNT": 3,
    "CA_SV_CS0_TYPE": 1,
    "CA_SV_CS1_TYPE": 3,
    "CA_SV_CS1_TRQ_P": 1.0,
    "CA_SV_CS2_TYPE": 4,
    "PWM_MAIN_FUNC1": 201,
    "PWM_MAIN_FUNC4": 202,
    "PWM_MAIN_FUNC3": 101,
    "PWM_MAIN_MIN4": 1000,
    "PWM_MAIN_MAX4": 2000,
}
"""Servo 2 of 3 is the elevator, and output 4 carries it."""
STEP_RAD = np.radians(25.0) * 0.1
"""Deflection of a tenth of full command, as assumed without a calibration."""


def with_outputs(log: PX4Log, outputs: dict[int, object], rate_hz: float = 25.0, multi_id: int = 0) -> PX4Log:
    t = every(rate_hz)
    columns = {n: values(t) if callable(values) else values for n, values in outputs.items()}
    return log.topic("actuator_outputs", t, multi_id, output=pulses(t, columns))


def up(t):
    return 1500.0 + 500.0 * stick(t)


def down(t):
    return 1500.0 - 500.0 * stick(t)


def elevator(path: Path):
    """Outputs of the elevator, and its deflection in the first step, nose up."""
    stream, maneuvers, said = flown(path)
    assert isinstance(stream.elevator, Surface), stream.elevator
    assert not any("The nose moved opposite" in text for text in said)
    (one,) = maneuvers
    channel = one.maneuver.channels["elevator"]
    return stream.elevator.outputs, float(np.interp(20.5, channel.t, channel.y))


def test_the_output_whose_function_carries_the_elevators_servo_is_the_elevator(tmp_path: Path) -> None:
    log = with_outputs(flight(**PLANE), {1: 1500.0, 3: 1700.0, 4: up})
    outputs, first = elevator(log.write(tmp_path))
    assert outputs == (4,)
    assert first == pytest.approx(-STEP_RAD, rel=1e-3)


def test_an_output_of_the_auxiliary_bank_counts_from_17_where_the_main_bank_drives_something(tmp_path):
    wired = {k: v for k, v in PLANE.items() if not k.startswith("PWM_MAIN_FUNC4")} | {"PWM_AUX_FUNC2": 202}
    log = flight(**wired)
    with_outputs(log, {1: down, 3: 1700.0}, multi_id=1)
    with_outputs(log, {2: up}, multi_id=0)
    outputs, _ = elevator(log.write(tmp_path))
    assert outputs == (18,)


def test_a_single_instance_belongs_to_the_bank_whose_outputs_move(tmp_path: Path) -> None:
    wired = {"CA_SV_CS0_TYPE": 3, "CA_SV_CS0_TRQ_P": 1.0, "PWM_MAIN_FUNC1": 101, "PWM_AUX_FUNC2": 201}
    assert elevator(with_outputs(flight(**wired), {2: up}).write(tmp_path))[0] == (18,)


@pytest.mark.parametrize("said", [{"PWM_MAIN_REV": 0b1000}, {"CA_SV_CS1_TRQ_P": -1.0}])
def test_a_reversed_output_and_a_surface_that_lowers_the_nose_count_the_other_way(tmp_path, said) -> None:
    log = with_outputs(flight(**PLANE | said), {1: 1500.0, 4: down})
    assert elevator(log.write(tmp_path))[1] == pytest.approx(-STEP_RAD, rel=1e-3)


def test_elevons_are_read_together_and_their_roll_cancels(tmp_path: Path) -> None:
    wired = {
        "CA_SV_CS_COUNT": 2, "CA_SV_CS0_TYPE": 5, "CA_SV_CS1_TYPE": 6,
        "CA_SV_CS0_TRQ_P": 0.5, "CA_SV_CS1_TRQ_P": 0.5, "PWM_MAIN_FUNC1": 201, "PWM_MAIN_FUNC2": 202,
    }  # fmt: skip
    roll = lambda t: 40.0 * np.sin(3.0 * t)  # noqa: E731
    log = with_outputs(flight(**wired), {1: lambda t: up(t) + roll(t), 2: lambda t: up(t) - roll(t)})
    outputs, first = elevator(log.write(tmp_path))
    assert outputs == (1, 2)
    assert first == pytest.approx(-STEP_RAD, rel=1e-3)


def test_ailerons_that_move_in_opposite_directions_make_one_surface(tmp_path: Path) -> None:
    ailerons = {"CA_SV_CS0_TRQ_R": -0.5, "CA_SV_CS2_TYPE": 2, "CA_SV_CS2_TRQ_R": 0.5, "PWM_MAIN_FUNC2": 203}
    roll = lambda t: 100.0 * np.sin(t)  # noqa: E731
    moved = {1: lambda t: 1500 - roll(t), 2: lambda t: 1500 + roll(t), 4: up}
    _, (one,), _ = flown(with_outputs(flight(**PLANE | ailerons), moved).write(tmp_path))
    aileron = one.maneuver.channels["aileron"]
    assert np.ptp(aileron.y) == pytest.approx(2 * np.radians(25.0) * 0.2, rel=0.02)


@pytest.mark.parametrize(("left", "right", "pair"), [(7, 8, "V-tail"), (13, 14, "A-tail")])
def test_the_halves_of_a_tail_are_read_together(tmp_path: Path, left: int, right: int, pair: str) -> None:
    wired = {
        "CA_SV_CS0_TYPE": 1, "CA_SV_CS1_TYPE": left, "CA_SV_CS2_TYPE": right,
        "CA_SV_CS1_TRQ_P": 0.5, "CA_SV_CS2_TRQ_P": 0.5, "PWM_MAIN_FUNC5": 202, "PWM_MAIN_FUNC6": 203,
    }  # fmt: skip
    log = with_outputs(flight(**wired), {1: 1500.0, 5: up, 6: up})
    stream, _, _ = flown(log.write(tmp_path))
    assert stream.elevator.outputs == (5, 6)
    assert pair in stream.elevator.said


@pytest.mark.parametrize("reverse", [0, 0b1000])
def test_servo_commands_stand_in_where_the_outputs_are_slower(tmp_path: Path, reverse: int) -> None:
    log = with_outputs(flight(**PLANE, PWM_MAIN_REV=reverse), {4: down if reverse else up}, rate_hz=5.0)
    t = every(50.0)
    control = np.zeros((len(t), 8))
    control[:, 1] = stick(t)
    log.topic("actuator_servos", t, control=control)
    path = log.write(tmp_path)
    outputs, first = elevator(path)
    assert outputs == (4,)
    assert first == pytest.approx(-STEP_RAD, rel=1e-3)
    assert flown(path)[0].channels["elevator"].rate_hz == pytest.approx(50.0, rel=0.01)


def test_the_torque_set_point_gives_the_surfaces_commands_where_the_outputs_are_slower(tmp_path):
    """PX4's default topics: outputs and servos at 10 Hz, torque at 50 Hz, and no torque of the surfaces."""
    wired = {key: value for key, value in PLANE.items() if not key.endswith("TRQ_P")}
    log = with_outputs(flight(**wired), {4: up}, rate_hz=10.0)
    path = commanded(log, "vehicle_torque_setpoint", 50.0).write(tmp_path)
    outputs, first = elevator(path)
    assert (outputs, first) == ((4,), pytest.approx(-STEP_RAD, rel=1e-3))
    stream, (one,), said = flown(path)
    assert stream.channels["elevator"].rate_hz == pytest.approx(50.0, rel=0.01)
    aileron = one.maneuver.channels["aileron"]
    commands = np.radians(25.0) * 0.2 * np.sin(2.0 * aileron.t)
    assert aileron.y == pytest.approx(-commands, abs=np.radians(0.1))
    assert any("computed from vehicle_torque_setpoint at 50 Hz" in text for text in said)


def test_the_commands_are_the_pseudo_inverse_of_the_torques():
    """Elevons of unequal reach, whose torques return the set point."""
    rows = {0: (-0.4, 0.5), 1: (0.6, 0.3)}
    stated = {f"CA_SV_CS{n}_TYPE": 5.0 + n for n in rows} | {
        f"CA_SV_CS{n}_TRQ_{axis}": value
        for n, row in rows.items()
        for axis, value in zip("RP", row, strict=True)
    }
    commands = allocation(stated | {"CA_SV_CS_COUNT": 2.0})
    set_point = np.array([0.2, -0.1, 0.0])
    servos = {n: float(np.dot(gains, set_point)) for n, gains in commands.items()}
    torque = [sum(rows[n][k] * servos[n] for n in rows) for k in (0, 1)]
    assert torque == pytest.approx([0.2, -0.1])


def test_servo_commands_suffice_without_any_output(tmp_path: Path) -> None:
    t = every(50.0)
    control = np.zeros((len(t), 8))
    control[:, 1] = stick(t)
    log = flight(CA_SV_CS_COUNT=2, CA_SV_CS0_TYPE=1, CA_SV_CS1_TYPE=3)
    log.topic("actuator_servos", t, control=control)
    assert elevator(log.write(tmp_path)) == ((2,), pytest.approx(-STEP_RAD, rel=1e-3))


def test_an_infinite_servo_command_counts_as_no_pulse(tmp_path: Path) -> None:
    t = every(50.0)
    control = np.zeros((len(t), 8))
    control[:, 1] = stick(t)
    control[300, 1] = np.inf
    log = flight(CA_SV_CS_COUNT=2, CA_SV_CS0_TYPE=1, CA_SV_CS1_TYPE=3)
    path = log.topic("actuator_servos", t, control=control).write(tmp_path)
    (outputs,) = (c for batch in open_log(path) for c in batch if c.name == "SERVO_OUTPUT_RAW")
    assert np.flatnonzero(~(outputs.fields["servo2_raw"] > 0.0)).tolist() == [300]


def commanded(log: PX4Log, topic: str, rate_hz: float) -> PX4Log:
    """The commands of roll, pitch, yaw and throttle."""
    t = every(rate_hz, 0.002)
    axes = [0.2 * np.sin(2.0 * t), stick(t), 0.05 * np.cos(t), 0.5 + 0.1 * np.sin(0.3 * t)]
    if topic == "actuator_controls_0":
        return log.topic(topic, t, control=np.column_stack([*axes, np.zeros((len(t), 4))]))
    return log.topic(topic, t, xyz=np.column_stack(axes[:3]))


@pytest.mark.parametrize("topic", ["actuator_controls_0", "vehicle_torque_setpoint"])
@pytest.mark.parametrize(("follows", "first"), [(up, -STEP_RAD), (down, -STEP_RAD)])
def test_without_parameters_the_output_that_follows_the_pitch_command_is_a_guess(
    tmp_path, topic, follows, first
) -> None:
    moved = {1: lambda t: 1500 + 80 * np.sin(2.0 * t), 3: follows, 4: lambda t: 1500 + 20 * np.cos(t)}
    log = commanded(with_outputs(flight(), moved), topic, 20.0)
    path = log.write(tmp_path)
    assert elevator(path) == ((3,), pytest.approx(first, rel=0.05))
    assert any(
        "output 3 (a guess, because this output follows the pitch command)" in text for text in flown(path)[2]
    )


def test_mixed_elevons_of_an_old_firmware_both_follow_the_pitch_command(tmp_path: Path) -> None:
    roll = lambda t: 80.0 * np.sin(2.0 * t)  # noqa: E731
    log = with_outputs(flight(), {1: lambda t: up(t) + roll(t), 2: lambda t: down(t) + roll(t)})
    outputs, first = elevator(commanded(log, "actuator_controls_0", 20.0).write(tmp_path))
    assert outputs == (1, 2)
    assert first == pytest.approx(-STEP_RAD, rel=0.05)


def test_the_pitch_command_stands_for_the_elevator_where_no_output_is_as_fast(tmp_path: Path) -> None:
    path = commanded(with_outputs(flight(), {3: down}, 5.0), "actuator_controls_0", 50.0).write(tmp_path)
    _, first = elevator(path)
    stream, _, said = flown(path)
    assert first == pytest.approx(-STEP_RAD, rel=1e-3)
    assert stream.channels["elevator"].rate_hz == pytest.approx(50.0, rel=0.01)
    assert any("the pitch command, which replaces the elevator" in text for text in said)


def test_an_instance_in_which_nothing_moves_is_not_counted(tmp_path: Path) -> None:
    log = flight()
    for idle in (0, 1):
        with_outputs(log, dict.fromkeys(range(1, 5), 1000.0), multi_id=idle)
    with_outputs(log, {2: up, 3: lambda t: 1500 + 100 * np.sin(t)}, multi_id=2)
    calibration = ((1000.0, 25.0), (2000.0, -25.0))
    aircraft = Aircraft(elevator=Elevator(output=2, calibration=calibration))
    stream, maneuvers, _ = flown(log.write(tmp_path), aircraft)
    assert len(maneuvers) == 1
    assert stream.channels["elevator"].rate_hz == pytest.approx(25.0, rel=0.01)


def test_a_log_that_tells_nothing_of_the_elevator_is_mended_in_words_of_px4(tmp_path: Path) -> None:
    stream, _, _ = flown(with_outputs(flight(), {2: up}).write(tmp_path))
    said = str(stream.problems()[0])
    assert "CA_SV_CSn_TYPE" in said
    assert "SERVO" not in said
    assert "ArduP" not in said


@pytest.mark.parametrize("row", [slice(300, 301), slice(None)])
def test_an_infinite_output_counts_as_no_pulse_and_breaks_no_guess(tmp_path: Path, row: slice) -> None:
    def infinite(t):
        values = up(t)
        values[row] = np.inf
        return values

    path = with_outputs(flight(), {2: infinite, 3: up}).write(tmp_path)
    (outputs,) = (c for batch in open_log(path) for c in batch if c.name == "SERVO_OUTPUT_RAW")
    assert not np.isinf(outputs.fields["servo2_raw"]).any()
    hear_log(path)
