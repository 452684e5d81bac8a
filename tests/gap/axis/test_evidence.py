"""Decisions on evidence made by hand: a line through the origin in three manoeuvres, and its alternatives."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from advisor.gap.axis import evidence
from advisor.gap.axis.evidence import gained, information_of, posterior_at, squares_of, step_of, within_bounds
from advisor.gap.axis.fit import Known
from advisor.gap.inference.marginal import marginal

SLOPE, NOISE = 2.0, 0.1
RNG = np.random.default_rng(5)
X = np.tile(np.linspace(-1.0, 1.0, 40), 3)
Z = SLOPE * X + NOISE * RNG.standard_normal(len(X))


@dataclass
class Rows:
    owner: np.ndarray
    channel: np.ndarray
    maneuvers: int = 3


@dataclass
class Line:
    """A fit with one parameter, in the form of ``Fit``."""

    slope: float
    z: np.ndarray

    @property
    def assembly(self):
        return Rows(np.repeat([0, 1, 2], 40), np.zeros(len(X), int))

    bounds = (np.array([-np.inf]), np.array([np.inf]))
    columns = X[:, None]
    weight = np.full(len(X), 1.0 / NOISE)
    noise = np.array([NOISE])

    @property
    def values(self):
        return np.array([self.slope])

    @property
    def residual(self):
        return self.z - self.slope * X

    @property
    def likelihood(self):
        return -0.5 * float(np.sum((self.residual / NOISE) ** 2))


def known(mean, std):
    return Known(np.array([mean]), np.array([std**-2]))


@pytest.mark.parametrize("share", [1.0, 0.5])
def test_the_evidence_is_the_integral_of_likelihood_times_prior(share):
    """Coloured residuals count as white ones of a larger noise."""
    line = Line(1.9, Z)
    prior = known(1.5, 0.4).prior(line.values)
    slopes = np.linspace(-1.0, 5.0, 20001)
    density = np.exp(-0.5 * ((slopes - 1.5) / 0.4) ** 2) / (0.4 * np.sqrt(2.0 * np.pi))
    likelihoods = share**2 * np.array([Line(s, Z).likelihood for s in slopes])
    top = likelihoods.max()
    integral = top + np.log(np.trapezoid(np.exp(likelihoods - top) * density, slopes))
    matrix, gradient = (np.sum(part, axis=0) for part in information_of(line, share))
    found = marginal(share**2 * line.likelihood, matrix, gradient, prior, prior).right
    # The closed form leaves out the factor (2π)^½ that all models share.
    assert found == pytest.approx(integral, abs=1e-3)


def test_a_parameter_that_ends_at_its_bound_counts_beside_it():
    """The bound lies below the optimum: only the values below it are integrated."""
    line, prior = Line(1.9, Z), known(1.5, 0.4)
    line.bounds = (np.array([-np.inf]), np.array([1.95]))
    whole = information_of(line, 1.0)
    inside, nats = within_bounds(line, whole, prior)
    step = np.linspace(-1.0, 0.05, 200001)
    each = whole.gradient.sum() * step - 0.5 * whole.matrix.sum() * step**2
    each -= 0.5 * ((1.9 + step - 1.5) / 0.4) ** 2
    integral = each.max() + np.log(np.trapezoid(np.exp(each - each.max()), step))
    matrix, gradient = (np.sum(part, axis=0) for part in inside)
    found = marginal(nats, matrix, gradient, *(prior.prior(line.values),) * 2).right
    assert found == pytest.approx(integral - 0.5 * np.log(2.0 * np.pi * 0.4**2), abs=1e-3)


def test_the_posterior_lies_between_prior_and_data_by_their_information():
    line = Line(0.0, Z)
    information = np.sum((X / NOISE) ** 2)
    step = step_of(line, information_of(line, 1.0), known(0.0, information**-0.5))
    assert step[0] == pytest.approx(0.5 * np.sum(X * Z) / np.sum(X**2))


@pytest.mark.parametrize(
    ("scatter", "systematic", "std"), [(0.0, 0.0, 0.1), (0.0, 0.24, 0.5), (0.4, 0.0, 0.69)]
)
def test_an_error_contains_the_scatter_of_the_manoeuvres_and_the_dynamics_that_the_model_lacks(
    monkeypatch, scatter, systematic, std
):
    """Three manoeuvres pull by ±0.4 and 0: their sum scatters by 0.4·(2·3/2)^½."""
    told = {
        "covariance": np.array([[0.01]]), "systematic": np.array([[systematic]]),
        "contributions": scatter * np.array([[-1.0], [0.0], [1.0]]),
    }  # fmt: skip
    asked = []
    monkeypatch.setattr(evidence, "errors_of", lambda *given, **named: asked.append((given, named)) or told)
    line = Line(0.0, Z)
    line.point = SimpleNamespace(theta=np.zeros(1))
    line.slopes, line.sensitivities, line.fitted = np.empty((len(Z), 0)), None, None
    _, found = posterior_at(line, known(0.0, 1.0), 0.5)
    assert found[0] == pytest.approx(std, abs=0.01)
    ((given, named),) = asked
    # Coloured residuals count half, so the prior is as much narrower in the white-noise fit.
    assert (given[-1], named["prior_share"]) == (pytest.approx([4.0]), 0.5)


def test_a_manoeuvre_that_stands_alone_is_predicted_worse_than_it_is_fitted():
    z = Z.copy()
    z[80:] += 1.0 * X[80:]
    left = squares_of(Line(SLOPE, z), information_of(Line(SLOPE, z), 1.0), known(0.0, 100.0))
    assert left.held_out[2, 0] > 1.5 * left.in_fit[2, 0]
    assert left.held_out[0, 0] > left.in_fit[0, 0]


def test_a_gain_in_one_manoeuvre_alone_has_a_large_standard_error():
    counts = np.array([300.0])
    before = np.array([[2.0], [2.0], [2.0]])
    everywhere = gained(before, before / 2.0, counts, 1.0)
    once = gained(before, np.array([[0.2], [1.4], [1.4]]), counts, 1.0)
    assert everywhere.value == pytest.approx(once.value)
    assert everywhere.std == pytest.approx(0.0)
    assert once.std > 0.5 * once.value


def test_coloured_noise_makes_every_nat_count_less():
    counts, before = np.array([300.0]), np.array([[2.0], [2.0], [2.0]])
    white, coloured = (gained(before, before / 2.0, counts, share).value for share in (1.0, 0.5))
    assert coloured == pytest.approx(white / 4.0)
