"""The aircraft as its crew describes it: what the aircraft file may say, with defaults.

These classes are data only. ``advisor.config`` reads them from YAML and lists every
mistake at once; the core takes them as arguments and never touches a file.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

Rule = Literal["continuous", "separate", "information"]
Criterion = Literal["eq12", "eq13"]

PARAMETERS = ("Z_0", "Z_alpha", "Z_q", "Z_delta_e", "M_0", "M_alpha", "M_q", "M_delta_e")
"""Names of θ, Eq. (3), in the order used by every vector of parameters here."""


Pairs = tuple[tuple[float, float], ...]
"""A calibration: (PWM in us, deflection in deg), linear between."""


@dataclass(frozen=True)
class ElevatorOutput:
    """One of several servo outputs that make the elevator's deflection."""

    output: int
    """Servo output 1..32."""
    calibration: Pairs | None = None
    """Pairs (PWM in us, deflection in deg, positive where the nose goes down); None: SERVOn_MIN/TRIM/MAX."""
    weight: float = 1.0
    """Share of the pitch effect per degree, relative to the other outputs."""


@dataclass(frozen=True)
class Elevator:
    """How the elevator command becomes a deflection."""

    output: int | Literal["auto"] = "auto"
    """Servo output 1..32; auto: those whose SERVOn_FUNCTION is 19, an elevon or half of a V-tail."""
    calibration: Pairs | None = None
    """Pairs (PWM in us, deflection in deg, trailing edge down positive), linear between."""
    outputs: tuple[ElevatorOutput, ...] = ()
    """All outputs that make the deflection, in place of ``output`` and ``calibration``."""
    lag_s: float | None = None
    """First-order lag of the servo; None: unknown, and every output says so."""
    delay_s: float | None = None
    """Delay between command and servo; None: unknown."""
    lag_found_s: float | None = None
    """The lag as all manoeuvres together tell it, used where ``lag_s`` is unknown; no key of the file."""

    @property
    def is_calibrated(self) -> bool:
        """Whether the file says what the pulses of the elevator's outputs mean."""
        return self.calibration is not None or any(one.calibration for one in self.outputs)

    @property
    def ends_deg(self) -> tuple[float, float] | None:
        """Lowest and highest deflection by the calibration; None without one."""
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
    """Where the angle of attack comes from."""

    source: str = "auto"
    """auto | aoa_ssa | derived | named_value:NAME | none; ``none``: estimate without one."""
    vane_arm_m: float | None = None
    """Distance of the vane ahead of the centre of gravity; None: unknown, 0: corrected already."""


@dataclass(frozen=True)
class Accelerometer:
    """Where the accelerometer sits."""

    arm_m: float | None = None
    """Distance of the IMU ahead of the centre of gravity; None: unknown."""


@dataclass(frozen=True)
class Markers:
    """How the crew marks manoeuvres in flight."""

    rc: int | None = None
    """Channel 1..18 of RC_CHANNELS that is a pilot's switch; None: there is none."""
    above_us: float = 1700.0
    """Above this pulse the switch is on, us: switched on and off again, it marks what lies between."""
    text: tuple[str, str] | None = None
    """Beginnings of the two STATUSTEXTs that begin and end a mark, besides those of ArduPlane's SystemID."""


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
    """Centre of gravity behind the leading edge of the mean aerodynamic chord."""
    air_temperature_c: float | None = None
    """Temperature of the air flown in; None: that of the standard atmosphere."""


@dataclass(frozen=True)
class FmuTrim:
    """Names of an FMU's parameters that are set before a replay begins; None: not set."""

    airspeed: str | None = None
    """True air speed of the flight condition, m/s."""
    height: str | None = None
    """Pressure altitude of the flight condition, m."""
    flight_path: str | None = None
    """Flight-path angle of the flight condition."""
    mass: str | None = None
    """Mass of the flight condition, kg."""
    alpha: str | None = None
    """Angle of attack at the start: found, with the elevator, such that flight is steady."""
    theta: str | None = None
    """Pitch angle at the start: the flight-path angle plus the angle of attack; needs ``alpha``."""


