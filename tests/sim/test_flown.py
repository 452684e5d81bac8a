"""Manoeuvres as they are flown: good ones return to trim, bad ones are bad in the way they should be."""

from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

from sim.autopilot import CRUISE, MANUAL
from sim.effects.fitting import flight_of
from sim.flight import Flight
from sim.scenario import AlphaSensor, Maneuver, Noise, Scenario, Servo, read_scenario
from sim.telemetry import Telemetry

SCENARIOS = sorted(Path(str(files("sim") / "scenarios")).glob("*.yaml"))


def flown(maneuver, **changes):
    """Samples of one manoeuvre, from its first step on, and of the hold before it."""
    flight = Flight(Scenario(maneuvers=(maneuver,), noise=Noise(), **changes))
    samples = list(flight.samples())
    start = flight.planned[0].start_s
    return (
        [s for s in samples if s.flying and s.time_s >= start - 1e-9],
        [s for s in samples if s.time_s < start - 2.5],
    )


@pytest.mark.parametrize("path", SCENARIOS, ids=lambda path: path.stem)
def test_every_scenario_that_comes_along_can_be_flown(path):
    scenario = read_scenario(path)
    flight = flight_of(replace(scenario, maneuvers=scenario.maneuvers[:3]))
    last = list(flight.samples())[-1]
    assert last.time_s == pytest.approx(flight.duration_s, abs=0.05)
    assert np.isfinite([last.motion.airspeed, last.motion.alpha, last.motion.height]).all()


@pytest.mark.parametrize("aircraft", ["uav", "light", "linear"])
@pytest.mark.parametrize("name", ["3211", "rev", "doublet"])
def test_the_aircraft_is_back_near_trim_after_a_balanced_input(aircraft, name):
    during, before = flown(Maneuver(name), aircraft=aircraft)
    swing = np.ptp([s.motion.alpha for s in during])
    assert abs(during[-1].motion.alpha - before[-1].motion.alpha) < 0.1 * swing


@pytest.mark.parametrize("aircraft", ["uav", "light", "linear"])
def test_a_manoeuvre_is_rich_and_stays_within_the_airspeed_limit(aircraft):
    during, _ = flown(Maneuver("3211"), aircraft=aircraft)
    speeds = [s.motion.airspeed for s in during]
    assert np.degrees(np.ptp([s.motion.alpha for s in during])) > 3.0
    assert np.ptp(speeds) < 0.08 * np.mean(speeds)


def test_the_first_step_of_a_3211_raises_the_nose_and_that_of_its_reverse_lowers_it():
    for name, sign in (("3211", 1.0), ("rev", -1.0)):
        during, _ = flown(Maneuver(name))
        assert sign * during[10].motion.q > 0.05
        assert sign * (during[10].pulse_us - during[0].pulse_us) <= 0


def test_the_mode_is_manual_from_two_seconds_before_until_the_end():
    flight = Flight(Scenario(maneuvers=(Maneuver("3211"),), noise=Noise()))
    planned = flight.planned[0]
    for sample in flight.samples():
        inside = planned.start_s - 2.0 <= sample.time_s < planned.end_s
        assert sample.mode == (MANUAL if inside else CRUISE)


def test_a_turn_is_flown_with_its_bank_and_without_losing_height():
    during, _ = flown(Maneuver("3211", bank_deg=40.0))
    assert np.degrees([s.motion.phi for s in during]) == pytest.approx(40.0, abs=5.0)
    assert min(s.motion.height for s in during) > 120.0


def test_turbulence_of_a_manoeuvre_blows_only_during_it():
    flight = Flight(Scenario(maneuvers=(Maneuver("none", turbulence_m_s=1.0, free_s=60.0),), noise=Noise()))
    samples = list(flight.samples())
    assert all(s.motion.gust_up == 0.0 for s in samples if not s.flying and s.time_s < 8.0)
    assert np.std([s.motion.gust_up for s in samples if s.flying]) == pytest.approx(1.0, rel=0.3)


