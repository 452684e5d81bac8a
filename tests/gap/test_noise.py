"""The noise of a flight: what neighbouring samples have in common is found, and counted once."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.candidates.known import variants_for
from advisor.gap.fitting.fit import fit
from advisor.gap.fitting.whitening import Filters
from advisor.gap.noise.stamps import rates_of, stamp_jitter
from advisor.gap.records.prepare import prepare
from advisor.gap.search.air import moving_air
from advisor.gap.search.baseline import fit_baseline
from advisor.oem.driven_motion.setting import Noise
from advisor.oem.short_period_motion import short_period_motion
from advisor.oem.turbulence import Rows, cost_of
from tests.gap.generator import Setup, fly
from tests.maneuvers import changed

SYSTEM = np.array([-4.3, -0.03, -37.0, -4.8])
SPEED = 22.0
MOTION = short_period_motion(SYSTEM, SPEED)


def noise(white, coloured, memory_s, gust, gust_memory_s):
    """Return noise without jolts."""
    return Noise(white, coloured, memory_s, np.zeros(1), gust, gust_memory_s)


def merged(n: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return irregular stamps of all four channels in order of time, in tenths of milliseconds."""
    rng = np.random.default_rng(seed)
    t = np.sort(rng.integers(0, 30_000, 4 * n)) * 1e-4
    return t, rng.permutation(np.repeat(np.arange(4), n)).astype(np.int64)


def test_innovations_of_coloured_instruments_agree_with_their_covariance_matrix():
    t, channel = merged(40, 1)
    white, coloured = np.array([0.001, 0.002, 0.05, 0.001]), np.array([0.002, 0.001, 0.1, 0.003])
    apart = np.abs(t[:, None] - t[None, :])
    same = channel[:, None] == channel[None, :]
    dense = np.diag(white[channel] ** 2) + same * (coloured[channel] ** 2)[:, None] * np.exp(-apart / 0.2)
    left = np.random.default_rng(2).standard_normal(len(t)) * 0.003
    noises = [noise(white, coloured, 0.2, 0.0, 1.0)]
    (e,), (volume,) = map(np.transpose, Rows(t, channel, left, MOTION).terms(noises, 0.0))
    assert e @ e == pytest.approx(left @ np.linalg.solve(dense, left), rel=1e-9)
    assert np.sum(volume) == pytest.approx(np.linalg.slogdet(dense)[1], rel=1e-9)


def test_rows_before_the_motion_is_known_do_not_count_in_the_likelihood():
    t, channel = merged(40, 4)
    air = noise(np.full(4, 0.002), np.full(4, 0.001), 0.2, 0.01, 0.9)
    left = np.random.default_rng(5).standard_normal(len(t)) * 0.003
    rows = Rows(t, channel, left, MOTION)
    (e,), (volume,) = map(np.transpose, rows.terms([air], 1e3))  # a start that is not known
    assert 0 < np.count_nonzero(volume == 0.0) < 6
    assert np.all(e[volume == 0.0] == 0.0)
    assert cost_of([rows, rows], air) == pytest.approx(2.0 * (np.sum(volume) + e @ e), rel=1e-12)


def test_air_that_moves_as_assumed_leaves_white_innovations():
    rng = np.random.default_rng(3)
    h, n = 0.002, 15_000
    gust, state, columns = 0.0, np.zeros(3), []
    keep = np.exp(-h / 0.8)
    z_a, z_q, m_a, m_q = SYSTEM
    for k in range(n):
        gust = keep * gust + 0.004 * np.sqrt(1.0 - keep**2) * rng.standard_normal()
        a, q, _ = state
        if k % 10 == 0:
            force = z_a * (a + gust) + z_q * q
            columns.append((a + gust, q, SPEED * force, state[2]))
        state = state + h * np.array([z_a * (a + gust) + (1.0 + z_q) * q, m_a * (a + gust) + m_q * q, q])
    white = np.array([0.0006, 0.002, 0.05, 0.0005])
    y = np.array(columns) + white * rng.standard_normal((len(columns), 4))
    t = np.repeat(np.arange(len(y)) * 10 * h, 4)
    channel = np.tile(np.arange(4), len(y)).astype(np.int64)
    air = noise(white, np.full(4, 1e-9), 0.3, 0.004, 0.8)
    e = Rows(t, channel, y.ravel(), MOTION).terms([air], 0.0)[0][:, 0]
    assert np.mean(e**2) == pytest.approx(1.0, abs=0.05)
    for c in range(4):
        one = e[channel == c]
        assert abs(one[1:] @ one[:-1] / (one @ one)) < 0.08


