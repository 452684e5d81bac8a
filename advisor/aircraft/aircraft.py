"""Data classes of the aircraft file: every key with its default value.

These classes are data only. ``advisor.aircraft_file.read`` reads them from YAML and lists every mistake at
once. The core takes them as arguments and never opens a file.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

Rule = Literal["continuous", "separate", "information"]
Criterion = Literal["eq12", "eq13"]

PARAMETERS = ("Z_0", "Z_alpha", "Z_q", "Z_delta_e", "M_0", "M_alpha", "M_q", "M_delta_e")
"""Names of the eight parameters θ, Eq. (3), in the order of every vector of parameters in this program."""


Pairs = tuple[tuple[float, float], ...]
"""A calibration: pairs (PWM in us, deflection in deg), with linear interpolation between pairs."""


@dataclass(frozen=True)
class ElevatorOutput:
    """One of several servo outputs that make the elevator's deflection."""

    output: int
    """Servo output 1..32."""
    calibration: Pairs | None = None
    """Pairs (PWM in us, deflection in deg, positive where the nose goes down). None: SERVOn_MIN/TRIM/MAX."""
    weight: float = 1.0
    """Share of the pitch effect per degree of deflection, relative to the other outputs."""


@dataclass(frozen=True)
class Elevator:
    """How the elevator command becomes a deflection."""

    output: int | Literal["auto"] = "auto"
    """Servo output 1..32. ``auto``: the outputs whose SERVOn_FUNCTION is elevator (19), elevon or V-tail."""
    calibration: Pairs | None = None
    """Pairs (PWM in us, deflection in deg, trailing edge down positive), with linear interpolation."""
    outputs: tuple[ElevatorOutput, ...] = ()
    """All servo outputs that make the deflection. They replace ``output`` and ``calibration``."""
    lag_s: float | None = None
    """First-order lag of the servo, s. None: unknown, and every result says so."""
    delay_s: float | None = None
    """Delay between command and servo, s. None: unknown."""
    lag_found_s: float | None = None
    """Lag that all manoeuvres together identify, s, used where ``lag_s`` is unknown or excluded. The file has
    no such key."""

    @property
    def is_calibrated(self) -> bool:
        """Whether the file gives a calibration for every output of the elevator."""
        return self.calibration is not None or any(one.calibration for one in self.outputs)

    @property
    def ends_deg(self) -> tuple[float, float] | None:
        """Lowest and highest deflection of the calibration, deg. None without a calibration."""
        calibrations = [(one.weight, one.calibration) for one in self.outputs if one.calibration]
        if self.calibration:
            calibrations = [(1.0, self.calibration)]
        if not calibrations:
            return None
        total = sum(weight for weight, _ in calibrations)
        low = sum(weight * min(deg for _, deg in pairs) for weight, pairs in calibrations)
        high = sum(weight * max(deg for _, deg in pairs) for weight, pairs in calibrations)
        return low / total, high / total


@dataclass(frozen=True)
class Alpha:
    """Source of the angle of attack."""

    source: str = "auto"
    """auto | aoa_ssa | derived | named_value:NAME | none. With ``none`` the estimate uses no angle of
    attack."""
    vane_arm_m: float | None = None
    """Distance of the vane ahead of the centre of gravity, m. None: unknown. 0: the log has corrected
    angles."""


@dataclass(frozen=True)
class Accelerometer:
    """Position of the accelerometer."""

    arm_m: float | None = None
    """Distance of the IMU ahead of the centre of gravity, m. None: unknown."""


@dataclass(frozen=True)
class Markers:
    """Ways in which the crew marks manoeuvres in flight."""

    rc: int | None = None
    """Channel 1..18 of RC_CHANNELS that is the pilot's marking switch. None: no such switch."""
    above_us: float = 1700.0
    """Pulse above which the switch is on, us. The time from switching on to switching off is a mark."""
    text: tuple[str, str] | None = None
    """Beginnings of the two STATUSTEXTs that begin and end a mark, in addition to those of ArduPlane's
    SystemID."""


@dataclass(frozen=True)
class Reference:
    """Geometry and mass for non-dimensional coefficients."""

    mass_kg: float | None = None
    """Mass of the aircraft as flown."""
    wing_area_m2: float | None = None
    """Reference area of the coefficients."""
    chord_m: float | None = None
    """Mean aerodynamic chord."""
    iyy_kg_m2: float | None = None
    """Pitching moment of inertia about the centre of gravity."""
    cg_percent_chord: float | None = None
    """Distance of the centre of gravity behind the leading edge of the mean aerodynamic chord, % of the
    chord."""
    air_temperature_c: float | None = None
    """Air temperature of the flight, deg C. None: the standard atmosphere's."""


