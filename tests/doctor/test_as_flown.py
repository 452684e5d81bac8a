"""Amplitude, noise and colour of the expected errors come from the flown manoeuvres' own estimates."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.doctor import as_flown as module
from advisor.doctor.as_flown import as_flown
from advisor.doctor.expectation import NOISE, TYPICAL, Assumed
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


def test_the_colour_is_that_of_the_single_manoeuvres_and_not_of_the_joint_estimate(singles):
    singles(coloured(2.0), coloured(3.0), coloured(4.0))
    found = as_flown(ASSUMED, [flown(1), flown(2), flown(3)], coloured(20.0))
    assert found.colour == pytest.approx(np.full(8, 3.0))


def test_the_amplitude_is_half_of_the_elevators_range(singles):
    singles(coloured(1.0))
    assert as_flown(ASSUMED, [flown(1)], coloured(1.0)).amplitude_deg == pytest.approx(np.degrees(0.07))


def test_without_any_single_estimate_the_joint_one_tells_the_colour(singles):
    singles(NoEstimate("singular", "nothing moved"))
    found = as_flown(ASSUMED, [flown(1)], coloured(5.0))
    assert found.colour == pytest.approx(np.full(8, 5.0))
