"""A sustained oscillation is a spectral line: found and placed, although the noise filter models it."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.diagnose import diagnose
from advisor.gap.records.prepare import prepare
from advisor.gap.search.baseline import fit_baseline
from advisor.gap.uncatalogued.spectral_line import line_of, ringing_hz, spectral_line_in
from tests.gap.generator import Setup, fly

pytestmark = pytest.mark.study
"""Whole diagnoses, run by ``make study-gap``."""

STANDS_OUT = 3.8
"""The contrast from which on a line counts."""


def test_noise_has_no_line_white_or_of_a_damped_motion():
    rng = np.random.default_rng(31)
    # A motion of 1 Hz damped by 0.5, sampled at 50 Hz, that white noise excites.
    turn = 2 * np.pi / 50.0
    keep = np.exp(-0.5 * turn)
    damped = [1.0, -2 * keep * np.cos(turn * np.sqrt(0.75)), keep**2]
    for _ in range(100):
        white = [rng.standard_normal(400) for _ in range(6)]
        assert line_of(white, 0.02)[1] < STANDS_OUT
        assert line_of([lfilter([1.0], damped, e) for e in white], 0.02)[1] < STANDS_OUT


def test_a_swing_under_noise_stands_out_at_its_frequency_whatever_its_phase():
    rng = np.random.default_rng(32)
    t = 0.02 * np.arange(400)
    swinging = [
        0.7 * np.sin(2 * np.pi * 1.7 * t + phase) + rng.standard_normal(400) for phase in rng.uniform(0, 6, 6)
    ]
    hz, stands_out = line_of(swinging, 0.02)
    assert hz == pytest.approx(1.7, abs=0.05)
    assert stands_out > STANDS_OUT


def test_a_drift_over_the_record_is_no_swing():
    t = 0.02 * np.arange(400)
    noise = np.random.default_rng(33)
    drifting = [np.sin(2 * np.pi * 0.3 * t + i) + 0.1 * noise.standard_normal(400) for i in range(6)]
    assert line_of(drifting, 0.02)[1] < STANDS_OUT


def test_moving_air_is_no_tone():
    flights = prepare(fly(Setup(maneuvers=6, gust_std=0.3, seed=34)), Aircraft())
    problem, fitted = fit_baseline(flights, Aircraft())
    assert problem.knows_the_noise
    assert spectral_line_in(problem, fitted, np.ones(len(problem.channels))) is None


def test_where_the_pitch_rate_rings_a_structure_is_sought_though_slower_motion_is_larger():
    problem, fitted = fit_baseline(prepare(fly(Setup(maneuvers=3, seed=36)), Aircraft()), Aircraft())
    c, left = problem.channels.index("q"), []
    for flight, e in zip(problem.flights.flights, fitted.innovations, strict=True):
        left.append(e.copy())
        since = flight.outputs["q"].t - flight.first_step_s
        ringing = np.exp(-0.5 * since) * np.sin(2.0 * np.pi * 7.2 * since) * (since > 0.0)
        left[-1][problem.rows(flight)[c]] += 0.05 * ringing + 0.1 * np.sin(2.0 * np.pi * 0.8 * since)
    shown = replace(fitted, innovations=tuple(left))
    assert ringing_hz(problem, shown, 2.0, 12.0) == pytest.approx(7.2, abs=0.1)
    assert ringing_hz(problem, shown, 0.2, 2.0) == pytest.approx(0.8, abs=0.1)


@pytest.mark.parametrize("gust_std", [0.0, 0.2])
def test_an_engine_that_beats_is_unknown_in_the_moment_and_no_noise(gust_std):
    beating = fly(Setup(maneuvers=6, switches={"beat": 0.004}, gust_std=gust_std, seed=35))
    found = diagnose(beating, Aircraft())
    assert found.verdict == "unknown"
    assert found.where.block == "moment_equation"
    assert found.gap.before > 0.05


def test_what_swung_before_the_stick_moved_was_not_set_off_by_it():
    found = diagnose(fly(Setup(maneuvers=6, switches={"beat": 0.01, "beat_hz": 0.9}, seed=42)), Aircraft())
    assert found.verdict == "unknown"
    assert any("It swings by itself" in note for note in found.notes)


def shaken(channel, amplitude):
    """Return a flight with an oscillation in one channel."""
    found = []
    for n, maneuver in enumerate(fly(Setup(maneuvers=6, seed=36))):
        y = maneuver.channels[channel]
        swing = amplitude * np.sin(2 * np.pi * 2.2 * (y.t - y.t[0]) + n)
        channels = {**maneuver.channels, channel: replace(y, y=y.y + swing)}
        found.append(replace(maneuver, channels=channels))
    return found


@pytest.mark.parametrize(("channel", "amplitude", "block"), [
    ("q", 0.01, "pitch_rate_sensor"), ("a_z", 0.4, "accelerometer"), ("theta", 0.006, "attitude_sensor"),
])  # fmt: skip
def test_a_sensor_that_shakes_is_unknown_in_that_sensor(channel, amplitude, block):
    found = diagnose(shaken(channel, amplitude), Aircraft())
    assert found.verdict == "unknown"
    assert found.where.block == block


def test_an_accelerometer_that_an_engine_shakes_no_louder_than_its_noise_is_nothing():
    found = diagnose(shaken("a_z", 0.15), Aircraft())
    assert found.verdict == "none"
