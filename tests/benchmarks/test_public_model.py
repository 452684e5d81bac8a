"""The whole model of the open benchmark: its simulation, its two fits, and the advisor's estimates in it."""

from types import SimpleNamespace

import numpy as np
import pytest

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from benchmarks.public.__main__ import errors
from benchmarks.public.advised import coefficients_of, lagged
from benchmarks.public.linear import FACTORS, FREE, REFERENCE_M_S, ROWS, TRIMS, simulated
from benchmarks.public.segments import CONTROLS, STROKE_RAD, Segment, angles, upright
from benchmarks.public.whole import by_output_error, regressed

T = np.arange(24) * 0.04
STABLE = {
    "X_one": 2.0, "X_0": -2.0, "Y_beta": -6.0, "Z_0": -9.0, "Z_alpha": -20.0, "L_beta": -12.0, "L_p": -4.0,
    "L_aileron": -10.0, "M_alpha": -20.0, "M_q": -4.0, "M_elevator": 3.0, "N_beta": 10.0, "N_r": -2.0,
    "N_rudder": -4.0,
}  # fmt: skip


def model(**named):
    """Return the coefficients (6, 11) with these values by name."""
    found = np.zeros(FREE.shape)
    for name, value in named.items():
        row, factor = name.split("_", 1)
        found[ROWS.index(row), FACTORS.index(factor)] = value
    return found


def begun(rates=(0.0, 0.0, 0.0), **commands):
    """Return a segment of level flight to the north at the reference speed, with these commands."""
    states = np.zeros((len(T), 13))
    states[:, 3], states[:, 6], states[:, 10:13] = REFERENCE_M_S, 1.0, rates
    still = dict.fromkeys(CONTROLS, np.zeros(len(T)))
    return Segment("begun", T, states, {**still, **commands})


def flown():
    """Return two flights of the stable model, each moved by all controls."""
    rng = np.random.default_rng(5)
    for rates in ((0.4, -0.2, 0.1), (-0.3, 0.2, 0.3)):
        commands = {name: np.repeat(rng.uniform(-0.6, 0.6, 6), 4) for name in CONTROLS}
        segment = begun(rates, **commands)
        states = simulated(model(**STABLE)[None], segment)[0]
        yield Segment("flown", T, states, segment.commands)


def test_an_aircraft_without_forces_falls_freely():
    states = simulated(model()[None], begun())[0]
    assert states[-1, 2] == pytest.approx(0.5 * GRAVITY_M_S2 * T[-1] ** 2)
    assert states[-1, 0] == pytest.approx(REFERENCE_M_S * T[-1])


def test_an_aircraft_whose_lift_carries_its_weight_flies_level():
    states = simulated(model(Z_one=-GRAVITY_M_S2)[None], begun())[0]
    np.testing.assert_allclose(states[:, 2], 0.0, atol=1e-12)
    np.testing.assert_allclose(states[:, 3], REFERENCE_M_S)


def test_a_constant_roll_rate_banks_in_proportion_to_time():
    states = simulated(model(Z_one=-GRAVITY_M_S2)[None], begun(rates=(0.5, 0.0, 0.0)))[0]
    bank, pitch, heading = angles(states[:, 6:10])
    np.testing.assert_allclose(bank, 0.5 * T, atol=1e-6)
    np.testing.assert_allclose([pitch, heading], 0.0, atol=1e-6)


def test_a_simulation_that_runs_away_stays_finite():
    assert np.all(np.isfinite(simulated(model(M_alpha=1e6)[None], begun(rates=(0.0, 0.1, 0.0)))))


def test_models_are_simulated_independently_of_each_other():
    both = np.array([model(), model(**STABLE)])
    np.testing.assert_allclose(simulated(both, begun())[1], simulated(both[1:], begun())[0])


def test_the_regression_explains_each_acceleration_of_a_flight_of_the_model():
    _, shares = regressed(list(flown()))
    assert min(shares.values()) > 0.8


def test_output_error_finds_the_coefficients_that_flew():
    found = by_output_error(list(flown()), 0.9 * model(**STABLE))
    for name, value in STABLE.items():
        row, factor = name.split("_", 1)
        assert found[ROWS.index(row), FACTORS.index(factor)] == pytest.approx(value, rel=0.01), name


def test_output_error_moves_only_the_coefficients_that_are_free():
    segment = next(flown())
    off = model(**{**STABLE, "M_0": 0.5})
    np.testing.assert_allclose(by_output_error([segment], off, TRIMS), model(**STABLE), atol=1e-3)


def test_axes_turned_twice_are_those_of_the_file():
    segment = next(flown())
    np.testing.assert_array_equal(upright(upright(segment)).states, segment.states)


def test_errors_do_not_depend_on_the_direction_of_the_axes():
    one, other = flown()
    turned = errors(upright(one), upright(other).states)
    np.testing.assert_allclose(turned, errors(one, other.states))


def test_a_lagged_command_reaches_63_percent_after_its_lag():
    step = np.where(T > 0.0, 1.0, 0.0)
    moved = lagged(begun(aileron=step), {"aileron": 0.08, "rudder": 0.0}).commands["aileron"]
    assert moved[3] == pytest.approx(1.0 - np.exp(-1.0))


def test_estimates_at_twice_the_reference_speed_have_a_quarter_of_their_moments():
    def estimate(**named):
        return SimpleNamespace(names=tuple(named), value=named.get, airspeed_m_s=2.0 * REFERENCE_M_S)

    found = SimpleNamespace(
        pitch=estimate(Z_alpha=-4.0, M_q=-3.0, M_delta_e=8.0), side=estimate(Y_beta=-1.0, L_beta=-12.0)
    )
    converted = coefficients_of(found, model(X_0=-2.0))
    expected = model(
        X_0=-2.0, Z_one=-GRAVITY_M_S2, Z_alpha=-2.0 * REFERENCE_M_S, M_q=-1.5, M_elevator=2.0 * STROKE_RAD,
        Y_beta=-0.5 * REFERENCE_M_S, L_beta=-3.0,
    )  # fmt: skip
    np.testing.assert_allclose(converted, expected)
