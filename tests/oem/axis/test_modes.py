import numpy as np
import pytest

from advisor.model.axes.lateral import LATERAL, Trim, state_matrix
from advisor.model.axes.lateral import modes_of as eigenmodes
from advisor.oem.axis.estimator import Errors, modes_of
from tests.oem.axis.builders import JET, vector

TRIM = Trim(130.0, 0.07, 0.105)
N = len(LATERAL.shared)
ALONE = np.zeros((1, N))
"""Contributions of a single manoeuvre."""
EXACT = Errors(np.zeros((N, N)), ALONE)


def test_the_modes_of_a_jet_are_those_of_its_eigenvalues():
    found, _ = modes_of(LATERAL, vector(JET), EXACT, TRIM.around)
    values = np.linalg.eigvals(state_matrix(vector(JET), TRIM))
    swing = values[np.argmax(values.imag)]
    assert found["dutch_roll_omega"].value == pytest.approx(abs(swing))
    assert found["dutch_roll_zeta"].value == pytest.approx(-swing.real / abs(swing))
    assert found["roll_time_constant"].value == pytest.approx(-1.0 / min(values.real))
    assert abs(found["spiral_pole"].value) < 0.05


@pytest.mark.parametrize("mode", ["dutch_roll_omega", "dutch_roll_zeta", "roll_time_constant", "spiral_pole"])
def test_the_error_of_a_mode_is_the_slope_times_the_error_of_a_derivative(mode):
    def value(theta):
        return modes_of(LATERAL, theta, EXACT, TRIM.around)[0][mode].value

    for k in range(N):
        step = np.zeros(N)
        step[k] = 1e-6
        slope = (value(vector(JET) + step) - value(vector(JET) - step)) / 2e-6
        covariance = np.zeros((N, N))
        covariance[k, k] = 0.01
        stated = modes_of(LATERAL, vector(JET), Errors(covariance, ALONE), TRIM.around)[0][mode].std
        assert stated == pytest.approx(0.1 * abs(slope), rel=1e-4, abs=1e-8)


def test_an_error_that_all_manoeuvres_have_in_common_adds_to_that_of_the_noise():
    covariance = np.diag(np.full(N, 0.01))
    by_noise, common, both = (
        modes_of(LATERAL, vector(JET), one, TRIM.around)[0]["roll_time_constant"].std
        for one in (
            Errors(covariance, ALONE),
            Errors(np.zeros((N, N)), ALONE, covariance),
            Errors(covariance, ALONE, covariance),
        )
    )
    assert common == pytest.approx(by_noise)
    assert both == pytest.approx(2.0**0.5 * by_noise)


def test_roll_and_spiral_that_oscillate_together_are_told_as_such():
    coupled = vector(JET | {"L_p": -0.3, "L_beta": -10.0, "L_r": 0.3, "N_p": 0.2})
    found, left_out = modes_of(LATERAL, coupled, EXACT, TRIM.around)
    assert eigenmodes(state_matrix(coupled, TRIM)).roll is None
    assert "roll_time_constant" not in found
    assert "oscillate together" in left_out["roll"]


def test_the_error_of_a_mode_holds_the_scatter_of_the_mode_between_manoeuvres():
    covariance = np.diag(np.full(N, 1e-6))
    apart = np.zeros((2, N))
    apart[:, LATERAL.names.reported.index("N_beta")] = (0.1, -0.1)
    alone = modes_of(LATERAL, vector(JET), Errors(covariance, ALONE), TRIM.around)[0]["dutch_roll_omega"]
    joined = modes_of(LATERAL, vector(JET), Errors(covariance, apart), TRIM.around)[0]["dutch_roll_omega"]
    assert joined.std > 20.0 * alone.std


def test_a_mode_without_scatter_of_its_own_grows_as_the_derivatives_do_on_average():
    valley = np.zeros(N)
    valley[LATERAL.names.reported.index("Y_delta_a")] = 1.0
    covariance = np.diag(np.full(N, 1e-6))
    alone = modes_of(LATERAL, vector(JET), Errors(covariance, ALONE), TRIM.around)[0]["dutch_roll_omega"]
    joined = modes_of(
        LATERAL, vector(JET), Errors(covariance, 0.01 * np.array([valley, -valley])), TRIM.around
    )
    growth = (N - 1.0 + 2.0 * 2.0 * 0.01**2 / 1e-6) / N
    assert joined[0]["dutch_roll_omega"].std == pytest.approx(growth**0.5 * alone.std)
