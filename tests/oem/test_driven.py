"""Unknown forces in an estimate: right where gusts or a propeller drive the aircraft, absent where not."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.linalg import expm

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.campaign.single_maneuver import assess, cautions_of
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem import estimator
from advisor.oem.driven_motion.estimate import Driven, driven
from advisor.oem.driven_motion.kalman_filter import driven_filter, filtered_by_each
from advisor.oem.driven_motion.likeliest_noise import first_noise
from advisor.oem.driven_motion.setting import Model
from advisor.oem.estimate import Estimate
from advisor.oem.estimator import estimate
from advisor.oem.instrument_fit import PITCH
from advisor.oem.prepare import Prepared, prepare
from advisor.oem.prior import about_zero, precision
from advisor.oem.solution import Solution, solve
from advisor.oem.surface import Servo
from tests.oem.builders import UAV, Array, elevator_3211, maneuver, trim_alpha, trim_elevator

KNOWN_SERVO = Aircraft(elevator=Elevator(lag_s=0.0, delay_s=0.0))
STEP_S, SPEED = 0.005, 25.0
M_ALPHA, M_DELTA = 5, 7


def flown(gust_rad: float, seed: int, memory_s: float = 0.6, shaken: float = 0.0) -> Maneuver:
    """Return a 3-2-1-1 through first-order Gauss-Markov gusts, by the general matrix exponential at 200 Hz.

    ``shaken`` is the root of the intensity of white noise on the pitch acceleration, rad/s^1.5.
    """
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
    jolts = shaken * np.sqrt(STEP_S) * np.random.default_rng(seed + 1).standard_normal(len(t))
    for i in range(len(t) - 1):
        x[i + 1] = whole[:2, :2] @ x[i] + whole[:2, 2:] @ (drive[i] + drive[i + 1]) / 2.0
        x[i + 1, 1] += jolts[i]
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


def driven_from(solution: Solution) -> Driven | None:
    return driven(solution, PITCH, (), lambda problem, shared: about_zero(precision(problem, shared)))


def estimates(seeds: range, **air: float) -> tuple[Array, Array, Array]:
    """Return output error's values, the values with unknown forces and their standard deviations, (n, 8)."""
    output, filtered, std = [], [], []
    for seed in seeds:
        first = solved(flown(seed=seed, **air))
        second = driven_from(first)
        assert second is not None
        output.append(first.theta)
        filtered.append(second.solution.theta)
        std.append(np.sqrt(np.diag(second.solution.covariance)))
    return np.array(output), np.array(filtered), np.array(std)


@cache
def disturbed(kind: str) -> tuple[Array, Array, Array]:
    return estimates(
        range(8), **({"gust_rad": 0.01} if kind == "gusts" else {"gust_rad": 0.0, "shaken": 0.05})
    )


def test_in_gusts_derivatives_scatter_less_than_output_errors() -> None:
    output, filtered, _ = disturbed("gusts")

    def scatter(values: Array) -> Array:
        error = values[:, [M_ALPHA, M_DELTA]] - UAV[[M_ALPHA, M_DELTA]]
        return np.asarray(np.sqrt(np.mean(error**2, axis=0)))

    assert np.all(scatter(filtered) < 0.3 * scatter(output))


@pytest.mark.parametrize("kind", ["gusts", "jolts"])
def test_errors_lie_between_a_third_and_twice_of_their_standard_deviations(kind: str) -> None:
    _, filtered, std = disturbed(kind)
    ratio = np.sqrt(np.mean(((filtered - UAV) / std) ** 2, axis=0))[[M_ALPHA, M_DELTA]]
    assert np.all(ratio > 1.0 / 3.0)
    assert np.all(ratio < 2.0)


@pytest.mark.parametrize("seed", range(3))
def test_still_air_has_no_unknown_forces(seed: int) -> None:
    assert driven_from(solved(flown(0.0, seed))) is None


@pytest.mark.parametrize("gust_deg", [0.5, 1.0, 2.0])
def test_the_size_of_the_gusts_is_found(gust_deg: float) -> None:
    found = driven_from(solved(flown(np.radians(gust_deg), 3)))
    assert found is not None
    assert np.degrees(found.noise.gust) == pytest.approx(gust_deg, rel=0.6)


def test_the_size_of_jolts_is_found() -> None:
    found = driven_from(solved(flown(0.0, 3, shaken=0.05)))
    assert found is not None
    assert found.noise.drive[1] == pytest.approx(0.05, rel=0.3)
    assert found.gust_rad is None


def test_no_other_size_of_one_noise_is_clearly_likelier() -> None:
    start = solved(flown(0.01, 4))
    model = Model(PITCH, (), lambda problem, shared: about_zero(precision(problem, shared)))
    setting = model.at(start.problem, start.optimum.shared, start.optimum.local)
    assert setting is not None
    noise = first_noise(setting)
    moves = 0.3 * np.concatenate([np.eye(len(noise.logarithms)), -np.eye(len(noise.logarithms))])
    costs = [setting.cost(noise.at(noise.logarithms + move)) for move in moves]
    assert min(costs) > setting.cost(noise) - 4.0


