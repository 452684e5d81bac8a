"""Data classes of the aircraft file: every key with its default value.

The classes hold data and compute nothing. ``advisor.aircraft_file.read`` reads them from YAML and lists
every mistake at once. The core takes them as arguments and never opens a file.
"""

import hashlib
import json
from collections.abc import Container, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Literal, Self

from advisor.aircraft.added_term import AddedTerm, parse_term
from advisor.aircraft.key import Key
from advisor.aircraft.reference import FmuVariables, Reference
from advisor.words.problems import printable


@dataclass(frozen=True)
class Beta:
    """Source of the sideslip."""

    source: Annotated[str, Key(
        "auto | aoa_ssa | named_value:NAME | none, positive with wind from the right. ``auto`` uses what "
        "a vane measures, and nothing that an autopilot derives.",
        example="auto",
    )] = "auto"  # fmt: skip
    vane_arm_m: Annotated[float | None, Key(
        "Distance of the sideslip vane ahead of the centre of gravity, m. None: that of the angle of attack.",
        example="0.0",
    )] = None  # fmt: skip


@dataclass(frozen=True)
class Alpha:
    """Source of the angle of attack."""

    source: Annotated[str, Key(
        "auto | aoa_ssa | derived | named_value:NAME | none. With ``none`` the estimate uses no angle of "
        "attack.",
        example="auto",
    )] = "auto"  # fmt: skip
    vane_arm_m: Annotated[float | None, Key(
        "Distance of the vane ahead of the centre of gravity, m. None: unknown. 0: the log has corrected "
        "angles.",
        example="0.0",
        cost="The place of the vane is estimated with the derivatives: wider intervals of Z_α and Z_q.",
        mend="measure the distance along the fuselage",
    )] = None  # fmt: skip


