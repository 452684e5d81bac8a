import numpy as np
import pytest

from advisor.bundled.study.batch import solve_many
from advisor.oem.problem import OutputErrorProblem, Record
from advisor.oem.rows import Signal
from advisor.oem.solution import solve
from tests.oem.builders import JET, elevator_3211, simulate, trim_alpha, trim_elevator

T = np.arange(0.0, 10.0, 0.04)
ELEVATOR = Signal(T, elevator_3211(T, trim=trim_elevator(JET), amplitude=0.03))
CLEAN = simulate(JET, [trim_alpha(JET), 0.0], T, ELEVATOR.y, T)


def copies(n, noise, seed=0):
    rng = np.random.default_rng(seed)
    spread = noise * CLEAN.std(axis=0)
    return tuple(CLEAN[:, c] + spread[c] * rng.standard_normal((n, len(T))) for c in (0, 1))


@pytest.fixture(scope="module", autouse=True)
def compiled():
    """The batch's function is compiled once on a machine, which is no test's time."""
    solve_many(ELEVATOR, T, *copies(1, 0.05))


def test_a_batch_gives_what_each_manoeuvre_gives_alone():
    alpha, q = copies(6, 0.05)
    batch = solve_many(ELEVATOR, T, alpha, q)
    for i in range(6):
        alone = solve(
            OutputErrorProblem((Record(ELEVATOR, {"alpha": Signal(T, alpha[i]), "q": Signal(T, q[i])}),))
        )
        np.testing.assert_allclose(batch.theta[i], alone.theta, rtol=1e-6, atol=1e-8)
        np.testing.assert_allclose(batch.std_cr[i], np.sqrt(np.diag(alone.covariance_cr)), rtol=1e-5)
        np.testing.assert_allclose(batch.cost[i], alone.cost, rtol=1e-9)


def test_the_scatter_of_many_estimates_is_the_bound():
    batch = solve_many(ELEVATOR, T, *copies(1500, 0.05))
    assert batch.failed == 0
    scatter = np.sqrt(np.mean((batch.theta - JET) ** 2, axis=0))
    np.testing.assert_allclose(scatter, np.sqrt(np.mean(batch.std_cr**2, axis=0)), rtol=0.07)


def test_rows_without_information_are_nan_and_counted():
    still = Signal(T, np.full(len(T), 0.05))
    flat = np.zeros((3, len(T)))
    batch = solve_many(still, T, flat, flat)
    assert batch.failed == 3
    assert np.isnan(batch.theta).all()
