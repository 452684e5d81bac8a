import numpy as np
import pytest
from scipy.linalg import toeplitz

from advisor.oem.colour import Colour
from advisor.oem.covariance import Weighing, cramer_rao
from advisor.oem.problem import OutputErrorProblem, Record
from advisor.oem.rows import Signal
from advisor.oem.solution import solve
from advisor.oem.whitening import Whitening
from benchmarks.accuracy import clean, flown, noise

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


def test_white_noise_is_weighed_as_output_error_does():
    found = solution(clean()[2], coloured_noise(0, memory=0.0))
    sigma = found.optimum.noise
    plain = {name: Colour(sigma[i] ** 2, 0.0, 0.0, np.eye(1)) for i, name in enumerate(("alpha", "q"))}
    weighing = Weighing.by(plain, found.assembly)
    rows = weighing.influence(found.sensitivities, None).rows
    np.testing.assert_allclose(rows, found.influence.rows, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(cramer_rao(found.assembly, rows, sigma), found.covariance_cr, rtol=1e-6)
    assert weighing.misfit(found.residual, found.sensitivities) == pytest.approx(len(found.residual))