@dataclass(frozen=True)
class Accelerometer:
    """Position of the accelerometer."""

    arm_m: Annotated[float | None, Key(
        "Distance of the IMU ahead of the centre of gravity, m. None: unknown.",
        example="0.0",
        cost=(
            "The accelerometer counts as at the centre of gravity, unless alpha.vane_arm_m is given: then"
            " its place is estimated."
        ),
        mend="measure the distance along the fuselage",
    )] = None  # fmt: skip


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
    """Outputs, calibration and servo, which turn the elevator command into a deflection."""

    output: Annotated[int | Literal["auto"], Key(
        "Servo output 1..32. ``auto``: the outputs whose SERVOn_FUNCTION is elevator (19), elevon or "
        "V-tail.",
        example="auto",
        cost="The elevator is found by the autopilot's parameters; without them a log or link is refused.",
        mend="write the number of the servo output",
    )] = "auto"  # fmt: skip
    calibration: Annotated[Pairs | None, Key(
        "Pairs (PWM in us, deflection in deg, trailing edge down positive), with linear interpolation. "
        "None: SERVOn_MIN/TRIM/MAX and ±25 deg.",
        example="[[1100, -25.0], [1500, 0.0], [1900, 25.0]]",
        cost="The servo's end points count as 25 deg, so Z_δe and M_δe have an assumed scale.",
        mend="measure the deflection at three pulse widths",
    )] = None  # fmt: skip
    outputs: tuple[ElevatorOutput, ...] = ()
    """All servo outputs that make the deflection. The key ``outputs`` replaces ``output`` and
    ``calibration``."""
    lag_s: Annotated[float | None, Key(
        "First-order lag of the servo, s. None: unknown, and every result says so.",
        example="0.05",
        cost=(
            "The lag is estimated with the derivatives. Intervals are wider, and M_α and M_δe are too "
            "small if a flight does not determine the lag."
        ),
        mend="film a step of the servo on the ground; the lag is the time to 63 % of the step",
        within=(0.0, 2.0),
    )] = None  # fmt: skip
    delay_s: Annotated[float | None, Key(
        "Delay between command and servo, s. None: unknown.",
        example="0.02",
        cost="The delay counts as zero; a real delay biases M_α and M_q.",
        mend="film a step of the servo on the ground; the delay ends when the arm begins to move",
        within=(0.0, 2.0),
    )] = None  # fmt: skip

    @property
    def is_calibrated(self) -> bool:
        """Whether the file gives a calibration for every output of the elevator."""
        return self.calibration is not None or any(output.calibration for output in self.outputs)

    @property
    def ends_deg(self) -> tuple[float, float] | None:
        """Lowest and highest deflection of the calibration, deg. None without a calibration."""
        calibrations = [(output.weight, output.calibration) for output in self.outputs if output.calibration]
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
    """Outputs, calibration and servo of the aileron or of the rudder."""

    output: Annotated[int | Literal["auto"], Key(
        "Servo output 1..32. ``auto``: all outputs whose SERVOn_FUNCTION is the control's (4 aileron, 21 "
        "rudder), with elevons, flaperons and V-tails.",
        example="auto",
        cost="The autopilot's parameters must name the output; without them roll and yaw are not analyzed.",
        mend="write the number of the servo output",
    )] = "auto"  # fmt: skip
    calibration: Annotated[Pairs | None, Key(
        "Pairs (PWM in us, deflection in deg), with linear interpolation. A positive aileron rolls to the "
        "left, a positive rudder yaws to the left. None: SERVOn_MIN/TRIM/MAX and ±25 deg.",
        example="[[1100, -25.0], [1500, 0.0], [1900, 25.0]]",
        cost="The servo's end points count as 25 deg, so Y, L and N by this control have an assumed scale.",
        mend="measure the deflection at three pulse widths",
    )] = None  # fmt: skip
    lag_s: Annotated[float | None, Key(
        "First-order lag of the servo, s. None: unknown.",
        example="0.05",
        cost="The lag is estimated with the derivatives: L_p and the control's moments are less certain.",
        mend="film a step of the servo on the ground; the lag is the time to 63 % of the step",
        within=(0.0, 2.0),
    )] = None  # fmt: skip
    delay_s: Annotated[float | None, Key(
        "Delay between command and servo, s. None: unknown.",
        example="0.02",
        within=(0.0, 2.0),
    )] = None  # fmt: skip

    @property
    def ends_deg(self) -> tuple[float, float] | None:
        """Lowest and highest deflection of the calibration, deg. None without a calibration."""
        if self.calibration is None:
            return None
        angles = [deg for _, deg in self.calibration]
        return min(angles), max(angles)


