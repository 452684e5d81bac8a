"""Filter error: right where the air moves, the same as output error where it does not."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.linalg import expm

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.controls import Elevator
from advisor.campaign.single_maneuver import assess, cautions_of
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem import estimator, turbulence
from advisor.oem.estimate import Estimate
from advisor.oem.estimator import estimate
from advisor.oem.filter_error import filter_error, moving_air
from advisor.oem.prepare import Prepared, prepare
from advisor.oem.solution import Solution, solve
from advisor.oem.surface import Servo
from advisor.oem.turbulence import Rows, find_turbulence
from tests.oem.builders import UAV, Array, elevator_3211, maneuver, trim_alpha, trim_elevator

KNOWN_SERVO = Aircraft(elevator=Elevator(lag_s=0.0, delay_s=0.0))
STEP_S, SPEED = 0.005, 25.0
M_ALPHA, M_DELTA = 5, 7


def flown(gust_rad: float, seed: int, memory_s: float = 0.6) -> Maneuver:
    """Return a 3-2-1-1 through first-order Gauss-Markov gusts, by the general matrix exponential at 200
    Hz."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 10.0, STEP_S)
    trim = trim_elevator(UAV)
    u = elevator_3211(t, trim=trim, amplitude=0.03, unit_s=0.35)
    gust = np.zeros(len(t))
    keep = np.exp(-STEP_S / memory_s)
    kick = gust_rad * np.sqrt(1.0 - keep**2) * rng.standard_normal(len(t))
    for i in range(1, len(t)):
        gust[i] = keep * gust[i - 1] + kick[i]
    a = np.array([[UAV[1], 1.0 + UAV[2]], [UAV[5], UAV[6]]])
    drive = np.column_stack([UAV[1] * gust + UAV[3] * u + UAV[0], UAV[5] * gust + UAV[7] * u + UAV[4]])
    whole = expm(np.block([[a, np.eye(2)], [np.zeros((2, 4))]]) * STEP_S)
    x = np.zeros((len(t), 2))
    x[0] = [trim_alpha(UAV), 0.0]
    for i in range(len(t) - 1):
        x[i + 1] = whole[:2, :2] @ x[i] + whole[:2, 2:] @ (drive[i] + drive[i + 1]) / 2.0
    at = slice(None, None, 4)
    vane = x[at, 0] + gust[at] + 2e-4 * rng.standard_normal(len(t[at]))
    rate = x[at, 1] + 1e-3 * rng.standard_normal(len(t[at]))
    speed = np.full(len(t[at]), SPEED)
    return maneuver(1, (t, u), {"alpha": (t[at], vane), "q": (t[at], rate), "airspeed": (t[at], speed)})


def solved(flight: Maneuver, aircraft: Aircraft = KNOWN_SERVO) -> Solution:
    """Return output error's solution."""
    prepared = prepare([flight], aircraft)
    assert isinstance(prepared, Prepared)
    solution = solve(prepared.problem)
    assert isinstance(solution, Solution)
    return solution


def estimates(gust_rad: float, seeds: range) -> tuple[Array, Array, Array]:
    """Return output error's values, filter error's values and its standard deviations, each (n, 8)."""
    output, filtered, std = [], [], []
    for seed in seeds:
        first = solved(flown(gust_rad, seed))
        second = filter_error(first, moving_air(first, seen_by_alpha=True).air, ())
        assert second is not None
        output.append(first.theta)
        filtered.append(second.theta)
        std.append(np.sqrt(np.diag(second.covariance)))
    return np.array(output), np.array(filtered), np.array(std)


@cache
def in_turbulence() -> tuple[Array, Array, Array]:
    return estimates(0.01, range(12))


def test_in_turbulence_the_moment_derivatives_scatter_less_than_output_errors() -> None:
    output, filtered, _ = in_turbulence()

    def scatter(values: Array) -> Array:
        error = values[:, [M_ALPHA, M_DELTA]] - UAV[[M_ALPHA, M_DELTA]]
        return np.asarray(np.sqrt(np.mean(error**2, axis=0)))

    assert np.all(scatter(filtered) < 0.3 * scatter(output))


def test_in_turbulence_its_errors_lie_between_a_third_and_twice_of_its_standard_deviations() -> None:
    _, filtered, std = in_turbulence()
    ratio = np.sqrt(np.mean(((filtered - UAV) / std) ** 2, axis=0))[[M_ALPHA, M_DELTA]]
    assert np.all(ratio > 1.0 / 3.0)
    assert np.all(ratio < 2.0)


def test_in_still_air_it_agrees_with_output_error() -> None:
    output, filtered, std = estimates(0.0, range(100, 103))
    assert np.all(np.abs(filtered - output) < 3.0 * std)