def test_a_moved_throttle_makes_the_aircraft_climb():
    plain, _ = flown(Maneuver("3211"))
    moved, _ = flown(Maneuver("3211", throttle_change=0.5))
    assert moved[-1].throttle - plain[-1].throttle == pytest.approx(0.5, abs=0.02)
    assert moved[-1].motion.climb > plain[-1].motion.climb + 1.0


def test_an_aircraft_out_of_trim_runs_away_with_its_airspeed():
    for pull, sign in ((2.0, -1.0), (-2.0, 1.0)):
        during, _ = flown(Maneuver("3211", trim_off_deg=pull))
        assert sign * (during[-1].motion.airspeed - 25.0) > 3.5


def test_another_airspeed_is_reached_before_the_manoeuvre():
    during, _ = flown(Maneuver("3211", airspeed_m_s=28.0), lead_in_s=20.0)
    assert during[0].motion.airspeed == pytest.approx(28.0, abs=0.7)


def test_a_saturated_input_rests_on_the_stops():
    during, _ = flown(Maneuver("3211", amplitude_deg=40.0))
    pulses = [s.pulse_us for s in during]
    assert (min(pulses), max(pulses)) == (1100, 1900)


def test_other_controls_move_when_the_scenario_says_so():
    during, _ = flown(Maneuver("3211", aileron=0.4, rudder=0.3))
    assert np.ptp([s.aileron for s in during]) > 0.5
    assert np.ptp([s.rudder for s in during]) == pytest.approx(0.6)


def test_an_outage_silences_the_link():
    flight = Flight(Scenario(maneuvers=(Maneuver("3211", outage_s=1.5),)))
    times = [burst.time_s for burst in Telemetry(flight).bursts()]
    assert np.diff(times).max() == pytest.approx(1.52, abs=0.03)


def test_without_servo_dynamics_the_surface_is_where_the_pulses_say():
    flight = Flight(Scenario(maneuvers=(Maneuver("3211"),), noise=Noise()))
    for sample in list(flight.samples())[1:]:
        surface = flight.calibration.deflection(sample.pulse_us)
        assert sample.motion.elevator == pytest.approx(surface, abs=1e-12)


def test_a_held_command_stands_until_the_next_tick():
    flight = Flight(Scenario(maneuvers=(Maneuver("3211"),), noise=Noise(), input="held"))
    before = None
    for sample in flight.samples():
        if before is not None:
            assert sample.motion.elevator == pytest.approx(flight.calibration.deflection(before), abs=1e-12)
        before = sample.pulse_us


def test_a_lagging_servo_trails_the_command():
    quick, _ = flown(Maneuver("3211"))
    slow, _ = flown(Maneuver("3211"), servo=Servo(lag_s=0.1))
    step = np.array([s.motion.elevator for s in slow[:30]])
    goal = quick[10].motion.elevator
    share = (step - step[0]) / (goal - step[0])
    assert 0.02 * int(np.argmax(share > 1 - np.exp(-1))) == pytest.approx(0.11, abs=0.021)


def test_a_derived_angle_of_attack_is_a_late_offset_staircase():
    sensor = AlphaSensor(source="derived", lag_s=0.03, bias_deg=0.3, renewed_hz=20.0)
    during, before = flown(Maneuver("3211"), alpha=sensor)
    shown = np.degrees([s.reading.alpha for s in during])
    true = np.degrees([s.motion.alpha for s in during])
    assert np.mean(np.diff(shown) == 0.0) == pytest.approx(0.6, abs=0.1)
    settled = before[-1]
    assert np.degrees(settled.reading.alpha - settled.motion.alpha) == pytest.approx(0.3, abs=0.02)
    misfit = [np.std(shown[shift:] - true[: len(true) - shift]) for shift in range(8)]
    assert int(np.argmin(misfit)) in (2, 3)