Rule = Literal["continuous", "separate", "information"]
Criterion = Literal["eq12", "eq13"]


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
class TableColumns:
    """Names of the columns of a table (``.csv`` or ``.mat``) of a flight, or of a simulator's ``log:FILE``. A
    column without a name here is found by its usual name."""

    time: Annotated[str | None, Key("Column of the time, s.")] = None
    elevator: Annotated[str | None, Key(
        "Column of the elevator's deflection, positive trailing edge down.",
    )] = None  # fmt: skip
    q: Annotated[str | None, Key("Column of the pitch rate, positive nose up.")] = None
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
    aileron: Annotated[str | None, Key("Column of the aileron, positive for a roll to the left.")] = None
    rudder: Annotated[str | None, Key("Column of the rudder, positive for a yaw to the left.")] = None
    beta: Annotated[str | None, Key("Column of the sideslip, positive with wind from the right.")] = None
    a_y: Annotated[str | None, Key("Column of the specific force along body y, m/s².")] = None
    climb_rate: Annotated[str | None, Key("Column of the climb rate, m/s.")] = None
    units: Annotated[Literal["rad", "deg"], Key(
        "Unit of every angle and every angular rate whose column does not name its unit at its end.",
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
class Estimation:
    """Changes of the estimated model's structure: held parameters and added terms."""

    fixed: Annotated[Mapping[str, float], Key(
        "Parameter name to the value at which it is held; a held parameter is not estimated.",
    )] = field(default_factory=dict)  # fmt: skip
    terms: Annotated[tuple[str, ...], Key(
        "More terms, each EQUATION:EXPRESSION with a coefficient that is estimated: ``M:q*abs(q)``.",
    )] = ()  # fmt: skip

    def held(self, names: Container[str]) -> dict[str, float]:
        """Return the value of each held parameter of an axis, whose parameters are ``names``."""
        return {name: value for name, value in self.fixed.items() if name in names}

    @property
    def added(self) -> tuple[AddedTerm, ...]:
        return tuple(map(parse_term, self.terms))


@dataclass(frozen=True)
class Limits:
    """Limits that a test manoeuvre may not exceed."""

    bank_deg: Annotated[float, Key(
        "Largest bank angle in a manoeuvre, deg.",
        example="30.0",
        positive=True,
    )] = 30.0  # fmt: skip
    airspeed_change_percent: Annotated[float, Key(
        "Largest change of the air speed in a manoeuvre, %.",
        positive=True,
    )] = 15.0  # fmt: skip
    alpha_deg: Annotated[float | None, Key(
        "Largest angle of attack in a manoeuvre, deg. None: no limit.",
        example="12.0",
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
        cost=(
            "The derivatives hold at the mean air speed of each flight, so two flights are not compared "
            "at one."
        ),
        mend="write the air speed of the test point",
        positive=True,
    )] = None  # fmt: skip
    reference: Reference = field(default_factory=Reference)
    model: Annotated[Mapping[str, float], Key(
        "Parameter name to its value in the simulator of today, rad and s. Pitch: any of ``PARAMETERS``. "
        "Roll and yaw: Y, L or N with _beta, _p, _r, _delta_a or _delta_r, such as ``L_p``; L and N hold the "
        "products of inertia.",
        example=(
            "{M_alpha: -48.0, M_q: -4.2, M_delta_e: -100.0, Z_alpha: -8.0, L_p: -9.0, L_delta_a: -39.0, "
            "N_beta: 9.0, N_r: -1.3, N_delta_r: -8.0}"
        ),
        cost="advisor gap has no simulator to compare the flight with, unless --simulator names one.",
        mend="write the simulator's derivatives, or give simulator",
    )] = field(default_factory=dict)  # fmt: skip
    effects: Annotated[Mapping[str, Mapping[str, float]], Key(
        "Effects added to the simulator's model: effect names of the gap diagnosis with their parameters.",
    )] = field(default_factory=dict)  # fmt: skip
    campaign: CampaignPlan = field(default_factory=CampaignPlan)
    estimation: Estimation = field(default_factory=Estimation)
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
        """Air speed that the file gives for a log without air speed, m/s. None: the file gives no air
        speed."""
        return self.airspeed_m_s or self.reference_airspeed_m_s


_LETTERS = 20
"""Longest name, with which the text ``ADVISOR SCRIPT name hash`` has less than 50 bytes."""


@dataclass(frozen=True, slots=True)
class ScriptIdentity:
    """Name and calibrations of an aircraft file, as the texts of a script state them."""

    name: str
    """Name of the aircraft in ASCII, short enough for a text of 50 bytes."""
    calibration: str
    """Hash that changes with any calibration or stated output."""

    @classmethod
    def of(cls, aircraft: Aircraft) -> Self:
        name = printable(aircraft.name).encode("ascii", "replace").decode()[:_LETTERS].strip()
        elevator = aircraft.elevator
        stated = [(each.output, each.calibration) for each in (elevator, aircraft.aileron, aircraft.rudder)]
        parts = [(each.output, each.calibration, each.weight) for each in elevator.outputs]
        text = json.dumps([stated, parts])
        return cls(name, hashlib.sha256(text.encode()).hexdigest()[:8])
