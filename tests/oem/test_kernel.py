import numpy as np
import pytest
from scipy.linalg import expm

from advisor.model.outputs import LOCAL, N_PARAMETERS, SHARED
from advisor.model.response import respond
from advisor.model.transition import WIDTH, divisions, fill
from advisor.oem.problem import OutputErrorProblem, Record, assemble
from advisor.oem.rows import Signal
from tests.oem.builders import JET, UAV, simulate

MATRICES = [
    np.array([[-0.48, 1.1], [-4.9, -2.0]]),
    np.array([[-8.0, 0.97], [-48.0, -4.2]]),
    np.array([[-3.0, 1.0], [2.0, -1.0]]),  # statically unstable
    np.array([[-2.0, 1.0], [0.0, -2.0]]),  # a double eigenvalue, defective
    np.zeros((2, 2)),
    np.array([[0.0, 1.0], [0.0, 0.0]]),  # singular
]


def phi(a, h, k):
    """hᵏφₖ(hA) from the exponential of a larger matrix."""
    big = np.zeros((2 * (k + 1), 2 * (k + 1)))
    big[:2, :2] = a
    for i in range(k):
        big[2 * i : 2 * i + 2, 2 * i + 2 : 2 * i + 4] = np.eye(2)
    return expm(big * h)[:2, 2 * k :]


@pytest.mark.parametrize("a", MATRICES)
@pytest.mark.parametrize("h", [1e-6, 0.02, 0.15])
def test_the_step_is_the_matrix_exponential_and_its_integrals(a, h):
    row = np.empty(WIDTH)
    fill(row, *a.ravel(), h)
    for k in range(4):
        np.testing.assert_allclose(
            row[13 * k : 13 * k + 4].reshape(2, 2), phi(a, h, k), rtol=1e-12, atol=1e-18
        )


def test_a_long_step_is_divided_and_an_absurd_one_refused():
    assert divisions(-8.0, 1.0, -48.0, -4.0, 0.02) == 1
    assert divisions(-8.0, 1.0, -48.0, -4.0, 1.0) > 5
    assert divisions(np.nan, 1.0, -48.0, -4.0, 0.02) == 0
    assert divisions(-1e6, 1.0, -48.0, -4.0, 1.0) == 0


def problem_with_everything():
    """Return two records with all outputs, speed, irregular stamps, gaps, servo, vane and accelerometer."""
    rng = np.random.default_rng(3)
    records = []
    for k in range(2):
        t = np.sort(rng.uniform(0.0, 6.0, 150))
        u = np.where(np.sin(1.5 * t + k) > 0, 0.03, -0.02)
        stamps = {n: np.sort(rng.uniform(0.3, 5.8, 90)) for n in ("alpha", "q", "a_z", "theta")}
        stamps["q"] = stamps["q"][(stamps["q"] < 2.0) | (stamps["q"] > 2.9)]
        records.append(
            Record(
                elevator=Signal(t, u),
                outputs={n: Signal(s, np.zeros(len(s))) for n, s in stamps.items()},
                airspeed=Signal(t, 25 + 3 * np.sin(0.8 * t)),
                normal_gravity=Signal(t, np.cos(0.2 * np.sin(0.5 * t))),
            )
        )
    return OutputErrorProblem(
        tuple(records), reference_airspeed_m_s=26.0, vane_arm_m=0.4, accelerometer_arm_m=0.1
    )


def test_sensitivities_are_the_derivatives_of_the_outputs():
    assembly = assemble(problem_with_everything())
    shared = np.append(UAV[[1, 2, 3, 5, 6, 7]], 0.04)
    local = np.array([[0.05, 0.4, 0.05, 0.1, 0.02, 0.01, 0.2], [0.03, 0.5, 0.04, -0.1, 0.1, -0.02, 0.1]])
    n = len(assembly.z)
    y, g = np.empty(n), np.empty((n, N_PARAMETERS))
    assert respond(assembly.grid, shared, local, y, g)

    def outputs(step):
        moved = np.empty(n)
        assert respond(assembly.grid, shared + step[:7], local + step[7:], moved, np.empty((0, N_PARAMETERS)))
        return moved

    for j, name in enumerate((*SHARED, *LOCAL)):
        step = np.zeros(N_PARAMETERS)
        step[j] = 1e-5
        slope = (outputs(step) - outputs(-step)) / 2e-5
        np.testing.assert_allclose(g[:, j], slope, rtol=1e-6, atol=1e-7 * np.abs(slope).max(), err_msg=name)


@pytest.mark.parametrize("theta", [JET, UAV, np.array([0.0, 0.3, 0.0, 0.1, 0.0, 0.5, 0.1, -3.0])])
def test_the_response_is_exact_at_irregular_stamps_and_over_gaps(theta):
    rng = np.random.default_rng(5)
    t = np.sort(rng.uniform(0.0, 4.0, 30))
    u = rng.normal(0.0, 0.03, 30)
    stamps = {n: np.sort(rng.uniform(0.2, 3.9, 20)) for n in ("alpha", "q", "theta")}
    first = min(s[0] for s in stamps.values())
    record = Record(Signal(t, u), {n: Signal(s, np.zeros(20)) for n, s in stamps.items()})
    assembly = assemble(OutputErrorProblem((record,)))
    y = np.empty(len(assembly.z))
    local = np.array([[theta[0], theta[4], 0.04, 0.1, 0.2, 0.0, 0.0]])
    assert respond(
        assembly.grid, np.append(theta[[1, 2, 3, 5, 6, 7]], 0.0), local, y, np.empty((0, N_PARAMETERS))
    )
    for name, column, offset in (("alpha", 0, 0.0), ("q", 1, 0.0), ("theta", 2, 0.2)):
        truth = (
            simulate(theta, [0.04, 0.1], t, u, np.concatenate([[first], stamps[name]]))[1:, column] + offset
        )
        np.testing.assert_allclose(y[assembly.rows[0][name]], truth, rtol=1e-9, atol=1e-11)


def test_parameters_that_run_away_are_reported_not_returned():
    assembly = assemble(problem_with_everything())
    y = np.empty(len(assembly.z))
    shared = np.array([90.0, 0.0, 0.0, 50.0, 90.0, 1.0, 0.0])
    assert not respond(assembly.grid, shared, np.ones((2, 7)), y, np.empty((0, N_PARAMETERS)))


def test_a_sample_at_the_end_of_a_chain_of_nearly_equal_stamps_keeps_its_row():
    t = np.arange(0.0, 1.0, 0.02)
    late = t + 1.6e-9
    outputs = {
        "alpha": Signal(t, 0.0 * t),
        "q": Signal(late, 0.0 * t),
        "a_z": Signal(t + 0.8e-9, 0.0 * t),
    }
    assembly = assemble(OutputErrorProblem((Record(Signal(t, 0.0 * t), outputs),)))
    assert np.max(np.abs(assembly.events[assembly.grid.row[1] >= 0] - late)) < 2e-9
    assert sorted(assembly.grid.row[assembly.grid.row >= 0]) == list(range(3 * len(t)))