def test_innovations_of_a_driven_motion_are_white() -> None:
    rng, step, n = np.random.default_rng(1), 0.02, 4000
    matrix, memory_s = np.array([[0.0, 1.0], [-9.0, -1.0]]), 0.5
    x, noise, rows = np.zeros(2), 0.0, np.empty((n, 1))
    once, keep = expm(matrix * step / 10), np.exp(-step / memory_s)
    for i in range(n):
        for _ in range(10):
            x = once @ x + [0.0, np.sqrt(step / 10) * rng.standard_normal()]
        noise = keep * noise + 0.02 * np.sqrt(1.0 - keep**2) * rng.standard_normal()
        rows[i] = x[0] + noise + 0.01 * rng.standard_normal()
    kind, zero = np.ones(n, np.int64), np.zeros(n, np.int64)
    kind[0] = 0
    driving = matrix, np.zeros(2), np.array([0.0, 1.0])
    at = (np.array([0.0, step]), kind), zero, np.array([[1.0, 0.0]]), driving
    white = driven_filter(*at, np.full(n, 1e-4), np.array([0.02]), memory_s).innovations(rows)
    assert np.mean(white**2) == pytest.approx(1.0, abs=0.1)
    assert abs(float(white[1:, 0] @ white[:-1, 0])) / n < 0.05


def test_one_column_has_the_innovations_that_it_has_among_several() -> None:
    rng, n = np.random.default_rng(2), 300
    kind, channel = np.tile([1, 0, 2], n // 3), np.tile([0, 1, 0], n // 3)
    driving = np.array([[-1.0, 1.0], [-9.0, -2.0]]), np.array([0.1, 0.2]), np.array([0.0, 1.0])
    at = (np.array([0.0, 0.02, 0.05]), kind), channel, np.array([[1.0, 0.0], [0.3, 1.0]]), driving
    gains = driven_filter(*at, np.full(n, 1e-4), np.array([0.02, 0.03]), 0.5)
    columns, order = rng.standard_normal((n, 3)), rng.permutation(n)
    among = gains.innovations(columns, order)
    assert np.allclose(gains.innovations(columns[:, 1:2], order), among[:, 1:2], rtol=1e-9, atol=1e-9)


def test_noises_abreast_give_the_innovations_that_each_gives_alone() -> None:
    rng, n = np.random.default_rng(3), 300
    kind, channel = np.tile([1, 0, 2], n // 3), np.tile([0, 1, 0], n // 3)
    at = (np.array([0.0, 0.02, 0.05]), kind), channel, np.array([[1.0, 0.0], [0.3, 1.0]])
    column, sizes = rng.standard_normal(n), rng.uniform(0.5, 2.0, (11, 5))
    driving = [(np.array([[-x, 1.0], [-9.0, -2.0]]), np.array([y, 0.2]), sizes[0, :2]) for x, y, *_ in sizes]

    def by(k: slice) -> np.ndarray:
        noises = driving[k], 1e-2 * sizes[k, 1:3], 0.1 * sizes[k, 2:4], sizes[k, 4]
        return np.array(filtered_by_each(*at, *noises, column))

    apart = [by(slice(k, k + 1)) for k in range(len(sizes))]
    assert np.allclose(by(slice(None)), np.concatenate(apart, axis=-1), rtol=1e-9, atol=1e-9)


def test_in_moving_air_the_estimate_has_unknown_forces_and_in_still_air_none() -> None:
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


@pytest.mark.parametrize(("index", "value"), [(0, 30.0), (4, -1000.0), (3, np.inf)])
@pytest.mark.filterwarnings("ignore:overflow:RuntimeWarning", "ignore:invalid value:RuntimeWarning")
def test_a_model_that_runs_away_gives_no_estimate_instead_of_a_fault(index: int, value: float) -> None:
    first = solved(flown(0.01, 1))
    shared = first.optimum.shared.copy()
    shared[index] = value
    found = driven_from(replace(first, optimum=first.optimum._replace(shared=shared)))
    assert found is None or np.all(np.isfinite(found.solution.theta))


def test_a_search_that_diverges_from_the_instruments_starts_again_without_them(monkeypatch):
    starts = []

    def diverges_once(solution, *others):
        starts.append(solution)
        return None if len(starts) == 1 else driven(solution, *others)

    monkeypatch.setattr(estimator, "driven", diverges_once)
    found = estimate(flown(0.02, seed=3), KNOWN_SERVO)
    assert isinstance(found, Estimate)
    assert found.filtered
    assert starts[1].problem.servo == Servo(0.0, 0.0)
