"""Data classes of the aircraft file: every key with its default value.

These classes are data only. ``advisor.aircraft_file.read`` reads them from YAML and lists every mistake at
once. The core takes them as arguments and never opens a file.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Literal

from advisor.aircraft.key import Key

Rule = Literal["continuous", "separate", "information"]
Criterion = Literal["eq12", "eq13"]

PARAMETERS = ("Z_0", "Z_alpha", "Z_q", "Z_delta_e", "M_0", "M_alpha", "M_q", "M_delta_e")
"""Names of the eight parameters θ, Eq. (3), in the order of every vector of parameters in this program."""
SIDE_PARAMETERS = tuple(f"{y}_{x}" for y in "YLN" for x in ("beta", "p", "r", "delta_a", "delta_r"))
"""Names of the fifteen derivatives of roll and yaw, in the order of every vector of theirs."""


Pairs = tuple[tuple[float, float], ...]
"""A calibration: pairs (PWM in us, deflection in deg), with linear interpolation between pairs."""


@dataclass(frozen=True)
class ElevatorOutput:
    """One of several servo outputs that make the elevator's deflection."""

    output: Annotated[int, Key("Servo output 1..32.")]
    calibration: Annotated[Pairs | None, Key(
        "Pairs (PWM in us, deflection in deg, positive where the nose goes down). None: "
        "SERVOn_MIN/TRIM/MAX.",
    )] = None  # fmt: skip
    weight: Annotated[float, Key(
        "Share of the pitch effect per degree of deflection, relative to the other outputs.",
    )] = 1.0  # fmt: skip


@dataclass(frozen=True)
class Elevator:
    """How the elevator command becomes a deflection."""

    output: Annotated[int | Literal["auto"], Key(
        "Servo output 1..32. ``auto``: the outputs whose SERVOn_FUNCTION is elevator (19), elevon or "
        "V-tail.",
        example="auto",
        question="Servo output of the elevator: a number, several (1 2), or auto",
        answer="auto",
        cost="The elevator is found by the autopilot's parameters; without them a log or link is refused.",
        mend="write the number of the servo output",
    )] = "auto"  # fmt: skip
    calibration: Annotated[Pairs | None, Key(
        "Pairs (PWM in us, deflection in deg, trailing edge down positive), with linear interpolation. "
        "None: SERVOn_MIN/TRIM/MAX and ±25 deg.",
        example="[[1100, -25.0], [1500, 0.0], [1900, 25.0]]",
        question=(
            "Measured deflections of output {}, PWM:deg, trailing edge down positive (1100:-25 1500:0 "
            "1900:25)"
        ),
        cost="The servo's end points count as 25 deg, so Z_δe and M_δe have an assumed scale.",
        mend="measure the deflection at three pulse widths",
    )] = None  # fmt: skip
    outputs: tuple[ElevatorOutput, ...] = ()
    """All servo outputs that make the deflection. They replace ``output`` and ``calibration``."""
    lag_s: Annotated[float | None, Key(
        "First-order lag of the servo, s. None: unknown, and every result says so.",
        example="0.05",
        question="First-order lag of the elevator's servo, s",
        cost=(
            "The lag is estimated with the derivatives: wider intervals, and M_α and M_δe too "
            "small where a flight does not determine it."
        ),
        mend="film a step of the servo on the ground; the lag is the time to 63 % of the step",
        within=(0.0, 2.0),
    )] = None  # fmt: skip
    delay_s: Annotated[float | None, Key(
        "Delay between command and servo, s. None: unknown.",
        example="0.02",
        question="Delay from the logged command to the servo's first movement, s",
        cost="The delay counts as zero; a real delay biases M_α and M_q.",
        mend="film a step of the servo on the ground; the delay ends when the arm begins to move",
        within=(0.0, 2.0),
    )] = None  # fmt: skip

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
class SideControl:
    """How the command of the aileron, or of the rudder, becomes a deflection."""

    output: Annotated[int | Literal["auto"], Key(
        "Servo output 1..32. ``auto``: all outputs whose SERVOn_FUNCTION is the control's (4 aileron, 21 "
        "rudder), with elevons, flaperons and V-tails.",
    )] = "auto"  # fmt: skip
    calibration: Annotated[Pairs | None, Key(
        "Pairs (PWM in us, deflection in deg), with linear interpolation. A positive aileron rolls to the "
        "left, a positive rudder yaws to the left. None: SERVOn_MIN/TRIM/MAX and ±25 deg.",
    )] = None  # fmt: skip
    lag_s: Annotated[float | None, Key(
        "First-order lag of the servo, s. None: unknown.",
        within=(0.0, 2.0),
    )] = None  # fmt: skip
    delay_s: Annotated[float | None, Key(
        "Delay between command and servo, s. None: unknown.",
        within=(0.0, 2.0),
    )] = None  # fmt: skip

    @property
    def ends_deg(self) -> tuple[float, float] | None:
        """Lowest and highest deflection of the calibration, deg. None without a calibration."""
        if self.calibration is None:
            return None
        angles = [deg for _, deg in self.calibration]
        return min(angles), max(angles)


