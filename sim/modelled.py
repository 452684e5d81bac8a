"""Flights of the aircraft in an aircraft file, with test inputs or recorded inputs."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from .aircraft_file import AircraftFile, read_aircraft
from .autopilot import Autopilot, plan
from .effects.kit import Kit
from .effects.terms import fit_terms
from .fittings import Fittings
from .flight import Flight
from .hangar import LINEAR_HABITS, unit_for
from .linear_aircraft import LinearAircraft
from .replay import RecordedAirspeed, RecordedPilot, Recording, read_recording
from .scenario import Clock, Instruments, Scenario, Servo


def modelled_flight(scenario: Scenario, path: Path, replayed: Path | None = None) -> Flight:
    """Build a flight of the aircraft in ``path``. ``replayed`` is a log whose elevator commands are flown
    again.

    The replay uses the log's clocks, for a comparison of both logs, and its airspeed if logged. Noise in
    percent is not defined for a replay and is left out.

    Raises
    ------
    ScenarioError
        The aircraft file or the log cannot be used.
    """
    aircraft = read_aircraft(path)
    recording = read_recording(replayed, aircraft.elevator_output) if replayed else None
    scenario = replace(
        scenario,
        servo=Servo(aircraft.lag_s, aircraft.delay_s, 0.0),
        instruments=Instruments(aircraft.accelerometer_arm_m),
        unit_s=scenario.unit_s or unit_for(aircraft.model.frequency()),
    )
    if recording is not None:
        clock = Clock(float(recording.time_s[0]), recording.unix_s)
        scenario = replace(scenario, clock=clock, noise=replace(scenario.noise, percent=0.0), maneuvers=())
    engine = _engine(aircraft, scenario, recording)
    planned = plan(scenario, LINEAR_HABITS.amplitude_deg, LINEAR_HABITS.unit_s)
    duration = (planned[-1].end_s if planned else scenario.lead_in_s) + scenario.closing_s
    if recording is not None:
        duration = float(recording.time_s[-1] - recording.time_s[0])
    kit = Kit(
        Fittings(), engine.trim, planned, duration, scenario.seed, scenario.height_m, engine.motion().alpha,
        recorded_s=recording.begins_s if recording is not None else 0.0,
    )  # fmt: skip
    fit_terms(kit, engine, aircraft.effects, scenario.clock.boot_s)
    if aircraft.vane_arm_m:
        fit_terms(kit, engine, {"alpha_vane_offset": {"arm_m": aircraft.vane_arm_m}}, scenario.clock.boot_s)
    if recording is None:
        return Flight(scenario, kit.fittings, engine, fresh=lambda quiet: _engine(aircraft, quiet, None))
    if len(recording.airspeed_m_s) > 1:
        engine.record["speed_scaled"] = engine.record["gravity"] = 1.0
        kit.fittings.plant.append(RecordedAirspeed(recording))
    holding = Autopilot((), engine.trim, engine.motion(), engine.truth)
    pilot = RecordedPilot(recording, engine.calibration, holding)
    return Flight(scenario, kit.fittings, engine, pilot, duration)


def _engine(aircraft: AircraftFile, scenario: Scenario, recording: Recording | None) -> LinearAircraft:
    airspeed = scenario.airspeed_m_s or aircraft.airspeed_m_s
    throttle = 0.5
    if recording is not None:
        throttle = float(np.median(recording.throttle))
        if airspeed is None and len(recording.airspeed_m_s):
            airspeed = float(np.mean(recording.airspeed_m_s))
    engine = LinearAircraft(
        aircraft.model, airspeed or LINEAR_HABITS.airspeed_m_s, scenario.height_m, throttle=throttle
    )
    engine.calibration = aircraft.calibration or (recording or engine).calibration
    return engine
