"""An estimate represents the aircraft where it explains the motion, and is sharp, quick and strong enough."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.reference import PARAMETERS
from advisor.doctor import expectation as module
from advisor.doctor.expectation import NOISE, TYPICAL, Assumed, as_flown, at_log_rates, expect, is_believable
from advisor.oem.estimate import Estimate, NoEstimate
from tests.campaign.side_builders import judged
from tests.decision.campaigns import THETA, estimate

T = np.arange(500) / 50.0


def explaining(found: Estimate, misses: float = 0.1) -> Estimate:
    """The estimate with outputs that miss the measured ones by this share of their size."""
    fits = {
        name: replace(fit, measured=np.sin(T), fitted=(1.0 - misses) * np.sin(T))
        for name, fit in found.fits[0].items()
    }
    return replace(found, fits=(fits,))


def aircraft(pace_rad_s: float, effect: float) -> np.ndarray:
    """An aircraft of this natural frequency; ``effect`` is M_delta_e over the square of the frequency."""
    theta = THETA.copy()
    theta[1] = theta[6] = -0.6 * pace_rad_s
    theta[2] = 0.0
    theta[5] = -(pace_rad_s**2 - theta[1] * theta[6])
    theta[7] = -effect * pace_rad_s**2
    return theta


def of(theta: np.ndarray, std_percent: float = 1.0) -> Estimate:
    return explaining(estimate(theta, covariance=np.diag((0.01 * std_percent * theta) ** 2)))


@pytest.mark.parametrize(("pace_rad_s", "believed"), [(0.4, False), (0.6, True), (35.0, True), (45.0, False)])
def test_a_short_period_lies_between_a_half_and_forty_radians_a_second(pace_rad_s, believed):
    assert is_believable(of(aircraft(pace_rad_s, 0.5))) == believed


@pytest.mark.parametrize(("effect", "believed"), [(0.015, False), (0.025, True), (-0.025, True)])
def test_an_elevator_turns_the_aircraft_by_a_fiftieth_of_its_stiffness(effect: float, believed: bool) -> None:
    assert is_believable(of(aircraft(3.0, effect))) == believed


@pytest.mark.parametrize(("misses", "believed"), [(0.6, True), (0.8, False)])
def test_half_of_the_motion_of_each_output_is_explained(misses: float, believed: bool) -> None:
    assert is_believable(explaining(of(THETA), misses)) == believed
    of_one = explaining(of(THETA), misses).fits[0]["q"]
    good = explaining(of(THETA))
    assert is_believable(replace(good, fits=({**good.fits[0], "q": of_one},))) == believed


@pytest.mark.parametrize(("std_percent", "believed"), [(28.0, True), (32.0, False)])
@pytest.mark.parametrize("unsure", [5, 7])
def test_stiffness_and_effectiveness_are_known_to_three_tenths(unsure, std_percent, believed):
    std = 0.01 * np.abs(THETA)
    std[unsure] *= std_percent
    assert is_believable(explaining(estimate(covariance=np.diag(std**2)))) == believed


@pytest.mark.parametrize(("name", "believed"), [("M_alpha", False), ("M_delta_e", False), ("Z_q", True)])
def test_stiffness_and_effectiveness_are_identifiable(name: str, believed: bool) -> None:
    assert is_believable(replace(of(THETA), not_identifiable={name: "no"})) == believed


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