@pytest.mark.study
@pytest.mark.parametrize(("jitter", "channel"), [(0.0, "q"), (0.004, "q"), (0.004, "a_z")])
def test_wrong_stamps_are_read_from_the_roughness_of_a_residual_and_uneven_ones_are_not_wrong(
    jitter, channel
):
    rng = np.random.default_rng(11)
    maneuvers = []
    for maneuver in fly(Setup(maneuvers=4, jitter=0.004, noise=0.005, seed=11)):
        whole = maneuver.channels[channel]
        stamps = np.sort(whole.t + rng.uniform(-jitter, jitter, len(whole)))
        maneuvers.append(changed(maneuver, channel, t=stamps))
    problem, fitted = fit_baseline(prepare(maneuvers, Aircraft()), Aircraft())
    found = stamp_jitter(problem, fitted, rates_of(problem, fitted))
    # Uniform over ±jitter: its standard deviation is jitter/√3.
    assert found == pytest.approx(jitter / np.sqrt(3.0), rel=0.25, abs=1e-4)


@pytest.mark.study
def test_a_gust_is_told_from_turbulence_by_the_manoeuvres_it_spared():
    flights = prepare(fly(Setup(maneuvers=6, gust_pulse=2.0, seed=12)), Aircraft())
    problem, _ = fit_baseline(flights, Aircraft())
    assert isinstance(problem.whitening, Filters)
    # A filter that allows for a gust expects larger innovations.
    expected = np.array([np.median(gains.std) for gains in problem.whitening.gains])
    moving = (expected > 1.5 * np.min(expected)).tolist()
    assert moving == [False, True, False, False, True, False]


@pytest.mark.study
def test_derivatives_are_right_although_a_gust_hit_every_third_manoeuvre():
    still = prepare(fly(Setup(maneuvers=6, seed=13)), Aircraft())
    gusty = prepare(fly(Setup(maneuvers=6, gust_pulse=2.0, seed=13)), Aircraft())
    (_, plain), (_, spoilt) = fit_baseline(still, Aircraft()), fit_baseline(gusty, Aircraft())
    assert spoilt.point.derivatives[3:] == pytest.approx(plain.point.derivatives[3:], rel=0.04)


@pytest.mark.study
def test_noise_without_a_filter_is_given_in_the_units_of_the_channels_whatever_was_thought_at_first():
    """Check that an unseen delay looks like moving air at first, and like white noise after the fit."""
    flown = fly(Setup(maneuvers=9, rate_hz=20.0, switches={"delay": 0.05}, seed=5))
    problem, fitted = fit_baseline(prepare(flown, Aircraft()), Aircraft())
    assert not problem.knows_the_noise
    assert np.all(fitted.noise < 2.0 * problem.instruments)


def gain_of_moving_air(late_s):
    """Log likelihood that moving air brings, the vane's lateness in the model."""
    flown = fly(Setup(maneuvers=5, gust_std=0.2, skew={"alpha": late_s}, seed=3))
    problem, plain = fit_baseline(prepare(flown, Aircraft()), Aircraft())
    skew = next(v for v in variants_for(problem.flights) if v.effect == "alpha_skew")
    late = plain.point.with_effect(skew, (late_s,))
    return moving_air(problem, fit(problem, late, plain.noise, 20)).gain


@pytest.mark.study
def test_gusts_are_as_plain_to_a_vane_whose_stamps_are_late_or_early_as_to_any():
    on_time = gain_of_moving_air(0.0)
    assert on_time > 1000.0
    assert [gain_of_moving_air(late_s) for late_s in (-0.09, 0.09)] == pytest.approx([on_time] * 2, rel=0.2)
