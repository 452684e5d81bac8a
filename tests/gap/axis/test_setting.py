"""Numbers of servos and instruments in a lateral record, against closed forms."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.axis.effects import axis_effects, block_of, unseen
from advisor.gap.axis.fit import Flying, Point, outputs
from advisor.gap.axis.setting import THROTTLE as OF_THROTTLE
from advisor.gap.axis.setting import Flown, deflection, laid_out
from advisor.gap.candidates.known import variants_for
from advisor.gap.effects.thrust_moment import EFFECT as THRUST
from advisor.gap.inference.sizes import with_sizes
from advisor.gap.records.prepare import prepare
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axis.parameter import Parameter
from advisor.oem.axis.problem import COMMAND, AxisProblem
from advisor.oem.extra import Prior
from advisor.oem.rows import Signal
from tests.gap.generator import Setup, fly
from tests.oem.axis.builders import JET, aileron_doublet, flown, rudder_doublet, vector

T = np.arange(0.0, 8.0, 0.02)
AILERON = flown(JET, aileron=aileron_doublet(T), seconds=8.0, rate_hz=50.0)
RUDDER = flown(JET, rudder=rudder_doublet(T), seconds=8.0, rate_hz=50.0)
THROTTLE = Signal(T, 0.5 + 0.1 * np.sin(T))
PROPELLER = (OF_THROTTLE, "aileron_rad")
FLOWN = Flown(AxisProblem(LATERAL, (AILERON,)), (THROTTLE,))
START = {
    "beta_initial": 0.002,
    "p_initial": 0.01,
    "bank_initial": 0.05,
    "Y_0": 0.002,
    "L_0": 0.01,
    "N_0": -0.02,
}
LOCAL = np.array([[START.get(name, 0.0) for name in LATERAL.names.local]])


def put(place, value, local=LOCAL):
    """Return the outputs by name with one number at a place."""
    setting = {place: np.array([value])}
    y = outputs(FLOWN, Point(vector(JET), local, setting))
    (rows,) = laid_out(FLOWN, setting).rows
    return {name: y[s] for name, s in rows.items()}


def input_with(place, value):
    """Return stamps and deflection of the aileron with one number at a place."""
    grid = laid_out(FLOWN, {place: np.array([value])}).grid
    stamps = np.concatenate([[0.0], np.cumsum(grid.step_s[:-1])])
    return stamps, grid.inputs[:, 0]


def test_an_ideal_setting_flies_the_record_as_it_was_made():
    ideal = put(("aileron", "delay_s"), 0.0)
    assert ideal["p"] == pytest.approx(AILERON.outputs["p"].y, abs=2e-4)


def test_a_dead_band_shortens_a_step_by_its_half_width():
    t, moved = input_with(("aileron", "half_deadband_rad"), 0.01)
    assert moved[np.searchsorted(t, 1.6)] == pytest.approx(0.06, abs=1e-6)


def test_play_shortens_the_first_step_and_holds_at_the_end():
    t, moved = input_with(("aileron", "half_play_rad"), 0.01)
    assert moved[np.searchsorted(t, 1.6)] == pytest.approx(0.06, abs=1e-6)
    assert moved[-1] == pytest.approx(-0.01, abs=1e-6)


def test_a_rate_limit_moves_at_its_rate():
    t, moved = input_with(("aileron", "slowness_s_rad"), 1.0 / 0.2)
    assert moved[np.searchsorted(t, 1.2)] == pytest.approx(0.04, abs=2e-3)


def test_a_lag_and_a_delay_trail_a_step():
    t, late = input_with(("aileron", "delay_s"), 0.2)
    assert np.interp(1.25, t, late) == pytest.approx(0.035, abs=1e-6)
    t, slow = input_with(("aileron", "lag_s"), 0.3)
    assert np.interp(1.6, t, slow) == pytest.approx(0.07 * (1.0 - np.exp(-0.55 / 0.3)), rel=0.02)


def test_an_instrument_scale_multiplies_its_channel_alone():
    ideal, scaled = put(("p", "scale"), 0.0), put(("p", "scale"), 0.1)
    assert scaled["p"] == pytest.approx(1.1 * ideal["p"])
    assert scaled["r"] == pytest.approx(ideal["r"])


def test_a_late_stamp_shows_the_past():
    # From rest, for the record begins earlier by the lateness.
    ideal, late = (put(("bank", "delay_s"), delay_s, 0.0 * LOCAL)["bank"] for delay_s in (0.0, 0.1))
    assert late[50:] == pytest.approx(ideal[45:-5], abs=2e-4)


def test_an_accelerometer_ahead_feels_the_change_of_the_yaw_rate():
    ideal, ahead = put(("a_y", "arm_m"), 0.0), put(("a_y", "arm_m"), 0.5)
    change = np.gradient(ideal["r"], T)
    assert (ahead["a_y"] - ideal["a_y"])[60:-5] == pytest.approx(0.5 * change[60:-5], abs=4e-3)


def test_the_propeller_rolls_as_the_aileron_that_follows_the_throttle():
    t, moved = input_with(PROPELLER, 0.2)
    _, still = input_with(PROPELLER, 0.0)
    assert np.interp(5.0, t, moved) == pytest.approx(0.2 * 0.1 * np.sin(5.0), abs=1e-4)
    assert np.max(np.abs(still[-50:])) == 0.0


def test_a_control_that_is_not_flown_has_no_effect_and_says_so():
    named = {effect.name for effect in axis_effects(FLOWN)}
    assert "aileron_actuator_backlash" in named
    assert not any(name.startswith("rudder") for name in named)
    told = {one.effect: one.because for one in unseen(FLOWN)}
    assert told["the servo of the rudder"] == "the rudder is not flown"


def test_a_still_throttle_cannot_show_the_propeller():
    still = Flown(AxisProblem(LATERAL, (AILERON, RUDDER)), (None, Signal(T, 0.5 + 0.0 * T)))
    assert "propeller_roll" not in {effect.name for effect in axis_effects(still)}
    assert "propeller roll" in {one.effect for one in unseen(still)}


def test_sentences_are_those_of_the_pitch_axis_in_the_words_of_this_one():
    said = {e.name: e for e in axis_effects(FLOWN)}
    play = said["aileron_actuator_backlash"].said("The real elevator has play of 0.40 deg to either side")
    assert play == "The real aileron has play of 0.40 deg to either side"
    rate = said["roll_rate_scale"].said("The pitch rate reads 10.0 % too much")
    assert rate == "The roll rate reads 10.0 % too much"
    assert said["propeller_roll"].said(THRUST.said) == "The propeller rolls the real aircraft"


def test_a_vane_is_an_effect_only_where_the_file_states_its_place():
    stated = replace(FLOWN, arm_is_stated=True)
    assert "alpha_vane_offset" in {effect.name for effect in axis_effects(stated)}
    assert "alpha_vane_offset" not in {effect.name for effect in axis_effects(FLOWN)}


@pytest.mark.parametrize(("change", "value"), [(0.05, 0.07), (0.5, 0.1), (-0.5, 0.0)])
def test_a_parameter_moves_within_its_bounds(change, value):
    free = Parameter(("p", "scale"), Prior(0.0, 0.1), bounds=(0.0, 0.1))
    moved = free.moved(Flying(None, {("p", "scale"): np.full(2, 0.02)}), change)
    assert free.read(moved) == pytest.approx(value)
    assert free.read(Flying(None, {})) == 0.0


def test_a_delay_of_all_commands_is_one_cause_where_two_controls_are_flown():
    both = {
        effect.name: effect
        for effect in axis_effects(Flown(AxisProblem(LATERAL, (AILERON, RUDDER)), (None, None)))
    }
    common = both["common_transport_delay"]
    assert common.places == (COMMAND,)
    assert block_of(LATERAL, common.of) == "input"
    said = common.said("The simulator responds 92 ms too early: a delay between command and surface")
    assert said == "The simulator responds 92 ms too early: a delay between all commands and surfaces"
    assert "common_transport_delay" not in {effect.name for effect in axis_effects(FLOWN)}


def test_servos_and_streams_have_equal_prior_widths_on_both_axes():
    flights = prepare(fly(Setup(maneuvers=3, seed=4)), Aircraft())
    derivatives = np.array([-4.0, 0.0, -0.4, -40.0, -5.0, -60.0])
    sized = [with_sizes(variant, derivatives, flights) for variant in variants_for(flights)]
    pitch = {(v.effect, v.names): v.prior_std for v in sized}
    side = {(e.variant.effect, e.variant.names): e.std for e in axis_effects(FLOWN)}
    shared = {key for key in pitch.keys() & side.keys() if key[0] != "accelerometer_offset"}
    assert {"actuator_lag", "attitude_skew", "pitch_rate_scale"} <= {effect for effect, _ in shared}
    assert all(pitch[key] == side[key] for key in shared)


def test_a_lag_follows_the_command_before_the_record() -> None:
    late = {("aileron", "lag_s"): np.array([0.14])}
    cut = AILERON.inputs["aileron"].t > 1.02
    early, record = (Signal(*(part[at] for part in AILERON.inputs["aileron"])) for at in (~cut, cut))
    begun = replace(AILERON, inputs={**AILERON.inputs, "aileron": record}, before={"aileron": early})
    moved, whole = (
        deflection(Flown(AxisProblem(LATERAL, (r,)), (THROTTLE,)), 0, "aileron", late).at(record.t)
        for r in (begun, AILERON)
    )
    assert moved == pytest.approx(whole, abs=1e-4)
    assert abs(moved[0] - record.y[0]) > 0.01
