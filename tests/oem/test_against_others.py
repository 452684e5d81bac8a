"""Independent codes on the same data: lmfit with its profile likelihood, scipy's matrix exponential."""

import lmfit
import numpy as np
import pytest
from scipy.linalg import expm

from advisor.aircraft.reference import PARAMETERS
from advisor.model.short_period import ShortPeriod
from advisor.oem.problem import OutputErrorProblem, Record
from advisor.oem.rows import Signal
from advisor.oem.solution import solve
from benchmarks.accuracy import JET, clean


def measured():
    t, u, response = (x[:330] for x in clean())
    z = response + 0.05 * response.std(axis=0) * np.random.default_rng(3).standard_normal(response.shape)
    return t, u, z


def residuals(values, t, u, z, sigma):
    """Weighted residuals of a model solved step by step with scipy's matrix exponential."""
    p = values.valuesdict()
    big = np.zeros((5, 5))
    big[0] = [p["Z_alpha"], 1 + p["Z_q"], p["Z_delta_e"], 0, p["Z_0"]]
    big[1] = [p["M_alpha"], p["M_q"], p["M_delta_e"], 0, p["M_0"]]
    big[2, 3] = 1.0
    h = t[1] - t[0]
    step = expm(big * h)[:2]
    x = np.array([p["alpha_0"], p["q_0"]])
    y = [x]
    for k in range(len(t) - 1):
        x = step @ np.array([x[0], x[1], u[k], (u[k + 1] - u[k]) / h, 1.0])
        y.append(x)
    return ((z - np.array(y)) / sigma).ravel()


@pytest.fixture(scope="module")
def both():
    t, u, z = measured()
    ours = solve(
        OutputErrorProblem((Record(Signal(t, u), {"alpha": Signal(t, z[:, 0]), "q": Signal(t, z[:, 1])}),))
    )
    start = lmfit.Parameters()
    for name, value in zip(PARAMETERS, JET, strict=True):
        start.add(name, value=0.9 * value)
    start.add("alpha_0", value=z[0, 0])
    start.add("q_0", value=z[0, 1])
    sigma = ours.optimum.noise[:2]
    problem = lmfit.Minimizer(residuals, start, fcn_args=(t, u, z, sigma), scale_covar=False)
    return ours, problem, problem.leastsq(ftol=1e-12, xtol=1e-12)


def test_lmfit_finds_the_same_parameters_and_errors(both):
    ours, _, theirs = both
    for j, name in enumerate(PARAMETERS):
        std = np.sqrt(ours.covariance_cr[j, j])
        assert theirs.params[name].value == pytest.approx(ours.theta[j], abs=2e-3 * std)
        assert theirs.params[name].stderr == pytest.approx(std, rel=0.01)


@pytest.mark.parametrize("side", [-2.0, 2.0])
def test_the_profile_likelihood_by_lmfit_rises_as_the_interval_says(both, side):
    ours, problem, theirs = both
    j = PARAMETERS.index("M_alpha")
    held = theirs.params.copy()
    held["M_alpha"].set(value=ours.theta[j] + side * np.sqrt(ours.covariance_cr[j, j]), vary=False)
    away = problem.leastsq(held, ftol=1e-12, xtol=1e-12)
    assert away.chisqr - theirs.chisqr == pytest.approx(side**2, rel=0.05)


def test_the_frequency_is_that_of_the_eigenvalues():
    model = ShortPeriod(JET)
    first, _ = model.eigenvalues
    assert model.natural_frequency == pytest.approx(abs(first))
    assert np.isnan(ShortPeriod(np.array([0, -1.0, 0, 0, 0, 5.0, -1.0, -3.0])).natural_frequency)


def test_parameters_left_out_are_zero():
    lone = ShortPeriod.from_mapping({"M_q": -2.0}).theta
    assert lone[6] == -2.0
    assert np.count_nonzero(lone) == 1
