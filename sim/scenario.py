"""Scenario files: manoeuvres, aircraft, air and instruments of a flight."""

import math
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Literal

import yaml

from .airframe import Airframe
from .faults import Faults
from .loading import ScenarioError, load
from .maneuvers import INPUTS


@dataclass(frozen=True)
class Maneuver:
    """One manoeuvre with its imperfections."""

    input: str = "3211"
    mode: Literal["MANUAL", "FBWA"] = "MANUAL"
    """Flight mode of the manoeuvre. In FBWA the pilot's input demands a pitch angle, and the attitude hold
    moves the elevator."""
    amplitude_deg: float | None = None
    """Elevator amplitude, deg. Amplitude of the input, deg. None for the scenario's ``amplitude_deg``."""
    unit_s: float | None = None
    """Time unit of the input, s. None for the scenario's ``unit_s``."""
    free_s: float | None = None
    """Duration of the free response after the last step, s. None for the scenario's value."""
    gap_s: float | None = None
    """Duration of the attitude hold before the next manoeuvre, s. None for the scenario's value."""
    settling_s: float | None = None
    """Time between the change of the mode and the first step, s. None for the scenario's value."""
    slew_s: float = 0.0
    """Duration of the slope that replaces each step, s, as flown by hand."""
    uneven: float = 0.0
    """Largest relative difference of the steps' durations and amplitudes."""
    corrected: float = 0.0
    """Size of a correction half a second before the first step, as a share of the amplitude."""
    stick: float = 0.0
    """Random motion of the stick: standard deviation as a share of the amplitude."""
    trim_after: float = 0.0
    """Offset of the elevator's final rest from its trim, as a share of the amplitude."""
    bank_deg: float = 0.0
    """Bank angle of the turn in which the manoeuvre is flown, deg."""
    airspeed_m_s: float | None = None
    """Airspeed of the manoeuvre, m/s. None for the scenario's airspeed."""
    height_m: float | None = None
    """Height above ground of the manoeuvre, m. None for the scenario's height."""
    throttle_change: float = 0.0
    """Change of the throttle with the first step, as a share."""
    trim_off_deg: float = 0.0
    """Offset of the elevator from its trim in MANUAL, deg, pulled. The airspeed then changes continuously."""
    aileron: float = 0.0
    """Amplitude (0..1) of a simultaneous aileron doublet."""
    rudder: float = 0.0
    """Amplitude (0..1) of a simultaneous rudder doublet."""
    turbulence_m_s: float = 0.0
    """Standard deviation of turbulence during this manoeuvre only, m/s."""
    outage_s: float = 0.0
    """Duration of the link's silence, s, from the first step."""


@dataclass(frozen=True)
class Noise:
    """White or coloured measurement noise, in percent of each output's signal or in SI values.

    A percentage is relative to the output's ``of``: its largest deviation from trim, or its standard
    deviation. The reference comes from the first manoeuvre, flown without noise.
    """

    percent: float = 0.0
    of: Literal["peak", "std"] = "peak"
    alpha_deg: float = 0.0
    pitch_rate_deg_s: float = 0.0
    pitch_deg: float = 0.0
    accelerometer_m_s2: float = 0.0
    airspeed_m_s: float = 0.0
    climb_m_s: float = 0.0
    colour: float = 0.0
    """Correlation between neighbouring samples (AR(1)); 0 is white."""


@dataclass(frozen=True)
class AlphaSensor:
    """Source and errors of AOA_SSA."""

    source: Literal["vane", "derived"] = "vane"
    """A vane reads gusts and has a new value in every message. ``derived`` is ArduPilot's estimate from
    inertial speed. The estimate does not show gusts, is late, has an offset ``bias_deg``, and is renewed at
    ``renewed_hz``."""
    lag_s: float = 0.03
    bias_deg: float = 0.3
    renewed_hz: float = 20.0


@dataclass(frozen=True)
class Servo:
    """Elevator servo; all zeros give an ideal servo."""

    lag_s: float = 0.0
    delay_s: float = 0.0
    rate_limit_deg_s: float = 0.0


