"""Flights of the kinds that real records are, flown by the bundled simulator: judged, estimated, and
ended.
"""

from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Alpha, Elevator
from advisor.campaign.campaign import Campaign
from advisor.mavlink.logs.logs import open_log
from sim.flight import Flight
from sim.hangar import UAV
from sim.nonlinear_aircraft import NonlinearAircraft
from sim.record import record
from sim.scenario import Air, AlphaSensor, Maneuver, Noise, Scenario, Servo
from tests.unstable import DERIVATIVES, unstable_flight

FOLDER = Path(mkdtemp(prefix="kinds-"))
SCALED = ((1100.0, -25.0), (1500.0, 0.0), (1900.0, 25.0))
INSTRUMENTS = Noise(alpha_deg=0.1, pitch_rate_deg_s=0.3, pitch_deg=0.1, accelerometer_m_s2=0.15)
RATES = {"ATTITUDE": 50.0, "AOA_SSA": 50.0, "SERVO_OUTPUT_RAW": 50.0, "RAW_IMU": 50.0, "VFR_HUD": 20.0}
THREE = tuple(Maneuver(name, slew_s=0.1) for name in ("3211", "rev", "rev"))


def analysed(name, flight, aircraft):
    """The state of a campaign at the end of a flight."""
    path = FOLDER / f"{name}.tlog"
    record(flight, path)
    campaign = Campaign(aircraft)
    for columns in open_log(path):
        campaign.feed(columns)
    campaign.finish()
    return campaign.state


def off(state, name):
    """How far a derivative of the joint estimate is from the truth, over the truth; and its error
    likewise.
    """
    truth = NonlinearAircraft(UAV, state.model.airspeed_m_s, 150.0).truth.as_dict()[name]
    place = list(NonlinearAircraft(UAV, 25.0, 150.0).truth.as_dict()).index(name)
    return abs(state.model.value(name) / truth - 1.0), abs(state.model.std[place] / truth)


@cache
def without_a_vane():
    """Light turbulence, an unknown servo, no angle of attack: a motor glider's campaign."""
    scenario = Scenario(
        rates=RATES | {"AOA_SSA": 0.0, "HEARTBEAT": 1.0},
        servo=Servo(lag_s=0.09),
        air=Air(turbulence_m_s=0.4),
        noise=INSTRUMENTS,
        maneuvers=THREE,
    )
    aircraft = Aircraft(elevator=Elevator(calibration=SCALED), alpha=Alpha(source="none"))
    return analysed("no-vane", Flight(scenario), aircraft)


def test_in_light_turbulence_without_a_vane_most_manoeuvres_are_accepted():
    assert sum(judged.verdict.accepted for judged in without_a_vane().maneuvers) >= 2


def test_without_a_vane_the_servos_lag_is_found():
    lag = without_a_vane().model.instrument("servo_lag_s")
    assert lag.value == pytest.approx(0.09, abs=0.03)


@pytest.mark.parametrize("name", ["M_alpha", "M_q", "M_delta_e", "Z_alpha"])
def test_without_a_vane_the_derivatives_are_those_of_the_aircraft(name):
    error, std = off(without_a_vane(), name)
    assert error < max(0.15, 2.5 * std)
    assert std < 0.25


@cache
def slow_log():
    """ArduPlane's own log: a late angle of attack at 10 Hz, outputs at 25 Hz, an unknown servo."""
    scenario = Scenario(
        rates=RATES | {"AOA_SSA": 10.0, "SERVO_OUTPUT_RAW": 25.0, "VFR_HUD": 10.0, "HEARTBEAT": 1.0},
        servo=Servo(lag_s=0.14),
        alpha=AlphaSensor(source="derived"),
        noise=INSTRUMENTS,
        maneuvers=THREE,
    )
    return analysed("slow-log", Flight(scenario), Aircraft(elevator=Elevator(calibration=SCALED)))


def test_a_slow_late_angle_of_attack_refuses_no_manoeuvre():
    assert all(judged.verdict.accepted for judged in slow_log().maneuvers)


def test_a_slow_log_ends_in_a_stop():
    assert slow_log().flight_test.by_rule["information"].stopped_at is not None


def test_a_lag_that_all_manoeuvres_tell_to_a_tenth_is_used_in_each():
    lags = [judged.estimate.servo_lag_s for judged in slow_log().maneuvers]
    assert np.ptp(lags) < 0.02
    assert np.mean(lags) == pytest.approx(0.14, abs=0.02)


@pytest.mark.parametrize("name", ["M_alpha", "M_q", "M_delta_e", "Z_alpha"])
def test_a_slow_log_gives_the_derivatives_of_the_aircraft(name):
    error, std = off(slow_log(), name)
    assert error < max(0.12, 2.0 * std)


def test_a_statically_unstable_aircraft_is_estimated():
    noise = Noise(alpha_deg=0.02, pitch_rate_deg_s=0.05, pitch_deg=0.05)
    known = Aircraft(elevator=Elevator(calibration=SCALED, lag_s=0.0, delay_s=0.0))
    (judged,) = analysed("unstable", unstable_flight(FOLDER, 0.4, noise), known).maneuvers
    for name in ("Z_alpha", "M_alpha", "M_q"):
        assert judged.estimate.value(name) == pytest.approx(DERIVATIVES[name], rel=0.03)
