"""Amplitude, noise and size of the expected errors come from the flown manoeuvres' own estimates."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.reference import PARAMETERS
from advisor.doctor import as_flown as module
from advisor.doctor.as_flown import as_flown
from advisor.doctor.expectation import NOISE, TYPICAL, Assumed, at_log_rates, expect
from advisor.oem.estimate import NoEstimate
from tests.campaign.side_builders import judged
from tests.decision.campaigns import estimate

ASSUMED = Assumed(TYPICAL, NOISE, "a typical aircraft")


def flown(number):
    """A manoeuvre with an elevator of ±4 deg."""
    found = judged(number, "aileron").maneuver
    return replace(found, channels={**found.channels, "elevator": found.channels["aileron"]})


def coloured(factor):
    """An estimate whose errors are ``factor`` times its Cramér-Rao bounds."""
    found = estimate()
    return replace(found, covariance=factor**2 * found.covariance_cr)


@pytest.fixture
def singles(monkeypatch):
    """Give each manoeuvre an estimate of its own, by its number."""

    def give(*estimates):
        monkeypatch.setattr(module, "estimate", lambda m, _: estimates[m.number - 1])

    return give


def test_the_errors_are_those_of_the_single_manoeuvres_and_not_of_the_joint_estimate(singles):
    singles(coloured(2.0), coloured(3.0), coloured(4.0))
    assumed = as_flown(ASSUMED, [flown(1), flown(2), flown(3)], coloured(20.0))
    assert assumed.flown_std == pytest.approx(coloured(3.0).std)


def test_the_expected_errors_at_the_rates_of_the_log_are_the_flown_ones(singles):
    singles(coloured(3.0))
    rates = {"elevator": 50.0, "q": 50.0, "alpha": 50.0}
    assumed = at_log_rates(as_flown(ASSUMED, [flown(1)], coloured(3.0)), rates, None)
    assert list(expect(assumed, rates, None).std.values()) == pytest.approx(coloured(3.0).std)
    faster = expect(assumed, dict.fromkeys(rates, 100.0), None).std["M_alpha"]
    assert faster < coloured(3.0).std[PARAMETERS.index("M_alpha")]


def test_the_amplitude_is_half_of_the_elevators_range(singles):
    singles(coloured(1.0))
    assert as_flown(ASSUMED, [flown(1)], coloured(1.0)).amplitude_deg == pytest.approx(np.degrees(0.07))


def test_without_any_single_estimate_the_joint_one_tells_the_errors(singles):
    singles(NoEstimate("singular", "nothing moved"))
    assumed = as_flown(ASSUMED, [flown(1)], coloured(5.0))
    assert assumed.flown_std == pytest.approx(coloured(5.0).std)