@dataclass(frozen=True)
class Beta:
    """Source of the sideslip."""

    source: Annotated[str, Key(
        "auto | aoa_ssa | named_value:NAME | none, positive with wind from the right. ``auto`` uses what "
        "a vane measures, and nothing that an autopilot derives.",
    )] = "auto"  # fmt: skip
    vane_arm_m: Annotated[float | None, Key(
        "Distance of the sideslip vane ahead of the centre of gravity, m. None: that of the angle of attack.",
    )] = None  # fmt: skip


@dataclass(frozen=True)
class Alpha:
    """Source of the angle of attack."""

    source: Annotated[str, Key(
        "auto | aoa_ssa | derived | named_value:NAME | none. With ``none`` the estimate uses no angle of "
        "attack.",
        example="auto",
        question="Angle of attack from: auto, aoa_ssa, derived, none, or named_value:NAME",
        answer="auto",
    )] = "auto"  # fmt: skip
    vane_arm_m: Annotated[float | None, Key(
        "Distance of the vane ahead of the centre of gravity, m. None: unknown. 0: the log has corrected "
        "angles.",
        example="0.0",
        question="Distance of the vane ahead of the centre of gravity, m",
        cost="The place of the vane is estimated with the derivatives: wider intervals of Z_α and Z_q.",
        mend="measure the distance along the fuselage",
    )] = None  # fmt: skip


@dataclass(frozen=True)
class Accelerometer:
    """Position of the accelerometer."""

    arm_m: Annotated[float | None, Key(
        "Distance of the IMU ahead of the centre of gravity, m. None: unknown.",
        example="0.0",
        question="Distance of the autopilot ahead of the centre of gravity, m",
        cost=(
            "The accelerometer counts as at the centre of gravity, unless alpha.vane_arm_m is given: then"
            " its place is estimated."
        ),
        mend="measure the distance along the fuselage",
    )] = None  # fmt: skip


@dataclass(frozen=True)
class Markers:
    """Ways in which the crew marks manoeuvres in flight."""

    rc: Annotated[int | None, Key(
        "Channel 1..18 of RC_CHANNELS that is the pilot's marking switch. None: no such switch.",
    )] = None  # fmt: skip
    above_us: Annotated[float, Key(
        "Pulse above which the switch is on, us. The time from switching on to switching off is a mark.",
        within=(800.0, 2200.0),
    )] = 1700.0  # fmt: skip
    text: Annotated[tuple[str, str] | None, Key(
        "Beginnings of the two STATUSTEXTs that begin and end a mark, in addition to those of ArduPlane's"
        " SystemID.",
    )] = None  # fmt: skip


