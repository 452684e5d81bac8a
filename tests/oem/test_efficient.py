import numpy as np
import pytest
from scipy.linalg import toeplitz

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.controls import Elevator
from advisor.aircraft.reference import PARAMETERS
from advisor.oem.colour import Colour
from advisor.oem.covariance import cramer_rao
from advisor.oem.efficient import efficient, efficient_step
from advisor.oem.estimator import estimate, estimate_jointly
from advisor.oem.problem import OutputErrorProblem, Record
from advisor.oem.rows import Signal
from advisor.oem.solution import solve
from advisor.oem.surface import Servo
from advisor.oem.weighing import Weighing
from advisor.oem.whitening import Whitening
from benchmarks.accuracy import JET, clean, flown, noise

KNOWN = Aircraft(elevator=Elevator(lag_s=0.0))
SIZE = 0.05 * clean()[2].std(axis=0)


def coloured_noise(seed, memory=0.95):
    return SIZE * noise(np.random.default_rng(seed), clean()[2].shape, memory)


def flight(seed, memory=0.95, number=1):
    return flown(number, clean()[2] + coloured_noise(seed, memory))


def solution(response, v):
    t, u, _ = clean()
    outputs = {"alpha": Signal(t, response[:, 0] + v[:, 0]), "q": Signal(t, response[:, 1] + v[:, 1])}
    return solve(OutputErrorProblem((Record(Signal(t, u), outputs),)))


@pytest.mark.parametrize(("memory", "share"), [(0.95, 0.0), (0.8, 0.5), (0.0, 0.0), (-0.4, 0.0)])
def test_the_whitening_filter_is_the_inverse_of_the_noise_s_cholesky_factor(memory, share):
    rows = np.random.default_rng(0).standard_normal((60, 3))
    lower = np.linalg.cholesky(2.5 * (toeplitz(memory ** np.arange(60)) + share * np.eye(60)))
    whitening = Whitening.of(60, memory, share, variance=2.5)
    np.testing.assert_allclose(whitening.forward(rows), np.linalg.solve(lower, rows), atol=1e-10)
    np.testing.assert_allclose(whitening.backward(rows), np.linalg.solve(lower.T, rows), atol=1e-10)


def test_the_step_is_generalised_least_squares_with_the_full_matrix_of_the_noise():
    found = solution(clean()[2], coloured_noise(0))
    blocks = []
    for output in ("alpha", "q"):
        c = found.noise.colours[output]
        n = len(clean()[0])
        blocks.append(c.variance * (toeplitz(c.memory ** np.arange(n)) + c.white_share * np.eye(n)))
    weighed = np.concatenate(
        [np.linalg.solve(b, found.sensitivities[s][:, found.assembly.free])
         for b, s in zip(blocks, found.assembly.rows[0].values(), strict=True)]
    )  # fmt: skip
    information = weighed.T @ found.sensitivities[:, found.assembly.free]
    change = np.linalg.solve(information, weighed.T @ found.residual)
    # free: Z_alpha Z_q Z_delta_e M_alpha M_q M_delta_e Z_0 M_0 ...
    order = [6, 0, 1, 2, 7, 3, 4, 5]
    step = efficient_step(found)
    np.testing.assert_allclose(step.change, change[order], rtol=1e-5, atol=1e-9)
    exact = np.linalg.inv(information)[np.ix_(order, order)]
    widening = np.sqrt(np.diag(step.covariance) / np.diag(exact))
    assert np.all((widening >= 1.0) & (widening < 1.1))