@dataclass(frozen=True)
class FmuTrim:
    """Names of an FMU's parameters that are set before a replay begins; None: not set."""

    airspeed: str | None = None
    """Parameter of the flight's true air speed, m/s."""
    height: str | None = None
    """Parameter of the flight's pressure altitude, m."""
    flight_path: str | None = None
    """Parameter of the flight-path angle."""
    mass: str | None = None
    """Parameter of the mass, kg."""
    alpha: str | None = None
    """Parameter of the initial angle of attack, which the trim search sets together with the elevator."""
    theta: str | None = None
    """Parameter of the initial pitch angle: flight-path angle plus angle of attack. Needs ``alpha``."""


@dataclass(frozen=True)
class FmuVariables:
    """Names of an FMU's variables for the short-period motion (``simulator: fmu:FILE.fmu``)."""

    elevator: str
    """Input for the elevator. The recorded deviation from trim is added to the start value."""
    alpha: str
    """Output: angle of attack."""
    q: str
    """Output: pitch rate."""
    theta: str
    """Output: pitch angle."""
    a_z: str
    """Specific force along body z, -9.81 m/s² in level flight. See ``scale`` for a load factor."""
    airspeed: str | None = None
    """True air speed, m/s. None: the air speed of the flight condition, constant."""
    height: str | None = None
    """Height, m. None: the height of the flight condition, constant."""
    aileron: str | None = None
    """Input: aileron, flown where the log has one."""
    rudder: str | None = None
    """Input: rudder, flown where the log has one."""
    throttle: str | None = None
    """Input: throttle, flown where the log has one."""
    force_increment: str | None = None
    """Input that the FMU adds to the rate of α, per second in ``units``. Needs ``moment_increment``."""
    moment_increment: str | None = None
    """Input that the FMU adds to the pitch acceleration, per second squared in ``units``."""
    units: Literal["rad", "deg"] = "rad"
    """Unit of every angle and every angular rate of the FMU."""
    scale: Mapping[str, float] = field(default_factory=dict)
    """Factor from the FMU's variable to the quantity of this class: ``a_z: -9.80665`` for a load factor."""
    step_s: float | None = None
    """Communication step, s. None: the FMU's own default, or 0.01 s."""
    trim: FmuTrim = field(default_factory=FmuTrim)


@dataclass(frozen=True)
class CampaignPlan:
    """Stop criterion that the crew chose."""

    rule: Rule = "information"
    """Rule that decides; all rules are shown."""
    window: int = 3
    """n of Eq. (12)."""
    limit_percent: float = 25.0
    """Limit of the criterion of Eq. (12) or (13)."""
    criterion: Criterion = "eq12"
    """Form of the scatter criterion: Eq. (12), or Eq. (13) as the paper prints it."""
    tolerance_percent: float = 5.0
    """Largest half-width of the predicted response's 95 % band that rule ``information`` accepts, % of the
    peak."""
    parameters: tuple[str, ...] = ("M_alpha", "M_q", "M_delta_e", "Z_alpha")
    """Parameters that must also meet their own tolerance under the rule ``information``; any of
    ``PARAMETERS``."""
    tolerance: Mapping[str, float] = field(default_factory=dict)
    """Parameter name to its tolerance, in the parameter's own unit.

    The default is twice ``tolerance_percent`` of the parameter, and four times for M_q and Z_q.
    """


@dataclass(frozen=True)
class Limits:
    """Limits that a test manoeuvre may not exceed."""

    bank_deg: float = 30.0
    """Largest bank angle in a manoeuvre."""
    airspeed_change_percent: float = 15.0
    """Largest change of the air speed in a manoeuvre."""
    alpha_deg: float | None = None
    """Largest angle of attack in a manoeuvre; None: no limit."""


@dataclass(frozen=True)
class Aircraft:
    """All keys of the aircraft file."""

    name: str = "aircraft"
    """Name on screens and pages."""
    elevator: Elevator = field(default_factory=Elevator)
    alpha: Alpha = field(default_factory=Alpha)
    accelerometer: Accelerometer = field(default_factory=Accelerometer)
    airspeed_m_s: float | None = None
    """Air speed of the flight, only for a log without one."""
    reference_airspeed_m_s: float | None = None
    """Speed at which derivatives are given; None: the mean over the accepted manoeuvres."""
    reference: Reference = field(default_factory=Reference)
    model: Mapping[str, float] = field(default_factory=dict)
    """Parameter name to its value in the simulator of today; any of ``PARAMETERS``."""
    effects: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    """Effects added to the simulator's model: effect name of the gap diagnosis to its parameters."""
    campaign: CampaignPlan = field(default_factory=CampaignPlan)
    limits: Limits = field(default_factory=Limits)
    markers: Markers = field(default_factory=Markers)
    fmu: FmuVariables | None = None
    """Names of the FMU's variables, where the simulator is an FMU. None: the simulator is no FMU."""
    simulator: str | None = None
    """The user's own simulator: linear | jsbsim:MODEL | fmu:FILE | python:module:factory | log:FILE."""

    @property
    def stated_airspeed_m_s(self) -> float | None:
        """Air speed that the file gives for a log without air speed, m/s. None: the file gives none."""
        return self.airspeed_m_s or self.reference_airspeed_m_s
