import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.estimator import estimate, estimate_jointly
from advisor.oem.prepare import Prepared, prepare
from advisor.oem.solution import Solution, noise_floor, reported, solve
from advisor.oem.start import start
from benchmarks.simplex import descend_by_simplex
from tests.oem.builders import JET, UAV, flown, maneuver


@pytest.mark.parametrize(("theta", "unit_s"), [(JET, 1.0), (UAV, 0.4)])
def test_without_noise_every_parameter_is_found_within_a_tenth_of_a_percent(theta, unit_s):
    found = estimate(flown(theta, unit_s=unit_s), Aircraft())
    assert isinstance(found, Estimate)
    np.testing.assert_allclose(found.theta, theta, rtol=1e-3)


def test_the_joint_estimate_shares_derivatives_but_not_trim():
    other = UAV.copy()
    other[[0, 4]] += [0.02, 0.1]
    found = estimate_jointly([flown(UAV, unit_s=0.4), flown(other, unit_s=0.4, sign=-1.0)], Aircraft())
    assert isinstance(found, Estimate)
    np.testing.assert_allclose(found.theta, (UAV + other) / 2, rtol=1e-3)
    assert len(found.fits) == 2


def test_the_simplex_of_the_paper_reaches_the_same_optimum():
    prepared = prepare([flown(JET, noise=0.02)], Aircraft())
    assert isinstance(prepared, Prepared)
    fast = solve(prepared.problem)
    assert isinstance(fast, Solution)
    laid = fast.assembly
    data = (laid.grid, laid.z, laid.channel, laid.owner, laid.free, noise_floor(laid))
    slow = descend_by_simplex(*data, *start(prepared.problem))
    assert fast.optimum.log_likelihood_cost <= slow.log_likelihood_cost + 1e-6
    error = np.sqrt(np.diag(fast.covariance_cr)).max()
    theta = reported(slow.shared, slow.local)
    np.testing.assert_allclose(theta, fast.theta, atol=0.02 * error, rtol=2e-3)


def test_a_record_without_elevator_motion_is_no_estimate():
    flight = flown(JET)
    t = flight.channels["elevator"].t
    still = maneuver(
        1,
        (t, np.full(len(t), 0.05)),
        {n: (flight.channels[n].t, flight.channels[n].y) for n in ("alpha", "q")},
    )
    result = estimate(still, Aircraft())
    assert isinstance(result, NoEstimate)
    assert result.code == "no_input"


def test_a_handful_of_samples_is_no_estimate():
    flight = flown(JET, length_s=0.2)
    result = estimate(flight, Aircraft())
    assert isinstance(result, NoEstimate)
    assert result.code == "too_few_samples"