@dataclass(frozen=True)
class Reference:
    """Geometry and mass for non-dimensional coefficients."""

    mass_kg: Annotated[float | None, Key(
        "Mass of the aircraft as flown, kg.",
        example="10.0",
        question="Mass, kg",
        cost="No non-dimensional lift derivatives, and no static margin.",
        mend="weigh the aircraft",
        positive=True,
    )] = None  # fmt: skip
    wing_area_m2: Annotated[float | None, Key(
        "Reference area of the coefficients, m².",
        example="0.6",
        question="Wing area, m²",
        cost="No non-dimensional derivatives (C_m_alpha and the like).",
        mend="take the area from the drawing",
        positive=True,
    )] = None  # fmt: skip
    span_m: Annotated[float | None, Key(
        "Wing span, m, for the coefficients of roll and yaw.",
        positive=True,
    )] = None  # fmt: skip
    chord_m: Annotated[float | None, Key(
        "Mean aerodynamic chord, m.",
        example="0.25",
        question="Mean aerodynamic chord, m",
        cost="No non-dimensional derivatives, and no static margin.",
        mend="take the chord from the drawing",
        positive=True,
    )] = None  # fmt: skip
    iyy_kg_m2: Annotated[float | None, Key(
        "Pitching moment of inertia about the centre of gravity, kg m².",
        example="1.0",
        question="Pitching moment of inertia, kg m²",
        cost="No non-dimensional moment derivatives, and no static margin.",
        mend="swing the aircraft as a pendulum, or take the value of the design",
        positive=True,
    )] = None  # fmt: skip
    ixx_kg_m2: Annotated[float | None, Key(
        "Rolling moment of inertia about the centre of gravity, kg m².",
        positive=True,
    )] = None  # fmt: skip
    izz_kg_m2: Annotated[float | None, Key(
        "Yawing moment of inertia about the centre of gravity, kg m².",
        positive=True,
    )] = None  # fmt: skip
    ixz_kg_m2: Annotated[float | None, Key(
        "Product of inertia in the plane of symmetry, kg m².",
    )] = None  # fmt: skip
    cg_percent_chord: Annotated[float | None, Key(
        "Distance of the centre of gravity behind the leading edge of the mean aerodynamic chord, % of "
        "the chord.",
        example="25.0",
        question="Centre of gravity behind the leading edge, percent of the chord",
        cost="The static margin is not turned into the place of the neutral point.",
        mend="balance the aircraft",
        within=(-200.0, 200.0),
    )] = None  # fmt: skip
    air_temperature_c: Annotated[float | None, Key(
        "Air temperature of the flight, deg C. None: the standard atmosphere's.",
        within=(-80.0, 60.0),
    )] = None  # fmt: skip
    height_m: Annotated[float | None, Key(
        "Pressure altitude of the flight, m, for a log with neither pressure nor height above sea level.",
        within=(-500.0, 11000.0),
    )] = None  # fmt: skip


@dataclass(frozen=True)
class FmuTrim:
    """Names of an FMU's parameters that are set before a replay begins; None: not set."""

    airspeed: Annotated[str | None, Key("Parameter of the flight's true air speed, m/s.")] = None
    height: Annotated[str | None, Key("Parameter of the flight's pressure altitude, m.")] = None
    flight_path: Annotated[str | None, Key("Parameter of the flight-path angle.")] = None
    mass: Annotated[str | None, Key("Parameter of the mass, kg.")] = None
    wind_along: Annotated[str | None, Key(
        "Parameter or input of the wind along the heading, m/s, positive from behind.",
    )] = None  # fmt: skip
    wind_right: Annotated[str | None, Key(
        "Parameter or input of the wind across the heading, m/s, positive towards the right.",
    )] = None  # fmt: skip
    alpha: Annotated[str | None, Key(
        "Parameter of the initial angle of attack, which the trim search sets together with the elevator.",
    )] = None  # fmt: skip
    theta: Annotated[str | None, Key(
        "Parameter of the initial pitch angle: flight-path angle plus angle of attack. Needs ``alpha``.",
    )] = None  # fmt: skip


