"""Priors of the lateral derivatives against the fits that set them and against evidence made by hand."""

import numpy as np
import pytest

from advisor.model.axes.lateral import LATERAL, natural_size
from advisor.oem.axis.search import priors_of
from tests.oem.axis.builders import JET, both_inputs, vector

FITS = {"N_p": (0.01, 0.05, 0.09, -0.3), "L_r": (0.2, 0.3, 0.3, 0.7)}
"""Derivatives over L_p on a fighter, a jet, at 3 kg and on an indoor aircraft."""


@pytest.fixture(scope="module")
def prior():
    """Return the priors of a flight with neither a lateral acceleration nor a sideslip."""
    return priors_of(both_inputs(JET, measured=("p", "r", "bank")), vector(JET))


def std(prior, name):
    return prior.std[LATERAL.names.shared.index(name)] / abs(JET["L_p"])


@pytest.mark.parametrize("name", FITS)
def test_the_fits_of_four_aircraft_lie_within_twice_the_prior(prior, name):
    assert max(map(abs, FITS[name])) < 2.0 * std(prior, name)


def test_rolling_that_yaws_as_much_as_it_damps_is_beyond_belief(prior):
    assert std(prior, "N_p") < 1.0 / 3.0


def test_poor_evidence_of_a_large_yaw_by_rolling_moves_the_estimate_little(prior):
    """The evidence says N_p = L_p, with a standard deviation as large; no aircraft has a third of it."""
    k = LATERAL.names.shared.index("N_p")
    told = 1.0 / JET["L_p"] ** 2
    estimate = (told * JET["L_p"] + prior.precision[k] * prior.mean[k]) / (told + prior.precision[k])
    assert abs(estimate / JET["L_p"]) < 0.1


def test_a_measured_side_force_needs_no_prior_of_the_moments():
    free = priors_of(both_inputs(JET, measured=("p", "r", "bank", "a_y")), vector(JET))
    for name in FITS:
        assert np.isinf(free.std[LATERAL.names.shared.index(name)])


def test_a_control_that_was_not_flown_has_a_size_as_every_derivative_has():
    theta = np.ones(15)
    theta[[LATERAL.names.reported.index(f"{letter}_delta_r") for letter in "YLN"]] = 0.0
    sizes = natural_size(theta)
    assert all(size > 0.0 for size in sizes.values())
    assert sizes["N_delta_r"] == sizes["N_beta"]