def test_white_noise_is_weighed_as_output_error_does():
    found = solution(clean()[2], coloured_noise(0, memory=0.0))
    sigma = found.optimum.noise
    plain = {name: Colour(sigma[i] ** 2, 0.0, 0.0, np.eye(1)) for i, name in enumerate(("alpha", "q"))}
    weighing = Weighing.by(plain, found.assembly)
    rows = weighing.influence(found.sensitivities, None).rows
    np.testing.assert_allclose(rows, found.influence.rows, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(cramer_rao(found.assembly, rows, sigma), found.covariance_cr, rtol=1e-6)
    assert weighing.misfit(found.residual, found.sensitivities) == pytest.approx(len(found.residual))


@pytest.mark.study
def test_coloured_noise_costs_a_third_less_than_with_output_error():
    errors = np.array(
        [
            [e.theta - JET, e.theta_of_lowest_cost - JET]
            for e in (estimate(flight(seed), KNOWN) for seed in range(40))
            if e.theta_of_lowest_cost is not None
        ]
    )
    assert len(errors) >= 38
    ours, plain = np.mean(errors**2, axis=0)
    assert np.mean(ours / plain) < 0.85
    assert np.all(ours < 1.1 * plain)


def test_the_cost_and_the_fit_stay_those_of_the_lowest_cost():
    flew = flight(3)
    found = estimate(flew, KNOWN)
    t, u, _ = clean()
    outputs = {name: Signal(t, flew.channels[name].y) for name in ("alpha", "q")}
    servo = Servo(0.0, found.instrument("command_delay_s").value)
    plain = solve(OutputErrorProblem((Record(Signal(t, u), outputs),), servo=servo))
    assert found.cost == pytest.approx(plain.cost, rel=1e-9)
    np.testing.assert_allclose(found.theta_of_lowest_cost, plain.theta, rtol=1e-4)
    assert not np.allclose(found.theta, plain.theta, rtol=1e-3)
    rms = [found.fits[0][name].rms for name in ("alpha", "q")]
    assert np.prod(rms) ** 2 == pytest.approx(found.cost, rel=1e-6)
    assert any("generalised least squares" in note for note in found.notes)


def test_white_noise_leaves_output_error_s_own_estimate():
    kept = [estimate(flight(seed, memory=0.0), KNOWN).theta_of_lowest_cost is None for seed in range(20)]
    assert all(kept)


def test_several_manoeuvres_are_weighed_together():
    together = [flight(seed, number=seed) for seed in (1, 2, 3)]
    found = estimate_jointly(together, KNOWN)
    assert found.theta_of_lowest_cost is not None
    assert np.all(found.std < estimate(together[0], KNOWN).std)


@pytest.mark.parametrize("seed", range(3))
def test_a_residual_that_is_no_noise_is_not_weighed_as_if_it_were(seed):
    """Check that a surface lag of 60 ms, which gives slow residuals from the model, is recognised."""
    t, u, _ = clean()
    late = np.interp(t - 0.06, t, u)
    behind = clean()[2] * 0.0
    system = JET[[1, 3, 5, 7]].reshape(2, 2)
    x = np.array([np.linalg.solve(system, -JET[[0, 4]])[0], 0.0])
    for k in range(len(t)):
        behind[k] = x
        for _ in range(10):
            x = x + 0.002 * np.array(
                [
                    JET[0] + JET[1] * x[0] + (1.0 + JET[2]) * x[1] + JET[3] * late[k],
                    JET[4] + JET[5] * x[0] + JET[6] * x[1] + JET[7] * late[k],
                ]
            )
    found = solution(behind, 0.2 * coloured_noise(seed, memory=0.8))
    assert max(c.memory for c in found.noise.colours.values()) > 0.8
    assert np.min(efficient_step(found).chances) < 1e-6
    assert efficient(found) is found


def test_a_step_longer_than_right_models_allow_is_not_believed():
    """Check that a slow wave in both outputs, which resembles coloured noise, is recognised."""
    response, v = clean()[2], coloured_noise(5)
    wave = np.cos(1.5 * clean()[0])[:, None] * response.std(axis=0)
    right, bent = solution(response, v), solution(response + 0.3 * wave, v)
    assert efficient_step(right).chances[-1] > 0.01
    assert efficient_step(bent).chances[-1] < 1e-6
    assert efficient(bent) is bent


def test_every_parameter_keeps_its_place():
    step = efficient_step(solution(clean()[2], coloured_noise(1)))
    assert step.change.shape == (len(PARAMETERS),)
    assert step.covariance.shape == (len(PARAMETERS), len(PARAMETERS))


def test_an_output_of_a_few_samples_has_no_say_in_what_the_noise_remembers():
    t, u, response = clean()
    measured = response + coloured_noise(1)
    few = np.linspace(0, len(t) - 1, 20).astype(int)
    outputs = {"alpha": Signal(t[few], measured[few, 0]), "q": Signal(t, measured[:, 1])}
    with_few = efficient_step(solve(OutputErrorProblem((Record(Signal(t, u), outputs),))))
    assert np.all(np.isfinite(with_few.chances))
    assert len(with_few.chances) == len(efficient_step(solution(response, coloured_noise(1))).chances) - 1