@dataclass(frozen=True)
class Air:
    """Background turbulence (Dryden) and steady wind."""

    turbulence_m_s: float = 0.0
    length_m: float = 60.0
    wind_north_m_s: float = 0.0
    wind_east_m_s: float = 0.0


@dataclass(frozen=True)
class Clock:
    """Clocks at the log's beginning, and errors of the stamps."""

    boot_s: float = 20.0
    unix_s: float = 1_790_000_000.0
    jitter_s: float = 0.0
    """Largest error of a stamp, s, uniformly distributed."""


@dataclass(frozen=True)
class Link:
    """Effects of the radio link on the telemetry."""

    drop: float = 0.0
    """Share of messages that are lost."""
    jitter_s: float = 0.0
    """Largest delay of arrival, s, in bursts as on radios."""


@dataclass(frozen=True)
class Augmentation:
    """Feedback to the elevator in MANUAL, for an unstable aircraft."""

    alpha: float = 0.0
    """Elevator per deviation of the angle of attack from trim, rad/rad."""
    pitch_rate: float = 0.0
    """Elevator per pitch rate, rad per rad/s."""


@dataclass(frozen=True)
class Instruments:
    """Mounting of the accelerometer."""

    accelerometer_arm_m: float = 0.0
    """Distance of the accelerometer ahead of the centre of gravity, m."""


def _paper_campaign() -> tuple[Maneuver, ...]:
    return tuple(Maneuver(input=name) for name in ("3211", "rev", "rev", "3211", "rev", "3211", "rev"))


def _rates() -> dict[str, float]:
    return {
        "ATTITUDE": 50.0,
        "AOA_SSA": 50.0,
        "SERVO_OUTPUT_RAW": 50.0,
        "RAW_IMU": 50.0,
        "VFR_HUD": 50.0,
        "GLOBAL_POSITION_INT": 10.0,
        "SYSTEM_TIME": 1.0,
        "HEARTBEAT": 1.0,
        "RC_CHANNELS": 0.0,
    }


@dataclass(frozen=True)
class Scenario:
    """A whole flight with its aircraft, inputs and telemetry. The default is the paper's campaign with the
    bundled UAV at 1 % noise."""

    aircraft: str = "uav"
    """uav | light | linear (the paper's model) | an aircraft file | with JSBSim one of its own, e.g. c172p"""
    engine: Literal["bundled", "jsbsim"] = "bundled"
    seed: int = 1
    step_s: float = 0.002
    """Integration step, s."""
    loop_hz: float = 50.0
    """Rate of the autopilot's loop, at which commands move and telemetry is sent, Hz."""
    airspeed_m_s: float | None = None
    """Airspeed, m/s. Airspeed of the flight, m/s. None for the aircraft's usual airspeed."""
    height_m: float = 150.0
    lead_in_s: float = 8.0
    """Attitude hold before the first manoeuvre, s."""
    amplitude_deg: float | None = None
    """Elevator amplitude, deg. Amplitude of the inputs, deg. None for the aircraft's usual amplitude."""
    unit_s: float | None = None
    """Time unit of the inputs, s. None for a unit that suits the aircraft's short period."""
    settling_s: float = 2.0
    """Time between the change of the mode and the first step, s."""
    free_s: float = 4.0
    gap_s: float = 8.0
    closing_s: float = 5.0
    """Attitude hold after the last manoeuvre, s."""
    maneuvers: tuple[Maneuver, ...] = field(default_factory=_paper_campaign)
    input: Literal["linear", "held"] = "linear"
    """Motion of the command between two ticks of the loop. The command is linear, or constant with a jump at
    the tick.
    """
    speed: Literal["free", "held"] = "free"
    """With ``free`` the airspeed follows from the forces. With ``held`` an ideal engine holds the
    airspeed."""
    servo: Servo = field(default_factory=Servo)
    augmentation: Augmentation = field(default_factory=Augmentation)
    noise: Noise = field(default_factory=lambda: Noise(percent=1.0))
    alpha: AlphaSensor = field(default_factory=AlphaSensor)
    instruments: Instruments = field(default_factory=Instruments)
    air: Air = field(default_factory=Air)
    clock: Clock = field(default_factory=Clock)
    link: Link = field(default_factory=Link)
    said: tuple[str, ...] = ()
    """Two texts (STATUSTEXT) that the vehicle sends at the mode changes to MANUAL and back."""
    rates: dict[str, float] = field(default_factory=_rates)
    """Rate of each message, Hz, by the message's name."""
    airframe: dict[str, float] = field(default_factory=dict)
    """Fields of the nonlinear airframe (``sim.airframe.Airframe``) that differ from the named aircraft's."""
    effects: dict[str, dict[str, float]] = field(default_factory=dict)
    """Parameters of each effect, by the effect's name, see ``sim.effects``."""
    faults: Faults = field(default_factory=Faults)
    """Faults of instruments and telemetry."""


