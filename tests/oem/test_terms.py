"""Terms that the user adds to the short period, and parameters that the user holds."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from advisor.aircraft.aircraft import Aircraft, Estimation
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.estimator import estimate_jointly
from tests.oem.builders import JET, elevator_3211, maneuver, trim_alpha, trim_elevator

DAMPING = -6.0
"""Coefficient of q·|q| in the pitch acceleration of the aircraft, 1/rad."""
TERM = "M:q*abs(q)"


def flown(number: int, coefficient: float) -> Maneuver:
    """Return a manoeuvre whose pitch acceleration contains q·|q|, integrated by SciPy."""
    rng = np.random.default_rng(number)
    t = np.arange(0.0, 14.0, 0.02)
    u = elevator_3211(t, trim=trim_elevator(JET), amplitude=0.06 * (-1) ** number)

    def rates(now, x):
        alpha, q = x
        d = float(np.interp(now, t, u))
        return [
            JET[0] + JET[1] * alpha + (1.0 + JET[2]) * q + JET[3] * d,
            JET[4] + JET[5] * alpha + JET[6] * q + JET[7] * d + coefficient * q * abs(q),
        ]

    alpha, q = solve_ivp(rates, (0.0, 14.0), [trim_alpha(JET), 0.0], t_eval=t, max_step=0.02, rtol=1e-8).y
    noisy = {name: (t, y + 0.01 * np.std(y) * rng.standard_normal(len(t))) for name, y in
             (("alpha", alpha), ("q", q))}  # fmt: skip
    return maneuver(number, (t, u), noisy)


@pytest.fixture(scope="module")
def bent() -> list[Maneuver]:
    return [flown(number, DAMPING) for number in (1, 2)]


def estimated(maneuvers: list[Maneuver], *terms: str, **fixed: float) -> Estimate:
    found = estimate_jointly(maneuvers, Aircraft(estimation=Estimation(fixed, terms)))
    assert not isinstance(found, NoEstimate)
    return found


@pytest.fixture(scope="module")
def with_term(bent) -> Estimate:
    return estimated(bent, TERM)


def test_the_coefficient_of_a_term_is_that_of_the_aircraft(with_term):
    (term,) = with_term.terms
    assert term.name == TERM
    assert abs(term.value - DAMPING) < 3.0 * term.std
    assert term.std < 0.1


def test_beside_the_term_the_damping_is_that_of_the_aircraft(with_term):
    assert with_term.value("M_q") == pytest.approx(JET[6], rel=0.02)


def test_a_term_that_acts_gains_likelihood(with_term):
    assert with_term.terms[0].gained > 100.0


def test_a_term_is_no_instrument_and_no_note(with_term):
    assert TERM not in [x.name for x in with_term.instruments]
    assert not any(TERM in note for note in with_term.notes)


def test_a_needless_term_gains_nothing_beyond_chance():
    (term,) = estimated([flown(number, 0.0) for number in (1, 2)], TERM).terms
    assert term.gained < 4.0
    assert abs(term.value) < 3.0 * term.std


def test_a_held_parameter_keeps_its_value_and_has_no_error(bent):
    found = estimated(bent, TERM, M_q=-2.5, M_0=0.5)
    assert (found.value("M_q"), found.value("M_0")) == (-2.5, 0.5)
    assert found.std[[4, 6]].tolist() == [0.0, 0.0]
    assert set(found.fixed) == {"M_q", "M_0"}


def test_a_term_without_its_signal_is_refused_by_name(bent):
    found = estimate_jointly(bent, Aircraft(estimation=Estimation(terms=("M:thrust",))))
    assert isinstance(found, NoEstimate)
    assert "M:thrust needs throttle, which manoeuvre 1 does not have" in found.text