@dataclass(frozen=True)
class FmuVariables:
    """Names of an FMU's variables for the short-period motion (``simulator: fmu:FILE.fmu``)."""

    elevator: Annotated[str, Key(
        "Input for the elevator. The recorded deviation from trim is added to the start value.",
    )]  # fmt: skip
    alpha: Annotated[str, Key("Output: angle of attack.")]
    q: Annotated[str, Key("Output: pitch rate.")]
    theta: Annotated[str, Key("Output: pitch angle.")]
    a_z: Annotated[str, Key(
        "Specific force along body z, -9.81 m/s² in level flight. See ``scale`` for a load factor.",
    )]  # fmt: skip
    airspeed: Annotated[str | None, Key(
        "True air speed, m/s. None: the air speed of the flight condition, constant.",
    )] = None  # fmt: skip
    height: Annotated[str | None, Key(
        "Height, m. None: the height of the flight condition, constant.",
    )] = None  # fmt: skip
    aileron: Annotated[str | None, Key("Input: aileron, flown where the log has one.")] = None
    rudder: Annotated[str | None, Key("Input: rudder, flown where the log has one.")] = None
    throttle: Annotated[str | None, Key("Input: throttle, flown where the log has one.")] = None
    force_increment: Annotated[str | None, Key(
        "Input that the FMU adds to the rate of α, per second in ``units``. Needs ``moment_increment``.",
    )] = None  # fmt: skip
    moment_increment: Annotated[str | None, Key(
        "Input that the FMU adds to the pitch acceleration, per second squared in ``units``.",
    )] = None  # fmt: skip
    units: Annotated[Literal["rad", "deg"], Key(
        "Unit of every angle and every angular rate of the FMU.",
    )] = "rad"  # fmt: skip
    scale: Annotated[Mapping[str, float], Key(
        "Factor from the FMU's variable to the quantity of this class: ``a_z: -9.80665`` for a load "
        "factor.",
    )] = field(default_factory=dict)  # fmt: skip
    step_s: Annotated[float | None, Key(
        "Communication step, s. None: the FMU's own default, or 0.01 s.",
    )] = None  # fmt: skip
    trim: FmuTrim = field(default_factory=FmuTrim)


@dataclass(frozen=True)
class TableColumns:
    """Names of the columns of a table that a simulator wrote (``simulator: log:FILE.csv`` or ``.mat``)."""

    time: Annotated[str, Key("Column of the time, s.")]
    elevator: Annotated[str, Key("Column of the elevator's deflection, positive trailing edge down.")]
    q: Annotated[str, Key("Column of the pitch rate, positive nose up.")]
    alpha: Annotated[str | None, Key("Column of the angle of attack.")] = None
    theta: Annotated[str | None, Key("Column of the pitch angle.")] = None
    bank: Annotated[str | None, Key("Column of the bank angle.")] = None
    p: Annotated[str | None, Key("Column of the roll rate.")] = None
    r: Annotated[str | None, Key("Column of the yaw rate.")] = None
    a_z: Annotated[str | None, Key(
        "Column of the specific force along body z, -9.81 m/s² in level flight. See ``scale`` for a load "
        "factor.",
    )] = None  # fmt: skip
    a_x: Annotated[str | None, Key("Column of the specific force along body x, m/s².")] = None
    airspeed: Annotated[str | None, Key("Column of the true air speed, m/s.")] = None
    indicated_airspeed: Annotated[str | None, Key(
        "Column of the indicated air speed, m/s; the height makes it true.",
    )] = None  # fmt: skip
    height: Annotated[str | None, Key("Column of the height above sea level, m.")] = None
    throttle: Annotated[str | None, Key("Column of the throttle, 0 to 1.")] = None
    units: Annotated[Literal["rad", "deg"], Key(
        "Unit of every angle and every angular rate of the table.",
    )] = "rad"  # fmt: skip
    scale: Annotated[Mapping[str, float], Key(
        "Factor from the column to the quantity of this class: ``a_z: -9.80665`` for a load factor, "
        "``airspeed: 0.514444`` for knots.",
    )] = field(default_factory=dict)  # fmt: skip


@dataclass(frozen=True)
class CampaignPlan:
    """Stop criterion that the crew chose."""

    rule: Annotated[Rule, Key("Rule that decides; all rules are shown.")] = "information"
    window: Annotated[int, Key("n of Eq. (12).")] = 3
    limit_percent: Annotated[float, Key("Limit of the criterion of Eq. (12) or (13).", positive=True)] = 25.0
    criterion: Annotated[Criterion, Key(
        "Form of the scatter criterion: Eq. (12), or Eq. (13) as the paper prints it.",
    )] = "eq12"  # fmt: skip
    tolerance_percent: Annotated[float, Key(
        "Largest half-width of the predicted response's 95 % band that rule ``information`` accepts, % of"
        " the peak.",
        positive=True,
    )] = 5.0  # fmt: skip
    parameters: Annotated[tuple[str, ...], Key(
        "Parameters that must also meet their own tolerance under the rule ``information``; any of "
        "``PARAMETERS``.",
    )] = ("M_alpha", "M_q", "M_delta_e", "Z_alpha")  # fmt: skip
    tolerance: Annotated[Mapping[str, float], Key(
        "Parameter name to its tolerance, in the parameter's own unit. The default is twice "
        "``tolerance_percent`` of the parameter, and four times for M_q and Z_q.",
    )] = field(default_factory=dict)  # fmt: skip


