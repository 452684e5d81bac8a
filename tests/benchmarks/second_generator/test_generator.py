"""The second generator of flights: its physics, its records, and that no file gives an answer away."""

import json
import os
import struct
from dataclasses import replace
from pathlib import Path

os.environ.setdefault("MAVLINK20", "1")

import numpy as np
import pytest
import yaml
from pymavlink.dialects.v20 import ardupilotmega as mavlink

import benchmarks.second_generator
from benchmarks.second_generator.aircraft import FLEET, Aircraft
from benchmarks.second_generator.atmosphere import from_upward
from benchmarks.second_generator.cases import aircraft_file, cases, log_bytes, truth
from benchmarks.second_generator.catalogue import EFFECTS, NAMED, OUTSIDE
from benchmarks.second_generator.design import Assignment, assignments
from benchmarks.second_generator.draw import Case, draw_case, suitable_experiment
from benchmarks.second_generator.effects import BLOCKS, Experiment
from benchmarks.second_generator.equipment import draw_noise, draw_wiring
from benchmarks.second_generator.flight import Truth
from benchmarks.second_generator.flight_model import plain_model
from benchmarks.second_generator.kernel import Floats
from benchmarks.second_generator.motion import (
    GRAVITY,
    HEIGHT,
    STATES,
    STILL_AIR,
    THETA,
    Q,
    U,
    W,
    advance,
    derivatives,
)
from benchmarks.second_generator.planning import Wishes
from benchmarks.second_generator.telemetry import Noise
from benchmarks.second_generator.trim import level_state, linearised, trimmed
from benchmarks.second_generator.visibility import (
    NAMED_RATIO,
    OUTSIDE_RATIO,
    Flown,
    fly_experiment,
    flyable,
    ratios,
    sized,
)
from sim.sealed.cases import write_set
from sim.sealed.judge import judge

# The two flights that most tests look at are flown once.
pytestmark = pytest.mark.xdist_group("second generator")

HEIGHT_M = 100.0
SOURCES = sorted(Path(benchmarks.second_generator.__file__).parent.glob("*.py"))
STEP_S = 0.002


def test_it_imports_nothing_of_the_diagnosis_and_of_the_simulator_only_the_protocol():
    lines = [line for path in SOURCES for line in path.read_text(encoding="utf-8").splitlines()]
    imported = [line.split()[1] for line in lines if line.startswith(("import ", "from "))]
    assert len(imported) > 50
    # Of the advisor only what keeps compiled functions on disk.
    ours = {name for name in imported if name.split(".")[0] in ("advisor", "benchmarks", "sim")}
    shared = {"benchmarks.sealed", "benchmarks.sealed.generator", "benchmarks.sealed.tlog"}
    assert ours == {"advisor.process.compiled", "sim.sealed.cases", *shared}


@pytest.fixture(scope="module")
def quiet_case() -> Case:
    """Return a case without a gap, in still air."""
    for index in range(1, 20):
        case = draw_case(Assignment("none"), 3, index)
        if not case.troubles and case.recorder.low_pass is None:
            return case
    raise AssertionError("no clean case in twenty")


@pytest.fixture(scope="module")
def busy_flight() -> tuple[Experiment, Flown, Noise]:
    """Return a low flight with changing speed and power, so that every effect is visible."""
    rng = np.random.default_rng(4)
    wishes = Wishes(speed_share=0.15, power_share=0.4, low=True)
    case = suitable_experiment(wishes, True, draw_wiring(rng), seed=2)
    return case, fly_experiment(case, 1), draw_noise(rng, coloured=False)


@pytest.mark.parametrize("aircraft", FLEET, ids=lambda aircraft: aircraft.name)
def test_trim_is_an_equilibrium(aircraft: Aircraft) -> None:
    model = trimmed(plain_model(aircraft), HEIGHT_M)
    slope = np.zeros(STATES)
    state = level_state(model, model.airspeed, model.alpha, HEIGHT_M)
    derivatives(state, 0.0, model.elevator, model.thrust, STILL_AIR, 0.0, model, slope)
    assert np.max(np.abs(slope[[U, W, Q, THETA, HEIGHT]])) < 1e-6
    assert abs(np.degrees(model.alpha)) < 8.0
    assert abs(np.degrees(model.elevator)) < 8.0


def test_a_tail_that_meets_rising_air_later_than_the_wing_lifts_the_nose():
    time = np.arange(0.0, 4.0, STEP_S)
    air = from_upward(0.5 * np.maximum(time - 1.0, 0.0), STEP_S, 20.0, 2.0)
    felt = plain_model(FLEET[0]).cm_q * air.pitching
    # The tail's angle of attack is behind the wing's by the gradient along the path.
    assert np.all(felt[time > 1.1] > 0.0)
    assert air.pitching[-1] == pytest.approx(-0.5 / 20.0, rel=1e-3)


