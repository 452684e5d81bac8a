"""Flying qualities against formulae and simulations that do not share their code."""

import numpy as np
import pytest

from advisor.aircraft.reference import Reference
from advisor.flight.instruments.atmosphere import AirData
from advisor.oem.estimate import Estimate
from advisor.oem.flying_qualities import FlyingQualities, flying_qualities

THETA = np.array([-0.009, -0.483, 0.104, 0.676, 0.475, -4.93, -2.01, -7.21])
SPEED = 120.0
TRUE = AirData(1.0, "pressure", "true")
HEAVY = Reference(mass_kg=9000.0, chord_m=2.9, iyy_kg_m2=50_000.0, cg_percent_chord=24.0)


def estimate(theta: np.ndarray = THETA, relative: float = 0.01, **given: object) -> Estimate:
    spread = np.diag((relative * theta) ** 2)
    unknown = given.get("unknown", {})
    return Estimate(theta, spread, spread, 0.0, (), 1, unknown, (), 1.0, given.get("speed", SPEED))  # type: ignore[arg-type]


def found(theta: np.ndarray = THETA, reference: Reference = HEAVY, **given: object) -> FlyingQualities:
    return flying_qualities(estimate(theta, **given), TRUE, reference)  # type: ignore[arg-type]


def state_space(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return np.array([[t[1], 1.0 + t[2]], [t[5], t[6]]]), np.array([t[3], t[7]])


def test_frequency_and_damping_are_those_of_the_eigenvalues() -> None:
    roots = np.linalg.eigvals(state_space(THETA)[0])
    assert found().qualities["natural_frequency"].value == pytest.approx(abs(roots[0]))
    assert found().qualities["damping"].value == pytest.approx(-roots[0].real / abs(roots[0]))


def test_the_load_factor_per_angle_of_attack_is_that_of_a_held_elevator() -> None:
    a, b = state_space(THETA)
    alpha, q = np.linalg.solve(a, -b)
    assert found().qualities["n_alpha"].value == pytest.approx(SPEED * q / alpha / 9.80665)


def test_the_time_constant_is_the_zero_of_pitch_rate_to_elevator() -> None:
    a, b = state_space(THETA)
    # Rosenbrock's system matrix is singular where the transfer function is zero.
    zero = -1.0 / found().qualities["t_theta_2"].value
    system = np.block([[zero * np.eye(2) - a, -b[:, None]], [np.array([[0.0, 1.0, 0.0]])]])
    assert np.linalg.det(system) == pytest.approx(0.0, abs=1e-9)


def test_the_control_anticipation_parameter_is_initial_pitch_acceleration_over_final_load_factor() -> None:
    theta = THETA.copy()
    theta[[2, 3]] = 0.0  # Bihrle's definition is exact without lift of elevator and pitch rate
    a, b = state_space(theta)
    load = SPEED * np.linalg.solve(a, -b)[1] / 9.80665
    assert found(theta).qualities["cap"].value == pytest.approx(b[1] / load)


def test_the_intervals_are_those_of_many_draws() -> None:
    rng = np.random.default_rng(5)
    draws = rng.multivariate_normal(THETA, np.diag((0.01 * THETA) ** 2), 1000)
    many = [found(theta).qualities for theta in draws]
    for name, quality in found().qualities.items():
        assert quality.std == pytest.approx(np.std([one[name].value for one in many]), rel=0.06)


def test_the_neutral_point_lies_a_static_margin_behind_the_centre_of_gravity() -> None:
    qualities = found().qualities
    lift, moment = -THETA[1] * 9000.0 * SPEED, THETA[5] * 50_000.0 / 2.9  # per q̄·S
    assert qualities["static_margin"].value == pytest.approx(-100.0 * moment / lift)
    assert qualities["neutral_point"].value == pytest.approx(24.0 + qualities["static_margin"].value)


def test_what_is_not_given_is_named() -> None:
    left_out = found(reference=Reference(mass_kg=9000.0, chord_m=2.9)).left_out
    assert left_out["static_margin"] == "reference.iyy_kg_m2 is not given"
    assert found(speed=None).left_out["cap"] == "no air speed is known"


def test_a_parameter_that_cannot_be_told_takes_along_only_what_depends_on_it() -> None:
    left_out = found(unknown={"Z_q": "collinear"}).left_out
    assert set(left_out) == {"natural_frequency", "damping", "n_alpha", "cap"}
    assert left_out["damping"] == "Z_q cannot be determined from these manoeuvres"


def test_an_unstable_aircraft_has_no_frequency_and_no_level() -> None:
    unstable = THETA.copy()
    unstable[5] = 4.0
    answer = found(unstable)
    assert "unstable" in answer.left_out["natural_frequency"]
    assert not answer.levels


def test_the_level_within_the_intervals_is_no_better_than_the_level_of_the_values() -> None:
    sure, unsure = found(), found(relative=0.5)
    assert [one.level for one in sure.levels] == [one.worst_level for one in sure.levels]
    assert [one.level for one in unsure.levels] == [one.level for one in sure.levels]
    assert all(one.worst_level > one.level for one in unsure.levels)