def read_scenario(path: Path) -> Scenario:
    """Read a scenario file.

    Raises
    ------
    ScenarioError
        The file has mistakes. The error message lists each mistake with its path.
    """
    try:
        data = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise ScenarioError([f"{path}: cannot be read as YAML ({type(error).__name__})"]) from error
    return scenario_from(data or {})


def scenario_from(data: dict[str, Any]) -> Scenario:
    """Build a scenario from a mapping. A manoeuvre may be given by its input's name only.

    Given ``rates`` replace the usual ones.

    Raises
    ------
    ScenarioError
        The file has mistakes. The error message lists each mistake with its path.
    """
    if not isinstance(data, dict):
        raise ScenarioError(["a scenario is a mapping of keys to values"])
    data = dict(data)
    entries = data.get("maneuvers")
    if isinstance(entries, list):
        data["maneuvers"] = [entry if isinstance(entry, dict) else {"input": str(entry)} for entry in entries]
    errors: list[str] = []
    rates = data.get("rates")
    if isinstance(rates, dict):
        errors += [
            f"rates.{name}: unknown message, choose from {', '.join(_rates())}"
            for name in rates
            if name not in _rates()
        ]
        data["rates"] = _rates() | rates
    try:
        scenario = load(Scenario, data)
    except ScenarioError as error:
        raise ScenarioError([*error.problems, *errors]) from None
    errors += _contradictions(scenario)
    if errors:
        raise ScenarioError(errors)
    return scenario


def _contradictions(scenario: Scenario) -> list[str]:
    errors = [
        f"maneuvers[{i}].input: '{maneuver.input}' is none of {', '.join(INPUTS)}"
        for i, maneuver in enumerate(scenario.maneuvers)
        if maneuver.input not in INPUTS
    ]
    if not 0.0 < scenario.step_s <= 0.0025:
        errors.append("step_s: must be above 0 and at most 0.0025 (400 Hz)")
    ticks = (
        1.0 / (scenario.loop_hz * scenario.step_s) if scenario.loop_hz > 0 and scenario.step_s > 0 else 0.0
    )
    if ticks < 1.0 or not math.isclose(ticks, round(ticks), rel_tol=1e-9):
        errors.append("loop_hz: one period of the loop must be a whole number of step_s")
    if len(scenario.said) not in (0, 2):
        errors.append("said: must be two texts, for the beginning and the end of a manoeuvre")
    if not 0.0 <= scenario.link.drop < 1.0:
        errors.append("link.drop: must be at least 0 and below 1")
    if not 0.0 <= scenario.noise.colour < 1.0:
        errors.append("noise.colour: must be at least 0 and below 1")
    if scenario.loop_hz > 0:
        errors += scenario.faults.problems(1.0 / scenario.loop_hz)
    known = [entry.name for entry in fields(Airframe)]
    errors += [f"airframe.{name}: unknown field" for name in scenario.airframe if name not in known]
    errors += [f"rates.{name}: must be at least 0" for name, rate in scenario.rates.items() if rate < 0]
    return errors