def pulse_response(aircraft: Aircraft) -> tuple[Floats, Floats, Floats, Floats]:
    """Return alpha and q off trim after a small pulse, by the nonlinear motion and by the linear model."""
    model = trimmed(plain_model(aircraft), HEIGHT_M)
    linear = linearised(model, HEIGHT_M)
    # Later the speed has changed, which the short period's linear model leaves out.
    count = round(3.0 / linear.natural_frequency / STEP_S)
    pulse = np.zeros(count)
    pulse[: count // 2] = np.radians(0.2)
    state = level_state(model, model.airspeed, model.alpha, HEIGHT_M)
    slopes, flown = np.zeros((4, STATES)), np.zeros((2, count))
    for k in range(count):
        flown[:, k] = np.arctan2(state[W], state[U]) - model.alpha, state[Q]
        elevator = model.elevator + pulse[k]
        advance(state, 0.0, STEP_S, (elevator, elevator), model.thrust, STILL_AIR, 0.0, model, slopes)
    return (*flown, *linear.response(pulse, STEP_S))


@pytest.mark.parametrize("aircraft", FLEET, ids=lambda aircraft: aircraft.name)
def test_linear_model_predicts_a_small_pulse(aircraft: Aircraft) -> None:
    alpha, rate, linear_alpha, linear_rate = pulse_response(aircraft)
    assert np.max(np.abs(alpha - linear_alpha)) < 0.03 * np.max(np.abs(alpha))
    assert np.max(np.abs(rate - linear_rate)) < 0.03 * np.max(np.abs(rate))


def test_the_true_derivatives_are_those_of_the_air_that_is_flown_through() -> None:
    """The pitch acceleration of a flight 80 m below the trim gives M_alpha within a fifth of a per cent."""
    assignment = assignments(67, 30130001, "none")[5]
    case = draw_case(assignment, 30130001, 6, 0.3)
    flown, speed = case.flown.truth, case.experiment.aircraft.airspeed_m_s
    part = np.concatenate([np.arange(s.start, s.stop) for s in case.experiment.plan.during_maneuvers()])
    ratio = flown.airspeed[part] / speed
    by = [ratio * flown.alpha[part], flown.q[part], ratio * flown.elevator[part], ratio, 1.0 / ratio]
    slopes = np.linalg.lstsq(np.array(by).T, flown.q_dot[part] / ratio, rcond=None)[0]
    assert slopes[0] == pytest.approx(truth(case)["linear_model"]["M_alpha"], rel=2e-3)


def test_kinematics_hold_in_still_air(quiet_case: Case) -> None:
    truth: Truth = quiet_case.flown.truth
    step = quiet_case.experiment.plan.step
    expected = (
        truth.q
        + (
            truth.a_z * np.cos(truth.alpha)
            - truth.a_x * np.sin(truth.alpha)
            + GRAVITY * np.cos(truth.theta - truth.alpha)
        )
        / truth.airspeed
    )
    # A step of the elevator changes the accelerations at once: a central difference straddles it.
    error = np.abs(np.gradient(truth.alpha, step) - expected)
    assert np.percentile(error, 99.0) < 0.01 * np.max(np.abs(expected))


def test_a_case_is_the_same_to_the_byte_when_drawn_twice() -> None:
    assignment = Assignment("outside", (EFFECTS["vane_spikes"],))
    first, second = (draw_case(assignment, 5, 2) for _ in range(2))
    assert log_bytes(first) == log_bytes(second)
    assert aircraft_file(first) == aircraft_file(second)
    assert json.dumps(truth(first)) == json.dumps(truth(second))


def test_stored_ratio_is_the_difference_with_and_without_the_effect() -> None:
    case = draw_case(Assignment("one", (EFFECTS["pitch_rate_scale"],)), 6, 1)
    stored = case.effects[0]
    gyro = replace(case.experiment.instruments.gyro, scale=0.0)
    without = replace(case.experiment, instruments=replace(case.experiment.instruments, gyro=gyro))
    plain = fly_experiment(without, case.record_seed)
    measured = ratios(without, case.flown, plain, case.noise, without_means=True)
    assert measured == pytest.approx(stored.dynamic_ratios)
    # This effect's ratio is also known in closed form: its scale times the true pitch rate.
    parts = [case.flown.truth.q[part] for part in case.experiment.plan.during_maneuvers()]
    spread = np.sqrt(np.mean(np.concatenate([part - np.mean(part) for part in parts]) ** 2))
    expected = abs(float(stored.parameters["scale"])) * spread / case.noise.q
    assert stored.dynamic_ratios["q"] == pytest.approx(expected, rel=1e-6)


@pytest.mark.study
@pytest.mark.parametrize("name", EFFECTS)
def test_every_effect_flies_and_is_seen(name: str, busy_flight: tuple[Experiment, Flown, Noise]) -> None:
    effect, (plain, flown, noise) = EFFECTS[name], busy_flight
    assert effect.block in BLOCKS
    wanted = NAMED_RATIO if effect in NAMED else OUTSIDE_RATIO
    changed, fitted = sized(plain, flown, effect, noise, wanted, seed=7, sensor_seed=1)
    assert flyable(changed, fly_experiment(changed, 1))
    assert not effect.dynamic or fitted.largest_dynamic_ratio >= wanted


def test_catalogue_is_complete() -> None:
    assert len({effect.name for effect in NAMED}) == 30
    assert len({effect.name for effect in OUTSIDE}) >= 22
    assert {effect.block for effect in OUTSIDE} == set(BLOCKS)


def test_set_has_its_quotas() -> None:
    kinds = [assignment.kind for assignment in assignments(200, 1)]
    assert {kind: kinds.count(kind) for kind in set(kinds)} == {
        "none": 40,
        "one": 90,
        "two": 16,
        "parameters": 14,
        "outside": 40,
    }
    named = [a.effects[0].name for a in assignments(200, 1) if a.kind == "one"]
    assert {named.count(effect.name) for effect in NAMED} == {3}


def messages_of(log: bytes) -> list[mavlink.MAVLink_message]:
    """Return the messages of a tlog of unsigned MAVLink 2 frames; every frame has to be valid, and in
    order."""
    link = mavlink.MAVLink(None)
    found, at, before = [], 0, 0
    while at < len(log):
        (stamp,) = struct.unpack(">Q", log[at : at + 8])
        length = 12 + log[at + 9]
        found.append(link.decode(bytearray(log[at + 8 : at + 8 + length])))
        assert stamp >= before
        before, at = stamp, at + 8 + length
    return found


@pytest.fixture(scope="module")
def quiet_log(quiet_case: Case) -> list[mavlink.MAVLink_message]:
    return messages_of(log_bytes(quiet_case))


def test_log_holds_every_message(quiet_case: Case, quiet_log: list[mavlink.MAVLink_message]) -> None:
    expected = {"HEARTBEAT", "PARAM_VALUE", "AOA_SSA", "ATTITUDE", "SERVO_OUTPUT_RAW", "VFR_HUD"}
    expected |= {"GLOBAL_POSITION_INT", quiet_case.wiring.imu}
    assert {message.get_type() for message in quiet_log} == expected


def test_log_and_calibration_tell_the_command(quiet_case, quiet_log):
    case = quiet_case
    assert case.recorder.low_pass is None
    field = f"servo{case.wiring.elevator_output}_raw"
    servo = [m for m in quiet_log if m.get_type() == "SERVO_OUTPUT_RAW"]
    stamps = np.array([m.time_usec for m in servo]) * 1e-6 - case.wiring.boot_s
    widths, degrees = np.array(aircraft_file(case)["elevator"]["calibration"]).T
    told = np.radians(np.interp([getattr(m, field) for m in servo], widths, degrees))
    true = np.interp(stamps, case.experiment.time, case.flown.truth.command)
    # Stamps of a clean case wander by 0.3 ms, which shows where the command jumps.
    assert np.percentile(np.abs(told - true), 98.0) < 1.01 * case.experiment.link.resolution


@pytest.mark.study
def test_files_give_nothing_away(tmp_path: Path) -> None:
    folder = tmp_path / "set"
    write_set(folder, cases(2, 9))
    places = sorted(place for place in folder.iterdir() if place.is_dir())
    assert [place.name for place in places] == [f"{index:04d}" for index in range(1, 3)]
    structures = set()
    for place in places:
        assert sorted(file.name for file in place.iterdir()) == ["aircraft.yaml", "flight.tlog"]
        document = yaml.safe_load((place / "aircraft.yaml").read_text())
        document.pop("model", None)
        assert document["name"] == "test aircraft"
        structures.add(tuple(document))
        words = (place / "aircraft.yaml").read_text() + (place / "flight.tlog").read_bytes().decode("latin-1")
        assert not any(name in words for name in EFFECTS)
    assert len(structures) == 1


def test_the_truth_of_a_case_is_what_the_judge_reads() -> None:
    case = draw_case(Assignment("one", (EFFECTS["pitch_rate_scale"],)), 6, 1)
    said = {"pitch_rate_scale": {"scale": case.effects[0].parameters["scale"]}}
    told = judge(truth(case), {"verdict": "effect", "causes": [{"effect": "pitch_rate_scale"}]})
    assert (told.kind, told.sizes, told.is_right) == ("one", said, True)


def test_size_of_a_log_does_not_depend_on_the_effect() -> None:
    sizes = [
        len(log_bytes(draw_case(Assignment(kind, effects), 8, 4)))
        for kind, effects in (
            ("none", ()),
            ("one", (EFFECTS["cg_shift"],)),
        )
    ]
    # MAVLink 2 leaves out zeros at the end of a message, which a few bytes of noise decide.
    assert np.ptp(sizes) < 0.002 * sizes[0]
