"""Samples in a natural period: the number shown, its limits, and when a flight is of no use."""

import numpy as np
import pytest

from advisor.doctor.expectation import NOISE, Assumed
from advisor.doctor.pace import Paced, rate_limits
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.model.short_period import ShortPeriod

MODEL = ShortPeriod.from_mapping(
    {"Z_alpha": -1.0, "Z_delta_e": -0.1, "M_alpha": 1.0 - (4.0 * np.pi) ** 2, "M_q": -1.0, "M_delta_e": -99.0}
)
"""ω_n² = Z_α·M_q - M_α = (4π)², so that the natural period is 0.5 s."""


ASSUMED = Assumed(MODEL, NOISE, "a made-up aircraft")


def limits(**hz: float) -> list[tuple[str, bool]]:
    """Return text and weight of each defect at these rates, 50 Hz elsewhere."""
    paced = {
        name: Paced(name, "ATTITUDE", hz.get(name, 50.0), hz.get(name, 50.0))
        for name in ("elevator", "q", "alpha")
    }
    found = rate_limits(paced, ASSUMED, Vehicle(1, 1, "ardupilot", 1), 25.0)
    return [(limit.text, limit.stops) for limit in found]


def test_the_samples_are_the_rate_times_the_natural_period() -> None:
    ((text, stops),) = limits(q=25.0)
    shown = "12.5 samples of pitch rate in a natural period of 0.50 s (at least 8, better 20.0)"
    assert text == f"ATTITUDE arrives at 25.0 Hz: {shown}"
    assert not stops


@pytest.mark.parametrize(
    ("hz", "samples", "stops"), [(8.0, "4.0", True), (15.6, "7.8", True), (16.4, "8.2", False)]
)
def test_fewer_samples_than_the_least_stop_the_flight(hz: float, samples: str, stops: bool) -> None:
    ((text, found),) = limits(elevator=hz)
    assert f": {samples} samples of elevator command in a natural period of 0.50 s" in text
    assert found is stops


def test_twenty_samples_in_a_natural_period_are_enough() -> None:
    assert limits(q=41.0, alpha=41.0, elevator=41.0) == []


def test_a_rate_that_falls_is_told_with_that_of_its_best_ten_seconds():
    falls = Paced("q", "ATTITUDE", 8.8, 8.8, best_hz=12.8)
    assert falls.arrives == "8.8 Hz on average (12.8 Hz over its best ten seconds)"
    assert Paced("q", "ATTITUDE", 12.4, 12.4, best_hz=12.8).arrives == "12.4 Hz"
