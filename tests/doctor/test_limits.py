"""A limit that was missed by a hair does not print as the number it is held against."""

import re

import numpy as np
import pytest

from advisor.aircraft.aircraft import Elevator
from advisor.decision.first_unit import frequency
from advisor.doctor.examination import ElevatorFound, Limit
from advisor.doctor.expectation import NOISE, TYPICAL, Assumed
from advisor.doctor.limits import Paced, elevator_limits, loss_limits, path_limits, rate_limits
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.model.short_period import ShortPeriod

HAIR = 1e-4


def numbers(limit: Limit) -> list[str]:
    """Every number of a sentence."""
    return re.findall(r"\d+(?:\.\d+)?", limit.text)


@pytest.mark.parametrize("per_period", [6.0, 20.0])
def test_a_rate_just_too_low_reads_lower_than_what_is_asked_for(per_period: float) -> None:
    assumed = Assumed(TYPICAL, NOISE, "a typical aircraft")
    too_slow_hz = (1.0 - HAIR) * max(8.0, per_period * frequency(TYPICAL) / (2.0 * np.pi))
    paced = {name: Paced(name, "ATTITUDE", 50.0, 50.0) for name in ("elevator", "alpha")}
    paced["q"] = Paced("q", "ATTITUDE", too_slow_hz, too_slow_hz)
    (limit,) = rate_limits(paced, assumed, Vehicle(1, 1, "ardupilot", 1), 25.0)
    samples = re.search(r"([\d.]+) samples", limit.text)
    asked = re.search(r"at least ([\d.]+), better ([\d.]+)", limit.text)
    assert samples
    assert asked
    missed = asked[1] if per_period == 6.0 else asked[2]
    assert float(samples[1]) < float(missed)
    assert limit.stops is (per_period == 6.0)


def test_a_step_just_too_coarse_reads_coarser_than_the_limit() -> None:
    found = ElevatorFound((2,), 0.5 * (1.0 + HAIR), calibrated=True)
    (limit,) = elevator_limits(found, Elevator(lag_s=0.1))
    step, most = numbers(limit)
    assert float(step) > float(most) == 0.5


def test_a_loss_just_too_high_reads_higher_than_the_limit() -> None:
    (limit,) = loss_limits(5.0 * (1.0 + HAIR))
    lost, most = numbers(limit)
    assert float(lost) > float(most) == 5.0


def test_a_step_of_half_a_degree_is_fine_enough() -> None:
    found = ElevatorFound((2,), 0.5, calibrated=True)
    assert elevator_limits(found, Elevator(lag_s=0.1)) == []


@pytest.mark.parametrize("lost_percent", [None, 0.0, 4.9])
def test_a_loss_of_less_than_a_packet_in_twenty_is_no_limit(lost_percent: float | None) -> None:
    assert loss_limits(lost_percent) == []


def test_a_second_path_is_told_with_its_share_its_lateness_and_a_mend() -> None:
    (limit,) = path_limits(48.2, 6.04)
    assert limit.text == "a second path repeats 48 % of the packets, 6.0 s late"
    assert "one path" in limit.fix
    assert not limit.stops


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
