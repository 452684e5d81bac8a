"""A gap without a named effect is unknown, with its place; the file decides where data cannot."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import butter, lfilter, sosfiltfilt

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS
from advisor.gap.fitting.prior import ERROR_IF_WRONG, prior_precision
from advisor.gap.kit.changes_between import shift_moments
from advisor.gap.records.prepare import prepare
from advisor.gap.records.smoothness import is_filtered, is_smoothed
from advisor.gap.simulator.layout import ENTRIES, INDEX
from advisor.gap.simulator.surface import surface
from tests.gap.diagnosed import diagnose
from tests.gap.generator import Setup, fly

pytestmark = pytest.mark.study
"""Whole diagnoses, run by ``make study-gap``."""

BELIEVED = np.array([-4.3, -0.03, -0.28, -37.0, -4.8, -52.0])


def test_a_vane_that_jumps_now_and_then_is_unknown_in_the_vane():
    maneuvers = []
    rng = np.random.default_rng(22)
    for maneuver in fly(Setup(maneuvers=6, seed=22)):
        alpha = maneuver.channels["alpha"]
        hit = np.convolve(rng.random(len(alpha)) < 0.006, np.ones(4), mode="same") > 0.0
        jumpy = replace(alpha, y=alpha.y + 0.03 * hit)
        maneuvers.append(replace(maneuver, channels={**maneuver.channels, "alpha": jumpy}))
    found = diagnose(maneuvers, Aircraft())
    assert found.verdict == "unknown"
    assert found.where.block == "alpha_sensor"


def test_a_vane_that_sticks_for_long_is_unknown_in_the_vane_and_not_a_channel_that_repeats_itself():
    sticky = []
    for maneuver in fly(Setup(maneuvers=6, seed=29)):
        alpha = maneuver.channels["alpha"]
        shown, stuck = alpha.y[0], []
        for value in alpha.y:
            shown = value if abs(value - shown) > 0.012 else shown
            stuck.append(shown)
        channels = {**maneuver.channels, "alpha": replace(alpha, y=np.array(stuck))}
        sticky.append(replace(maneuver, channels=channels))
    found = diagnose(sticky, Aircraft())
    assert found.verdict == "unknown"
    assert found.where.block == "alpha_sensor"


def test_two_effects_are_both_named_the_larger_one_first():
    flown = fly(Setup(maneuvers=6, switches={"delay": 0.06}, alpha_scale=0.1, seed=23))
    found = diagnose(flown, Aircraft())
    present = [c.effect for c in found.causes if c.present]
    assert present == ["transport_delay", "alpha_scale"]


@pytest.mark.study
def test_three_streams_that_are_late_alike_are_a_late_command_and_one_stream_that_is_early():
    late = Setup(maneuvers=6, noise=0.005, switches={"delay": 0.06}, skew={"alpha": -0.06}, seed=40)
    found = diagnose(fly(late), Aircraft())
    present = {c.effect: c.parameters for c in found.causes if c.present}
    assert present.keys() == {"transport_delay", "alpha_skew"}
    assert present["transport_delay"]["delay_s"].value == pytest.approx(0.06, abs=0.005)
    assert present["alpha_skew"]["skew_s"].value == pytest.approx(-0.06, abs=0.005)


@pytest.fixture(scope="module")
def still_file():
    """Return an aircraft file whose derivatives are right."""
    still = diagnose(fly(Setup(maneuvers=6, seed=24)), Aircraft())
    return Aircraft(model={name: still.model[name].value for name in PARAMETERS})


@pytest.mark.parametrize("cm_alphadot", [-8.0, pytest.param(-25.0, marks=pytest.mark.study), 6.0])
def test_the_files_derivatives_tell_a_moment_of_the_angles_rate_from_three_other_derivatives(
    still_file, cm_alphadot
):
    """In still air at constant speed the two are the same motion."""
    found = diagnose(fly(Setup(maneuvers=6, switches={"cm_alphadot": cm_alphadot}, seed=25)), still_file)
    assert (found.verdict, found.causes[0].effect) == ("effect", "alpha_dot")
    assert found.causes[0].parameters["M_alpha_dot"].value * cm_alphadot > 0.0


@pytest.mark.parametrize("which", [*range(6), slice(None)])
def test_a_derivative_of_nothing_in_the_file_has_a_size_that_can_be_weighed(which):
    believed = BELIEVED.copy()
    believed[which] = 0.0
    assert np.all(np.isfinite(prior_precision(believed, ERROR_IF_WRONG)))


def test_a_dead_band_off_the_trim_swallows_one_side_only():
    p = np.zeros(len(ENTRIES))
    p[INDEX["half_deadband_rad"]], p[INDEX["neutral_rad"]] = 0.01, 0.01
    t = np.array([0.0, 0.4, 0.400001, 1.0])

    def answer(level: float) -> float:
        u = np.array([0.0, 0.0, level, level])
        return float(surface(0.005, 200, t, u, False, 0.0, p)[-1])

    assert answer(0.015) == pytest.approx(0.0)
    assert answer(0.03) == pytest.approx(0.01)
    assert answer(-0.02) == pytest.approx(-0.02)


def test_a_wandering_centre_of_gravity_gives_every_force_the_same_further_arm():
    p = np.zeros((2, len(ENTRIES)))
    p[:, :6] = BELIEVED
    shift_moments(p, np.array([0.0, -0.2]))
    changes = (p[1] - p[0])[[INDEX["M_alpha"], INDEX["M_q"], INDEX["M_delta_e"]]]
    forces = BELIEVED[[0, 1, 2]]
    assert changes[0] == pytest.approx(-0.2 * BELIEVED[3])
    assert changes / forces == pytest.approx(np.full(3, changes[0] / forces[0]))


def test_three_wrong_derivatives_of_the_file_are_no_moment_of_the_angles_rate(still_file):
    off = {**still_file.model, "M_alpha": 1.3 * still_file.model["M_alpha"]}
    off |= {"M_q": 0.7 * off["M_q"], "M_delta_e": 1.2 * off["M_delta_e"]}
    assert diagnose(fly(Setup(maneuvers=6, seed=28)), Aircraft(model=off)).verdict == "parameters"


def test_numbers_of_the_file_that_are_off_come_before_the_air_of_the_day(still_file):
    off = Aircraft(model={**still_file.model, "M_alpha": 1.4 * still_file.model["M_alpha"]})
    found = diagnose(fly(Setup(maneuvers=6, gust_std=0.3, seed=29)), off)
    assert found.verdict == "parameters"


def test_an_angle_renewed_faster_than_an_autopilot_estimates_it_comes_from_an_instrument():
    def called_derived(maneuver, every: int):
        alpha = maneuver.channels["alpha"]
        held = alpha.y[np.arange(len(alpha)) // every * every]
        channel = replace(alpha, y=held, source="AOA_SSA.AOA", provenance="derived")
        return replace(maneuver, channels={**maneuver.channels, "alpha": channel})

    flown = fly(Setup(maneuvers=3, seed=31))
    assert not prepare([called_derived(m, 1) for m in flown], Aircraft()).alpha_is_derived
    # ArduPlane renews its own at most 20 times a second, however rough.
    assert prepare([called_derived(m, 3) for m in flown], Aircraft()).alpha_is_derived


@pytest.mark.study
def test_a_gyro_that_saturates_is_no_gyro_that_reads_low():
    flown = fly(Setup(maneuvers=6, seed=21))
    most = 0.15 * max(float(np.max(np.abs(m.channels["q"].y))) for m in flown)
    rates = [replace(m.channels["q"], y=np.clip(m.channels["q"].y, -most, most)) for m in flown]
    clipped = [replace(m, channels={**m.channels, "q": q}) for m, q in zip(flown, rates, strict=True)]
    found = diagnose(clipped, Aircraft())
    assert found.verdict == "unknown"
    assert found.where.block == "pitch_rate_sensor"


def test_a_record_filtered_on_the_ground_is_told_from_noise_and_from_moving_air():
    rng = np.random.default_rng(3)
    noise = rng.standard_normal(2000)
    low_passed = sosfiltfilt(butter(4, 2.0, fs=50.0, output="sos"), noise)
    air = lfilter([1.0], [1.0, -0.97], noise)
    assert is_filtered([low_passed])
    assert not is_filtered([noise])
    assert not is_smoothed([air])


def flown_with(channel, change, **setup):
    """Return manoeuvres with one channel changed: a function of manoeuvre number, stamps and values."""
    flown = fly(Setup(maneuvers=6, **setup))
    return [
        replace(m, channels={**m.channels, channel: change(k, m.channels[channel])})
        for k, m in enumerate(flown)
    ]


def test_what_a_command_logged_ten_times_a_second_leaves_open_is_not_unknown():
    seldom = flown_with("elevator", lambda k, e: replace(e, t=e.t[k % 5 :: 5], y=e.y[k % 5 :: 5]), seed=5)
    assert diagnose(seldom, Aircraft()).verdict == "none"


def test_a_visible_gap_that_is_too_small_for_a_name_is_not_called_nothing():
    wake = {"extra_cm": 0.1, "extra_cm_lag": 0.25}
    found = diagnose(fly(Setup(switches=wake, noise=0.004, seed=3)), Aircraft())
    assert found.verdict == "none"
    assert found.gap.before > 0.2
    assert "too small to name a cause" in found.sentence
