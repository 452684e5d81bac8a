import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.decision.lateral_test import lateral_flight_test, lateral_knowledge
from advisor.model.lateral import LATERAL, Trim
from advisor.oem.estimate import Estimate
from advisor.oem.lateral_estimate import LateralEstimate
from advisor.oem.lateral_modes import Errors, lateral_modes
from tests.oem.lateral_builders import JET, vector

N = len(LATERAL.shared)
AIRCRAFT = Aircraft()


def told(*flown, percent=2.0, off=0.0):
    """Return an estimate of the jet with equal relative errors, ``off`` standard deviations from the
    truth."""
    std = 0.01 * percent * np.maximum(np.abs(vector(JET)), 0.1)
    covariance = np.diag(std**2)
    estimate = Estimate(
        theta=vector(JET) + off * std, covariance_cr=covariance, covariance=covariance, cost=1e-9, fits=(),
        iterations=3, not_identifiable={}, correlated=(), condition=1.0, airspeed_m_s=130.0,
        names=LATERAL.names.reported,
    )  # fmt: skip
    return LateralEstimate(
        estimate, lateral_modes(vector(JET), Errors(covariance, np.zeros((1, 15))), Trim(130.0)), {}, flown
    )


def test_aileron_and_rudder_within_their_tolerance_stop_the_test():
    verdict = lateral_flight_test([told("aileron"), told("rudder")], AIRCRAFT)
    assert verdict.decision == "stop"
    assert verdict.stopped_at == 2
    assert verdict.next.advice == "no further manoeuvre needed"


def test_the_aileron_alone_does_not_stop_the_test_and_the_rudder_is_advised():
    verdict = lateral_flight_test([told("aileron")] * 5, AIRCRAFT)
    assert verdict.decision == "continue"
    assert verdict.criterion_percent is None
    assert verdict.sentence == "CONTINUE: no accepted manoeuvre has moved the rudder."
    assert verdict.next.advice.startswith(
        "next: rudder doublet, 1.8 s steps, 10 % pedal, to begin gently, then hands"
    )


def test_without_any_manoeuvre_the_aileron_comes_first():
    verdict = lateral_flight_test([], AIRCRAFT)
    assert verdict.sentence == "No test input of the aileron or the rudder has been flown."
    assert verdict.next.advice.startswith("next: aileron doublet")


def test_a_rejected_manoeuvre_tells_nothing():
    assert lateral_flight_test([told("aileron"), None], AIRCRAFT).decision == "continue"


def test_a_wide_error_delays_the_stop_and_is_named():
    verdict = lateral_flight_test([told("aileron", percent=20.0), told("rudder", percent=20.0)], AIRCRAFT)
    assert verdict.decision == "continue"
    assert verdict.criterion_percent > 100.0
    assert "of its tolerance" in verdict.sentence


def test_two_equal_manoeuvres_have_an_error_smaller_by_the_root_of_two():
    one, two = lateral_knowledge([told("aileron")]), lateral_knowledge([told("aileron")] * 2)
    place = LATERAL.names.reported.index("L_p")
    assert np.isclose(one.std[place] / two.std[place], np.sqrt(2.0))


def test_manoeuvres_that_contradict_each_other_have_larger_errors():
    agreeing = lateral_knowledge([told("aileron", "rudder"), told("aileron", "rudder")])
    apart = lateral_knowledge([told("aileron", "rudder", off=4.0), told("aileron", "rudder", off=-4.0)])
    assert np.all(apart.std > 3.0 * agreeing.std)


def test_a_manoeuvre_without_rudder_says_nothing_of_the_rudder():
    known = lateral_knowledge([told("aileron")])
    assert np.isinf(known.std[LATERAL.names.reported.index("N_delta_r")])
