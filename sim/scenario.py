"""Scenario files: what is flown, by which aircraft, in which air, measured how."""

import math
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Literal

import yaml

from .airframe import Airframe
from .loading import ScenarioError, load
from .maneuvers import INPUTS


@dataclass(frozen=True)
class Maneuver:
    """One manoeuvre and what goes wrong with it."""

    input: str = "3211"
    mode: Literal["MANUAL", "FBWA"] = "MANUAL"
    """FBWA: the pilot's input asks for a pitch angle, and the attitude hold moves the elevator."""
    amplitude_deg: float | None = None
    """Elevator amplitude; None: the scenario's ``amplitude_deg``."""
    unit_s: float | None = None
    """One unit of time; None: the scenario's ``unit_s``."""
    free_s: float | None = None
    """Free response after the last step; None: the scenario's."""
    gap_s: float | None = None
    """Attitude hold before the next manoeuvre; None: the scenario's."""
    settling_s: float | None = None
    """Between the change of the mode and the first step; None: the scenario's."""
    slew_s: float = 0.0
    """Each step is drawn out into a slope of so long, as a hand does."""
    uneven: float = 0.0
    """Durations and amplitudes of the steps differ by up to this share."""
    corrected: float = 0.0
    """The pilot corrects with this share of the amplitude half a second before the first step."""
    stick: float = 0.0
    """The stick moves meanwhile: standard deviation as a share of the amplitude."""
    trim_after: float = 0.0
    """The elevator comes to rest off its trim by this share of the amplitude."""
    bank_deg: float = 0.0
    """Flown in a turn with this bank."""
    airspeed_m_s: float | None = None
    """Flown at this airspeed instead of the scenario's."""
    height_m: float | None = None
    """Flown at this height above ground instead of the scenario's."""
    throttle_change: float = 0.0
    """Throttle moved by this share with the first step."""
    trim_off_deg: float = 0.0
    """Elevator pulled off its trim by so much while in MANUAL: the airspeed runs away."""
    aileron: float = 0.0
    """Amplitude (0..1) of an aileron doublet flown with it."""
    rudder: float = 0.0
    """Amplitude (0..1) of a rudder doublet flown with it."""
    turbulence_m_s: float = 0.0
    """Standard deviation of turbulence during this manoeuvre only."""
    outage_s: float = 0.0
    """The link is silent for so long, from the first step on."""


@dataclass(frozen=True)
class Noise:
    """White or coloured measurement noise; either percent of each output's signal, or SI values.

    Percent means: standard deviation as a percentage of the output's ``of`` (largest deviation from
    trim, or its standard deviation) during the first manoeuvre flown without noise.
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
    """Correlation from one sample to the next (AR(1)), 0 is white."""


@dataclass(frozen=True)
class AlphaSensor:
    """Where AOA_SSA comes from."""

    source: Literal["vane", "derived"] = "vane"
    """A vane sees gusts and is read at every message; derived is what ArduPilot estimates from inertial
    speed: blind to gusts, late, off by ``bias_deg``, renewed at ``renewed_hz``."""
    lag_s: float = 0.03
    bias_deg: float = 0.3
    renewed_hz: float = 20.0


@dataclass(frozen=True)
class Servo:
    """The elevator servo; all zero is an ideal one."""

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
    """Where the clocks stand when the log begins, and how unsteady stamps are."""

    boot_s: float = 20.0
    unix_s: float = 1_790_000_000.0
    jitter_s: float = 0.0
    """Stamps are off by up to so much, uniformly."""


@dataclass(frozen=True)
class Link:
    """What the radio does to the telemetry."""

    drop: float = 0.0
    """Share of messages lost."""
    jitter_s: float = 0.0
    """Arrival is late by up to so much, in bursts as radios do."""


@dataclass(frozen=True)
class Augmentation:
    """Feedback to the elevator while the pilot flies in MANUAL: an unstable aircraft is flown with it."""

    alpha: float = 0.0
    """Elevator, rad, for each rad of angle of attack off trim."""
    pitch_rate: float = 0.0
    """Elevator, rad, for each rad/s of pitch rate."""


@dataclass(frozen=True)
class Instruments:
    """Where and how the accelerometer sits."""

    accelerometer_arm_m: float = 0.0
    """Ahead of the centre of gravity."""


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
    """A whole flight. Without any file: the paper's campaign with the bundled UAV at 1 % noise."""

    aircraft: str = "uav"
    """uav | light | linear (the paper's model) | an aircraft file | with JSBSim one of its own, e.g. c172p"""
    engine: Literal["bundled", "jsbsim"] = "bundled"
    seed: int = 1
    step_s: float = 0.002
    """Integration step."""
    loop_hz: float = 50.0
    """Rate of the autopilot's loop: commands move and telemetry leaves at it."""
    airspeed_m_s: float | None = None
    """None: the aircraft's usual airspeed."""
    height_m: float = 150.0
    lead_in_s: float = 8.0
    """Attitude hold before the first manoeuvre."""
    amplitude_deg: float | None = None
    """Elevator amplitude; None: what suits the aircraft."""
    unit_s: float | None = None
    """One unit of the inputs' time; None: what suits the aircraft's short period."""
    settling_s: float = 2.0
    """The mode changes to that of the manoeuvre so long before the first step."""
    free_s: float = 4.0
    gap_s: float = 8.0
    closing_s: float = 5.0
    """Attitude hold after the last manoeuvre."""
    maneuvers: tuple[Maneuver, ...] = field(default_factory=_paper_campaign)
    input: Literal["linear", "held"] = "linear"
    """How the command moves between two ticks of the loop: in a straight line, or held and then jumping."""
    speed: Literal["free", "held"] = "free"
    """Airspeed moves as forces have it, or an ideal engine holds it."""
    servo: Servo = field(default_factory=Servo)
    augmentation: Augmentation = field(default_factory=Augmentation)
    noise: Noise = field(default_factory=lambda: Noise(percent=1.0))
    alpha: AlphaSensor = field(default_factory=AlphaSensor)
    instruments: Instruments = field(default_factory=Instruments)
    air: Air = field(default_factory=Air)
    clock: Clock = field(default_factory=Clock)
    link: Link = field(default_factory=Link)
    said: tuple[str, ...] = ()
    """Two texts that the vehicle says (STATUSTEXT) where it goes to MANUAL for a manoeuvre, and back."""
    rates: dict[str, float] = field(default_factory=_rates)
    """Message name to Hz."""
    airframe: dict[str, float] = field(default_factory=dict)
    """Fields of the nonlinear airframe (``sim.airframe.Airframe``) that differ from the named aircraft's."""
    effects: dict[str, dict[str, float]] = field(default_factory=dict)
    """Effect name to its parameters, see ``sim.effects``."""


def read_scenario(path: Path) -> Scenario:
    """Read a scenario file.

    Raises
    ------
    ScenarioError
        Listing every mistake with its path.
    """
    try:
        data = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise ScenarioError([f"{path}: cannot be read as YAML ({type(error).__name__})"]) from error
    return scenario_from(data or {})


def scenario_from(data: dict[str, Any]) -> Scenario:
    """Build a scenario from a mapping; a manoeuvre may be just its input's name.

    ``rates`` given are changes to the usual ones.

    Raises
    ------
    ScenarioError
        Listing every mistake with its path.
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
    known = [entry.name for entry in fields(Airframe)]
    errors += [f"airframe.{name}: unknown field" for name in scenario.airframe if name not in known]
    errors += [f"rates.{name}: must be at least 0" for name, rate in scenario.rates.items() if rate < 0]
    return errors