@dataclass(frozen=True)
class Limits:
    """Limits that a test manoeuvre may not exceed."""

    bank_deg: Annotated[float, Key(
        "Largest bank angle in a manoeuvre, deg.",
        example="30.0",
        question="Largest bank within a test manoeuvre, deg",
        answer="30",
        positive=True,
    )] = 30.0  # fmt: skip
    airspeed_change_percent: Annotated[float, Key(
        "Largest change of the air speed in a manoeuvre, %.",
        positive=True,
    )] = 15.0  # fmt: skip
    alpha_deg: Annotated[float | None, Key(
        "Largest angle of attack in a manoeuvre, deg. None: no limit.",
        example="12.0",
        question="Largest angle of attack within a test manoeuvre, deg",
        cost="No advice and no verdict guards against the stall.",
        mend="write an angle a few degrees below the stall",
        positive=True,
    )] = None  # fmt: skip


@dataclass(frozen=True)
class Aircraft:
    """All keys of the aircraft file."""

    name: Annotated[str, Key(
        "Name on screens and pages.",
        example="my aircraft",
        question="Name of the aircraft",
        answer="my aircraft",
    )] = "aircraft"  # fmt: skip
    elevator: Elevator = field(default_factory=Elevator)
    aileron: SideControl = field(default_factory=SideControl)
    rudder: SideControl = field(default_factory=SideControl)
    alpha: Alpha = field(default_factory=Alpha)
    beta: Beta = field(default_factory=Beta)
    accelerometer: Accelerometer = field(default_factory=Accelerometer)
    airspeed_m_s: Annotated[float | None, Key(
        "True air speed of the flight, m/s, only for a log without one.",
        example="20.0",
        cost=(
            "This log has no air speed: the specific force cannot be used, and without an angle of attack"
            " nothing can."
        ),
        mend="write the true air speed that was flown",
        positive=True,
    )] = None  # fmt: skip
    reference_airspeed_m_s: Annotated[float | None, Key(
        "Air speed at which derivatives are given, as the aircraft reads it, m/s. "
        "None: the mean over the accepted manoeuvres.",
        example="20.0",
        question="Air speed at which derivatives are given, m/s",
        cost=(
            "The derivatives hold at the mean air speed of each flight, so two flights are not compared "
            "at one."
        ),
        mend="write the air speed of the test point",
        positive=True,
    )] = None  # fmt: skip
    reference: Reference = field(default_factory=Reference)
    model: Annotated[Mapping[str, float], Key(
        "Parameter name to its value in the simulator of today; any of ``PARAMETERS``.",
        example="{M_alpha: -48.0, M_q: -4.2, M_delta_e: -100.0, Z_alpha: -8.0}",
        cost="advisor gap has no simulator to compare the flight with, unless --simulator names one.",
        mend="write the simulator's derivatives, or give simulator",
    )] = field(default_factory=dict)  # fmt: skip
    effects: Annotated[Mapping[str, Mapping[str, float]], Key(
        "Effects added to the simulator's model: effect name of the gap diagnosis to its parameters.",
    )] = field(default_factory=dict)  # fmt: skip
    campaign: CampaignPlan = field(default_factory=CampaignPlan)
    limits: Limits = field(default_factory=Limits)
    markers: Markers = field(default_factory=Markers)
    fmu: FmuVariables | None = None
    """Names of the FMU's variables, where the simulator is an FMU. None: the simulator is no FMU."""
    columns: TableColumns | None = None
    """Names of the columns of a simulator's table. None: the simulator wrote no table."""
    simulator: Annotated[str | None, Key(
        "The user's own simulator: linear | jsbsim:MODEL | fmu:FILE | python:module:factory | log:FILE.",
    )] = None  # fmt: skip

    @property
    def stated_airspeed_m_s(self) -> float | None:
        """Air speed that the file gives for a log without air speed, m/s. None: the file gives none."""
        return self.airspeed_m_s or self.reference_airspeed_m_s
