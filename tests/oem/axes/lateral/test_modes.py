import numpy as np
import pytest

from advisor.model.axes.lateral import LATERAL, Trim, modes_of, state_matrix
from advisor.oem.axes.lateral.estimator import Errors, lateral_modes
from tests.oem.axes.lateral.builders import JET, vector

TRIM = Trim(130.0, 0.07, 0.105)
N = len(LATERAL.shared)
ALONE = np.zeros((1, N))
"""Contributions of a single manoeuvre."""
EXACT = Errors(np.zeros((N, N)), ALONE)


def test_the_modes_of_a_jet_are_those_of_its_eigenvalues():
    found = lateral_modes(vector(JET), EXACT, TRIM)
    values = np.linalg.eigvals(state_matrix(vector(JET), TRIM))
    swing = values[np.argmax(values.imag)]
    assert found.dutch_roll_omega.value == pytest.approx(abs(swing))
    assert found.dutch_roll_zeta.value == pytest.approx(-swing.real / abs(swing))
    assert found.roll_time_constant.value == pytest.approx(-1.0 / min(values.real))
    assert abs(found.spiral_pole.value) < 0.05


@pytest.mark.parametrize("mode", ["dutch_roll_omega", "dutch_roll_zeta", "roll_time_constant", "spiral_pole"])
def test_the_error_of_a_mode_is_the_slope_times_the_error_of_a_derivative(mode):
    def value(theta):
        return getattr(lateral_modes(theta, EXACT, TRIM), mode).value

    for k in range(N):
        step = np.zeros(N)
        step[k] = 1e-6
        slope = (value(vector(JET) + step) - value(vector(JET) - step)) / 2e-6
        covariance = np.zeros((N, N))
        covariance[k, k] = 0.01
        stated = getattr(lateral_modes(vector(JET), Errors(covariance, ALONE), TRIM), mode).std
        assert stated == pytest.approx(0.1 * abs(slope), rel=1e-4, abs=1e-8)


def test_an_error_that_all_manoeuvres_have_in_common_adds_to_that_of_the_noise():
    covariance = np.diag(np.full(N, 0.01))
    by_noise, common, both = (
        lateral_modes(vector(JET), one, TRIM).roll_time_constant.std
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
    found = lateral_modes(coupled, EXACT, TRIM)
    assert modes_of(state_matrix(coupled, TRIM)).roll is None
    assert found.roll_time_constant is None
    assert "oscillate together" in found.left_out["roll"]


def test_the_error_of_a_mode_holds_the_scatter_of_the_mode_between_manoeuvres():
    covariance = np.diag(np.full(N, 1e-6))
    apart = np.zeros((2, N))
    apart[:, LATERAL.names.reported.index("N_beta")] = (0.1, -0.1)
    alone = lateral_modes(vector(JET), Errors(covariance, ALONE), TRIM).dutch_roll_omega
    joined = lateral_modes(vector(JET), Errors(covariance, apart), TRIM).dutch_roll_omega
    assert joined.std > 20.0 * alone.std


def test_a_mode_without_scatter_of_its_own_grows_as_the_derivatives_do_on_average():
    valley = np.zeros(N)
    valley[LATERAL.names.reported.index("Y_delta_a")] = 1.0
    covariance = np.diag(np.full(N, 1e-6))
    alone = lateral_modes(vector(JET), Errors(covariance, ALONE), TRIM).dutch_roll_omega
    joined = lateral_modes(vector(JET), Errors(covariance, 0.01 * np.array([valley, -valley])), TRIM)
    growth = (N - 1.0 + 2.0 * 2.0 * 0.01**2 / 1e-6) / N
    assert joined.dutch_roll_omega.std == pytest.approx(growth**0.5 * alone.std)