@dataclass(frozen=True)
class FmuVariables:
    """What an FMU calls the variables of the short period (``simulator: fmu:FILE.fmu``)."""

    elevator: str
    """Input: the elevator. The recorded departure is added to the start value."""
    alpha: str
    """Output: angle of attack."""
    q: str
    """Output: pitch rate."""
    theta: str
    """Output: pitch angle."""
    a_z: str
    """Specific force along body z, -9.81 m/s² in level flight; see ``scale`` for a load factor."""
    airspeed: str | None = None
    """True air speed, m/s; None: that of the flight condition all the time."""
    height: str | None = None
    """Height, m; None: that of the flight condition all the time."""
    aileron: str | None = None
    """Input: aileron, flown where the log has one."""
    rudder: str | None = None
    """Input: rudder, flown where the log has one."""
    throttle: str | None = None
    """Input: throttle, flown where the log has one."""
    force_increment: str | None = None
    """Input that the FMU adds to the rate of α, per second in ``units``; needs ``moment_increment``."""
    moment_increment: str | None = None
    """Input that the FMU adds to the pitch acceleration, per second squared in ``units``."""
    units: Literal["rad", "deg"] = "rad"
    """Of every angle and every angular rate."""
    scale: Mapping[str, float] = field(default_factory=dict)
    """Factor from the FMU's variable to the one named here: ``a_z: -9.80665`` for a load factor."""
    step_s: float | None = None
    """Communication step; None: the FMU's own default, or 0.01 s."""
    trim: FmuTrim = field(default_factory=FmuTrim)


@dataclass(frozen=True)
class CampaignPlan:
    """The stop criterion the crew chose."""

    rule: Rule = "information"
    """Rule that decides; all rules are shown."""
    window: int = 3
    """n of Eq. (12)."""
    limit_percent: float = 25.0
    """Limit of the criterion of Eq. (12) or (13)."""
    criterion: Criterion = "eq12"
    """Which form of the scatter criterion: Eq. (12), or Eq. (13) as the paper writes it out."""
    tolerance_percent: float = 5.0
    """How narrow ``information`` wants the 95 % band of the predicted response, in percent of its peak."""
    parameters: tuple[str, ...] = ("M_alpha", "M_q", "M_delta_e", "Z_alpha")
    """Whose own tolerance the rule ``information`` demands besides; any of ``PARAMETERS``."""
    tolerance: Mapping[str, float] = field(default_factory=dict)
    """That tolerance by name, in the parameter's own unit.

    The default is twice ``tolerance_percent`` of the parameter; of M_q and Z_q it is four times.
    """


@dataclass(frozen=True)
class Limits:
    """What a test manoeuvre may not exceed."""

    bank_deg: float = 30.0
    """Largest bank angle in a manoeuvre."""
    airspeed_change_percent: float = 15.0
    """Largest change of the air speed in a manoeuvre."""
    alpha_deg: float | None = None
    """Largest angle of attack in a manoeuvre; None: no limit."""


@dataclass(frozen=True)
class Aircraft:
    """The whole aircraft file."""

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
    """What the simulator believes today: any of ``PARAMETERS``."""
    effects: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    """Effects added to the simulator's model: effect name of the gap analysis to its parameters."""
    campaign: CampaignPlan = field(default_factory=CampaignPlan)
    limits: Limits = field(default_factory=Limits)
    markers: Markers = field(default_factory=Markers)
    fmu: FmuVariables | None = None
    """Names in the FMU that the simulator is; None: the simulator is no FMU."""
    simulator: str | None = None
    """The user's own simulator: linear | jsbsim:MODEL | fmu:FILE | python:module:factory | log:FILE."""

    @property
    def stated_airspeed_m_s(self) -> float | None:
        """The air speed that the file gives for a log without one; None where it gives none."""
        return self.airspeed_m_s or self.reference_airspeed_m_s
