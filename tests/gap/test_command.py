"""Between its stamps a command was held or moved on, and half an interval lies between the two readings."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft import Aircraft
from advisor.diagnosis import maneuvers_of
from advisor.gap.candidates.catalogue import variants_for
from advisor.gap.diagnose import diagnose
from advisor.gap.explain import explain
from advisor.gap.fitting.fit import fit
from advisor.gap.records.prepare import prepare
from advisor.gap.records.usable import usable_of
from advisor.gap.search.baseline import fit_baseline
from advisor.gap.search.command import is_likelier_held, may_be_held, may_pay, read_otherwise
from sim.effects.fitting import flight_of
from sim.record import record
from sim.scenario import read_scenario
from tests.gap.generator import Setup, fly

UAV = """
aircraft: uav
noise: {alpha_deg: 0.05, pitch_rate_deg_s: 0.15, pitch_deg: 0.05, accelerometer_m_s2: 0.05}
maneuvers: ["3211", "rev", doublet, "rev"]
"""


def plain_model_of(scenario, folder):
    """The data of a flight of the bundled aircraft, and the plain model fitted to them."""
    (folder / "flown.yaml").write_text(scenario)
    record(flight_of(read_scenario(folder / "flown.yaml")), folder / "flown.tlog")
    maneuvers = maneuvers_of([folder / "flown.tlog"], Aircraft()).maneuvers
    return fit_baseline(prepare(maneuvers, Aircraft()), Aircraft())


@pytest.fixture(scope="module")
def both_readings(tmp_path_factory):
    """A held command read as it is, and as linear: data and plain model of each."""
    held, plain = plain_model_of(f"{UAV}input: held\n", tmp_path_factory.mktemp("held"))
    linear = replace(held, held=False)
    return held, plain, linear, fit(linear, plain.point, plain.noise)


@pytest.mark.parametrize("flown", ["held", "linear"])
def test_a_command_is_read_as_it_was_flown(tmp_path, flown):
    problem, _ = plain_model_of(f"{UAV}input: {flown}\n", tmp_path)
    assert problem.held == (flown == "held")


@pytest.mark.parametrize("flown", ["held", "linear"])
def test_a_servo_that_moves_no_faster_is_no_later_for_a_command_that_was_held(tmp_path, flown):
    limited = f"{UAV}input: {flown}\neffects: {{actuator_rate_limit: {{rate_rad_s: 0.7}}}}\n"
    (tmp_path / "uav.yaml").write_text(limited)
    record(flight_of(read_scenario(tmp_path / "uav.yaml")), tmp_path / "uav.tlog")
    found = diagnose(maneuvers_of([tmp_path / "uav.tlog"], Aircraft()).maneuvers, Aircraft())
    (cause,) = [c for c in found.causes if c.present]
    assert any("answer 10 ms late: the two look the same" in note for note in found.notes) == (
        flown == "held"
    )
    assert cause.effect == "actuator_rate_limit"
    assert cause.parameters["rate_rad_s"].value == pytest.approx(0.7, rel=0.03)


def test_a_limit_that_steps_meet_for_less_than_an_interval_is_no_sign_of_a_held_command(both_readings):
    held, plain, linear, read_as_linear = both_readings
    limit = next(v for v in variants_for(held.flights) if v.effect == "actuator_rate_limit")

    def is_held_with(rate_rad_s: float) -> bool:
        limited = plain.point.with_effect(limit, (1.0 / rate_rad_s,))
        return is_likelier_held(linear, read_as_linear, held, replace(plain, point=limited))

    # The fits are the same but for the limit: steps of 4 deg take 70 ms there, and 7 ms here.
    assert is_held_with(1.0)
    assert not is_held_with(10.0)


@pytest.mark.parametrize(("late_s", "is_held"), [(0.012, True), (0.003, False)])
def test_a_sensor_that_is_late_by_what_the_linear_reading_shifts_is_a_sign_of_a_held_command(
    both_readings, late_s, is_held
):
    held, plain, linear, read_as_linear = both_readings
    skew, scale = (
        next(v for v in variants_for(held.flights) if v.effect == effect)
        for effect in ("accelerometer_skew", "alpha_scale")
    )
    late = replace(read_as_linear, point=read_as_linear.point.with_effect(skew, (late_s,)))
    scaled = replace(plain, point=plain.point.with_effect(scale, (0.05,)))
    # Both name one effect, and the held reading is the likelier one.
    assert is_likelier_held(linear, late, held, scaled) == is_held


@pytest.mark.parametrize("early_s", [0.012, pytest.param(0.016, marks=pytest.mark.study)])
def test_a_pitch_rate_that_is_early_beside_a_held_command_makes_nothing_else_late(tmp_path, early_s):
    skewed = f"effects: {{pitch_rate_skew: {{skew_s: {-early_s}}}}}\n"
    quiet = UAV.replace("uav", "light").replace("0.15", "0.05")
    (tmp_path / "light.yaml").write_text(f"{quiet}input: held\n{skewed}")
    record(flight_of(read_scenario(tmp_path / "light.yaml")), tmp_path / "light.tlog")
    found = diagnose(maneuvers_of([tmp_path / "light.tlog"], Aircraft()).maneuvers, Aircraft())
    (cause,) = [c for c in found.causes if c.present]
    assert cause.effect == "pitch_rate_skew"
    assert cause.parameters["skew_s"].value == pytest.approx(-early_s, abs=0.002)


def test_a_linear_command_taken_for_a_held_one_is_read_again_where_it_puts_several_sensors_out_of_step():
    flown = fly(Setup(maneuvers=6, skew={"q": 0.0145}, noise=0.007, seed=73))
    # Stamped late besides, by more than the servo takes: a few milliseconds of latency hide nothing then.
    for n, maneuver in enumerate(flown):
        elevator = maneuver.channels["elevator"]
        late = replace(elevator, t=elevator.t + 0.012)
        flown[n] = replace(maneuver, channels={**maneuver.channels, "elevator": late})
    flights = prepare(flown, Aircraft())
    held, plain = read_otherwise(*fit_baseline(flights, Aircraft()))
    assert held.held
    found = explain(held, plain, Aircraft(), lambda *_: None)
    assert not found.problem.held
    assert [s.added.effect for s in found.stages if s.added is not None] == ["pitch_rate_skew"]


def test_the_other_reading_is_searched_only_where_the_named_effects_may_do_with_it():
    flown = fly(Setup(maneuvers=4, skew={"q": 0.0145}, noise=0.007, seed=73))
    linear, plain = fit_baseline(prepare(flown, Aircraft()), Aircraft())
    skew = next(v for v in variants_for(linear.flights) if v.effect == "pitch_rate_skew")

    def named_with(problem, fitted):
        return fit(problem, fitted.point.with_effect(skew, (0.0145,)), fitted.noise)

    held, plainly_held = read_otherwise(linear, plain)
    assert not linear.held
    assert may_be_held(linear, named_with(linear, plain), {"pitch_rate_skew"})
    assert not may_pay(linear, named_with(linear, plain), {"pitch_rate_skew"})
    assert may_pay(held, named_with(held, plainly_held), {"pitch_rate_skew"})


@pytest.mark.parametrize("seed", [1, 2])
def test_a_delay_of_nearly_an_interval_is_not_taken_for_a_held_command_that_is_half_as_late(seed):
    late = Setup(maneuvers=6, switches={"delay": 0.018}, jitter=0.002, seed=seed)
    problem, _ = fit_baseline(prepare(fly(late), Aircraft()), Aircraft())
    assert not problem.held


def without(maneuver, lost):
    """The manoeuvre with some stamps of its command lost on the way."""
    elevator = maneuver.channels["elevator"]
    kept = replace(elevator, t=elevator.t[~lost], y=elevator.y[~lost])
    return replace(maneuver, channels={**maneuver.channels, "elevator": kept})


def test_a_held_command_of_which_steps_were_lost_is_still_held(tmp_path):
    (tmp_path / "uav.yaml").write_text(f"{UAV}input: held\n")
    record(flight_of(read_scenario(tmp_path / "uav.yaml")), tmp_path / "uav.tlog")
    received = []
    for maneuver in maneuvers_of([tmp_path / "uav.tlog"], Aircraft()).maneuvers:
        command = maneuver.channels["elevator"].y
        # The message with the new value is lost in every third step, the one after it has it.
        steps = np.flatnonzero(np.abs(np.diff(command)) > 0.01) + 1
        received.append(without(maneuver, np.isin(np.arange(len(command)), steps[::3])))
    problem, _ = fit_baseline(prepare(received, Aircraft()), Aircraft())
    assert problem.held


def test_a_manoeuvre_with_a_step_in_a_hole_of_the_log_is_left_out_and_said_so():
    flown = fly(Setup(maneuvers=6, seed=5))
    elevator = flown[2].channels["elevator"]
    step = elevator.t[int(np.argmax(np.abs(np.diff(elevator.y))))]
    flown[2] = without(flown[2], np.abs(elevator.t - step) < 0.15)
    found = diagnose(flown, Aircraft())
    assert found.maneuvers == (1, 2, 4, 5, 6)
    assert any("manoeuvre 3" in note for note in found.notes)


@pytest.mark.parametrize(("hole_s", "is_hidden"), [((1.45, 2.15), True), ((1.55, 1.75), False)])
def test_in_a_hole_of_the_log_a_whole_pulse_may_be_hidden_but_not_in_a_short_one(hole_s, is_hidden):
    flown = fly(Setup(maneuvers=6, seed=5))
    span = flown[2].span
    t = np.arange(span.start_s - 1.0, span.end_s, 0.02)
    ago = t - span.start_s
    # To and fro for as long as the manoeuvre takes: before the hole the command is what it is after it.
    command = np.where((ago > 0.0) & (t < span.last_step_s), 0.03 * np.where(ago % 1.0 < 0.5, 1.0, -1.0), 0.0)
    heard = (ago < hole_s[0]) | (ago > hole_s[1])
    elevator = replace(flown[2].channels["elevator"], t=t[heard], y=command[heard])
    flown[2] = replace(flown[2], channels={**flown[2].channels, "elevator": elevator})
    assert (3 not in [m.number for m in usable_of(flown)]) is is_hidden