@pytest.mark.parametrize("gust_deg", [0.5, 1.0, 2.0])
def test_the_size_of_the_gusts_is_found(gust_deg: float) -> None:
    found = moving_air(solved(flown(np.radians(gust_deg), 3)), seen_by_alpha=True)
    assert found.present
    assert np.degrees(found.gust_angle) == pytest.approx(gust_deg, rel=0.6)


def test_still_air_and_noisy_instruments_are_not_taken_for_turbulence() -> None:
    for seed in range(5):
        assert not moving_air(solved(flown(0.0, seed)), seen_by_alpha=True).present


def test_a_servo_lag_left_out_is_not_taken_for_turbulence() -> None:
    late = solved(flown(0.0, 1), Aircraft(elevator=Elevator(lag_s=0.06)))
    assert moving_air(late, seen_by_alpha=True).gust_angle < np.radians(0.5)


def test_in_moving_air_the_estimate_is_filter_errors_and_in_still_air_output_errors() -> None:
    rough, calm = estimate(flown(0.01, 4), KNOWN_SERVO), estimate(flown(0.0, 4), KNOWN_SERVO)
    assert isinstance(rough, Estimate)
    assert isinstance(calm, Estimate)
    assert rough.filtered
    assert rough.gust_rad == pytest.approx(0.01, rel=0.6)
    assert not calm.filtered
    assert calm.gust_rad is None


def test_the_verdict_says_that_the_air_moved() -> None:
    rough, calm = assess(flown(0.01, 4), KNOWN_SERVO), assess(flown(0.0, 4), KNOWN_SERVO)
    assert any("moving air, gusts of" in caution for caution in rough.cautions)
    assert not any("moving air" in caution for caution in calm.cautions)


def test_gusts_that_read_as_nothing_are_no_caution() -> None:
    maneuver = flown(0.01, 4)
    rough = estimate(maneuver, KNOWN_SERVO)
    assert isinstance(rough, Estimate)
    for gust_rad, told in ((0.0005, False), (0.01, True)):
        said = cautions_of(maneuver, replace(rough, gust_rad=gust_rad, airspeed_m_s=25.0), KNOWN_SERVO)
        assert any("moving air" in caution for caution in said) is told


@pytest.mark.parametrize("size", [0.0, 1e-14, 1e9])
def test_the_search_for_moving_air_ends_without_noise_and_with_absurd_noise(size):
    t = np.arange(0.0, 6.0, 0.02)
    rows = Rows(np.repeat(t, 4), np.tile(np.arange(4), len(t)), size * np.sin(np.arange(4.0 * len(t))), 25.0)
    found = find_turbulence([rows], np.array([-4.0, 0.0, -40.0, -4.0]), np.full(4, 1e-3), True)
    assert not found.present or size > 1.0


@pytest.mark.parametrize(("index", "value"), [(0, 30.0), (4, -1000.0), (3, np.inf)])
@pytest.mark.filterwarnings("ignore:overflow:RuntimeWarning", "ignore:invalid value:RuntimeWarning")
def test_a_model_that_runs_away_gives_no_estimate_instead_of_a_fault(index: int, value: float) -> None:
    first = solved(flown(0.01, 1))
    air = moving_air(first, seen_by_alpha=True).air
    shared = first.optimum.shared.copy()
    shared[index] = value
    away = replace(first, optimum=first.optimum._replace(shared=shared))
    found = filter_error(away, air, ())
    assert found is None or np.all(np.isfinite(found.theta))


def test_a_search_that_diverges_from_the_instruments_starts_again_without_them(monkeypatch):
    starts = []

    def diverges_once(solution, air, instruments):
        starts.append(solution)
        return None if len(starts) == 1 else filter_error(solution, air, instruments)

    monkeypatch.setattr(estimator, "filter_error", diverges_once)
    found = estimate(flown(0.02, seed=3), KNOWN_SERVO)
    assert isinstance(found, Estimate)
    assert found.filtered
    assert starts[1].problem.servo == Servo(0.0, 0.0)


@pytest.mark.parametrize(("gain", "looks"), [(4.9, False), (5.1, True)])
def test_moving_air_is_sought_where_colour_gains_five_nats_over_white_noise(monkeypatch, gain, looks):
    searches = []

    def descend(rows, system, start, moving, steps, start_variance):
        searches.append(moving)
        return start, 100.0

    monkeypatch.setattr(turbulence, "_descend", descend)
    monkeypatch.setattr(turbulence, "cost_of", lambda *_: 100.0 + 2.0 * gain)
    rows = Rows(np.arange(8.0), np.tile(np.arange(4), 2), np.ones(8), 25.0)
    find_turbulence([rows], np.array([-4.0, 0.0, -40.0, -4.0]), np.full(4, 1e-3), True)
    assert (True in searches) is looks
