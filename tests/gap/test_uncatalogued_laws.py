"""A reading out of proportion, or a moment that bends with the pitch rate, has no name: it is unknown."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.controls import Elevator
from advisor.gap.records.prepare import prepare
from advisor.gap.search.baseline import fit_baseline
from advisor.gap.simulator.layout import INDEX
from tests.gap.diagnosed import diagnose
from tests.gap.generator import Setup, fly

pytestmark = pytest.mark.study
"""Whole diagnoses, run by ``make study-gap``."""

HARD = Setup(maneuvers=6, gust_std=0.12, coloured=0.5, jitter=0.004, speed_change=0.03, seed=37)


def with_reading(setup, channel, reading):
    """Return the flight with one channel replaced by ``reading`` of its true value."""
    flown = []
    for maneuver in fly(setup):
        read = maneuver.channels[channel]
        channels = {**maneuver.channels, channel: replace(read, y=reading(read.y))}
        flown.append(replace(maneuver, channels=channels))
    return flown


def scaled(setup, channel, factor):
    """Return the flight with one channel read too high or too low."""
    return with_reading(setup, channel, lambda y: factor * y)


@pytest.mark.study
def test_a_scale_without_a_name_is_no_sum_of_named_effects_even_in_moving_air():
    found = diagnose(scaled(replace(HARD, maneuvers=9), "theta", 1.1), Aircraft())
    assert found.verdict == "unknown"
    assert found.where.block == "attitude_sensor"
    # An attitude that reads a tenth high has its zero off, too.
    others = {"turbulence", "gust", "alpha_bias"}
    assert not {c.effect for c in found.causes if c.present} - others


def test_where_a_named_instrument_is_off_no_other_is_suspected():
    found = diagnose(scaled(Setup(maneuvers=6, seed=38), "q", 1.08), Aircraft())
    assert [c.effect for c in found.causes if c.present] == ["pitch_rate_scale"]


@pytest.mark.parametrize(
    "setup", [pytest.param(HARD, marks=pytest.mark.study), Setup(maneuvers=6, seed=39)], ids=["hard", "clean"]
)
def test_an_elevator_that_loses_power_in_flight_is_no_mass_and_no_ice(setup):
    flown = fly(setup)
    for i, maneuver in enumerate(flown[4:], start=4):
        sent = maneuver.channels["elevator"]
        # What moves a surface by two thirds of what is sent.
        channels = {**maneuver.channels, "elevator": replace(sent, y=1.5 * sent.y - 0.5 * sent.y[0])}
        flown[i] = replace(maneuver, channels=channels)
    found = diagnose(flown, Aircraft())
    assert (found.verdict, found.where.block) == ("unknown", "input")
    assert any("elevator's power changed by -3" in note for note in found.notes)


@pytest.mark.parametrize(("channel", "reading", "block", "says"), [
    pytest.param("alpha", lambda y: np.minimum(y, np.median(y) + 0.04), "alpha_sensor", "meets a stop",
                 marks=pytest.mark.study),
    pytest.param("a_z", lambda y: np.maximum(y, -14.0), "accelerometer", "is not linear",
                 marks=pytest.mark.study),
    ("a_z", lambda y: y + 0.02 * (y + 9.8) ** 2, "accelerometer", "is not linear"),
])  # fmt: skip
def test_a_bent_reading_is_no_sum_of_bent_forces_even_in_moving_air(channel, reading, block, says):
    found = diagnose(with_reading(replace(HARD, maneuvers=9), channel, reading), Aircraft())
    assert found.verdict == "unknown"
    assert found.where.block == block
    assert any(says in note for note in found.notes)


@pytest.mark.parametrize(("setup", "felt"), [
    (replace(HARD, maneuvers=6), lambda pull: -0.012 * pull),
    (Setup(maneuvers=6, seed=38), lambda pull: 0.003 * pull**2),
])  # fmt: skip
def test_a_gyro_that_feels_the_acceleration_is_unknown_in_the_gyro(setup, felt):
    flown = []
    for maneuver in fly(setup):
        q, a_z = maneuver.channels["q"], maneuver.channels["a_z"]
        wrong = replace(q, y=q.y + felt(np.interp(q.t, a_z.t, a_z.y) + 9.81))
        flown.append(replace(maneuver, channels={**maneuver.channels, "q": wrong}))
    found = diagnose(flown, Aircraft())
    assert (found.verdict, found.where.block) == ("unknown", "pitch_rate_sensor")
    assert any("The acceleration disturbs the measured pitch rate." in note for note in found.notes)


@pytest.mark.parametrize(("setup", "lowest", "highest"), [
    (Setup(maneuvers=6, seed=40), -0.05, 0.035),
    pytest.param(Setup(seed=40), -0.045, 0.5, marks=pytest.mark.study),
])  # fmt: skip
def test_a_surface_that_stops_before_the_command_is_no_bent_moment(setup, lowest, highest):
    found = diagnose(fly(replace(setup, switches={"stop_low": lowest, "stop_high": highest})), Aircraft())
    assert (found.verdict, found.where.block) == ("unknown", "input")
    (note,) = (n for n in found.notes if "The surface stops before the command does" in n)
    assert f"{np.degrees(highest if highest < 0.4 else -lowest):.1f}" in note


@pytest.mark.parametrize(
    "setup", [Setup(maneuvers=6, seed=44), pytest.param(HARD, marks=pytest.mark.study)], ids=["clean", "hard"]
)
def test_a_servo_that_sticks_until_it_breaks_loose_is_no_play_with_a_lag(setup):
    sticking = {"breaks_at": 0.03, "drags": 0.005, "lag": 0.03}
    found = diagnose(fly(replace(setup, switches=sticking)), Aircraft())
    assert (found.verdict, found.where.block) == ("unknown", "input")
    assert any("The surface sticks" in note for note in found.notes)


@pytest.mark.parametrize(
    ("setup", "hz"), [(Setup(maneuvers=5, seed=42), 4.0), pytest.param(HARD, 2.5, marks=pytest.mark.study)]
)
def test_a_servo_that_overshoots_is_no_delay_with_a_structure_that_bends(setup, hz):
    found = diagnose(fly(replace(setup, switches={"ring_hz": hz, "ring_zeta": 0.2})), Aircraft())
    assert (found.verdict, found.where.block) == ("unknown", "input")
    assert any("The surface overshoots its command" in note for note in found.notes)


def test_a_servo_that_rings_is_known_where_the_file_has_it_later_than_it_is():
    setup = Setup(maneuvers=6, seed=44, switches={"ring_hz": 3.0, "ring_zeta": 0.12})
    found = diagnose(fly(setup), Aircraft(elevator=Elevator(lag_s=0.03)))
    assert (found.verdict, found.where.block) == ("unknown", "input")
    assert any("The surface overshoots its command" in note for note in found.notes)
    assert not any(c.present for c in found.causes)


@pytest.mark.parametrize("switches", [
    {"lag": 0.03, "before_lag": 0.03}, pytest.param({"delay": 0.04, "lag": 0.04}, marks=pytest.mark.study)
])  # fmt: skip
def test_a_servo_that_is_well_damped_keeps_its_name(switches):
    found = diagnose(fly(Setup(maneuvers=5, switches=switches, seed=43)), Aircraft())
    assert found.verdict == "effect"
    assert found.causes[0].effect in ("actuator_lag", "transport_delay")


@pytest.mark.parametrize(
    "switches",
    [
        pytest.param({"cl_a2": -9.0}, marks=pytest.mark.study),
        pytest.param({"cl_a3": -160.0}, marks=pytest.mark.study),
        {"cm_a2": 4.0},
        pytest.param({"kink_at": 0.12}, marks=pytest.mark.study),
    ],
)
def test_a_force_or_a_moment_that_bends_is_no_instruments_fault(switches):
    found = diagnose(fly(replace(HARD, switches=switches)), Aircraft())
    assert found.verdict == "effect"
    assert found.where.block in ("force_equation", "moment_equation")


@pytest.mark.parametrize(("lost_cl", "bends", "gust_std"), [
    (0.06, 0.0, 0.12),
    pytest.param(0.12, 0.0, 0.0, marks=pytest.mark.study),
])  # fmt: skip
def test_lift_that_comes_back_another_way_than_it_went_is_no_lift_that_bends(lost_cl, bends, gust_std):
    stalling = {"lets_go_at": 0.09, "holds_below": 0.05, "lost_cl": lost_cl, "cl_a2": bends}
    found = diagnose(fly(Setup(maneuvers=6, switches=stalling, gust_std=gust_std, seed=46)), Aircraft())
    assert (found.verdict, found.where.block) == ("unknown", "force_equation")


def test_where_the_flow_lets_go_is_met_within_a_step_and_not_at_its_end():
    """Else no search would find the angle: the motion would change with it by jumps."""
    problem, fitted = fit_baseline(prepare(fly(Setup(maneuvers=2, seed=46)), Aircraft()), Aircraft())
    p, flight = problem.driving(fitted.point)[0], problem.flights.flights[0]
    p[INDEX["Z_separated"]], motions = 0.05, []
    for at in 0.02 + 2e-5 * np.arange(40):
        p[[INDEX["separation_rad"], INDEX["attachment_rad"]]] = at, -0.01
        motions.append(problem.fly(flight, p)[1])
    changes = np.linalg.norm(np.diff(motions, axis=0), axis=1)
    assert np.max(changes) < 3.0 * np.median(changes)


def test_what_is_wrong_beside_a_reading_out_of_proportion_keeps_its_name():
    both = with_reading(replace(HARD, q_bias=0.02), "a_z", lambda y: 1.07 * y)
    found = diagnose(both, Aircraft())
    assert found.causes[0].effect == "pitch_rate_bias"


@pytest.mark.parametrize(("switches", "says"), [
    pytest.param({"q_abs": -0.02}, "not the same up and down", marks=pytest.mark.study),
    pytest.param({"q_square": -0.06}, "not the same up and down, or fast and slow", marks=pytest.mark.study),
    ({"cm_aq": -90.0}, "changes with the angle of attack"),
])  # fmt: skip
@pytest.mark.parametrize(
    "setup", [HARD, pytest.param(Setup(seed=8), marks=pytest.mark.study)], ids=["hard", "clean"]
)
def test_damping_that_bends_is_no_sum_of_bent_moments(setup, switches, says):
    found = diagnose(fly(replace(setup, switches=switches)), Aircraft())
    assert found.verdict == "unknown"
    assert found.where.block == "moment_equation"
    assert any(says in note for note in found.notes)


def test_lift_that_is_lost_with_the_pitch_rate_is_no_lift_that_bends():
    found = diagnose(fly(replace(HARD, switches={"cl_q_abs": -0.25})), Aircraft())
    assert (found.verdict, found.where.block) == ("unknown", "force_equation")
    assert any("The lift is not linear in the pitch rate" in note for note in found.notes)


@pytest.mark.study
def test_an_accelerometer_that_does_not_carry_the_weight_is_unknown_where_the_dynamics_tell_nothing():
    stormy = Setup(gust_std=2.0, coloured=0.5, jitter=0.004, seed=37)
    found = diagnose(scaled(stormy, "a_z", 0.78), Aircraft())
    assert (found.verdict, found.where.block) == ("unknown", "accelerometer")
    assert any("reads 0.78" in note for note in found.notes)
    sound = diagnose(fly(stormy), Aircraft())
    assert sound.where.block != "accelerometer"


def test_an_accelerometers_zero_that_is_off_by_a_common_amount_is_no_cause():
    found = diagnose(with_reading(Setup(maneuvers=6, seed=5), "a_z", lambda y: y + 0.6), Aircraft())
    assert found.verdict == "none"
