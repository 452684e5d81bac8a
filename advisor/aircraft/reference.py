"""The user's simulator in the aircraft file: derivatives, geometry, trim and names of its variables."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Literal

from advisor.aircraft.key import Key

PARAMETERS = ("Z_0", "Z_alpha", "Z_q", "Z_delta_e", "M_0", "M_alpha", "M_q", "M_delta_e")
"""Names of the eight parameters θ, Eq. (3), in the order of every vector of parameters in this program."""
SIDE_PARAMETERS = tuple(f"{y}_{x}" for y in "YLN" for x in ("beta", "p", "r", "delta_a", "delta_r"))
"""Names of the fifteen derivatives of roll and yaw, in the order of every vector of theirs."""
_OF_SIDE_MOMENTS = {"0": 2, "beta": 2, "p": 1, "r": 1, "delta_a": 2, "delta_r": 2}
SPEED_EXPONENTS: Mapping[str, int] = {
    "Z_0": 1,
    "Z_alpha": 1,
    "Z_q": 0,
    "Z_delta_e": 1,
    "M_0": 2,
    "M_alpha": 2,
    "M_q": 1,
    "M_delta_e": 2,
    **{f"Y_{x}": power - 1 for x, power in _OF_SIDE_MOMENTS.items()},
    **{f"{y}_{x}": power for y in "LN" for x, power in _OF_SIDE_MOMENTS.items()},
}
"""Power of the air speed with which each parameter of either axis grows at constant density.

Z = -ρVS·C_L/(2m) and M = ρV²Sc·C_m/(2I_yy); a rate derivative carries another c/(2V). Y grows like Z; L and N
grow like M.
"""


@dataclass(frozen=True)
class Reference:
    """Geometry and mass for non-dimensional coefficients."""

    mass_kg: Annotated[float | None, Key(
        "Mass of the aircraft as flown, kg.",
        example="10.0",
        cost="No non-dimensional lift derivatives, and no static margin.",
        mend="weigh the aircraft",
        positive=True,
    )] = None  # fmt: skip
    wing_area_m2: Annotated[float | None, Key(
        "Reference area of the coefficients, m².",
        example="0.6",
        cost="No non-dimensional derivatives (C_m_alpha and the like).",
        mend="take the area from the drawing",
        positive=True,
    )] = None  # fmt: skip
    span_m: Annotated[float | None, Key(
        "Wing span, m, for the coefficients of roll and yaw.",
        example="2.0",
        cost="Roll and yaw are exported to no program that needs coefficients.",
        mend="take the span from the drawing",
        positive=True,
    )] = None  # fmt: skip
    chord_m: Annotated[float | None, Key(
        "Mean aerodynamic chord, m.",
        example="0.25",
        cost="No non-dimensional derivatives, and no static margin.",
        mend="take the chord from the drawing",
        positive=True,
    )] = None  # fmt: skip
    iyy_kg_m2: Annotated[float | None, Key(
        "Pitching moment of inertia about the centre of gravity, kg m².",
        example="1.0",
        cost="No non-dimensional moment derivatives, and no static margin.",
        mend="swing the aircraft as a pendulum, or take the value of the design",
        positive=True,
    )] = None  # fmt: skip
    ixx_kg_m2: Annotated[float | None, Key(
        "Rolling moment of inertia about the centre of gravity, kg m².",
        example="0.5",
        positive=True,
    )] = None  # fmt: skip
    izz_kg_m2: Annotated[float | None, Key(
        "Yawing moment of inertia about the centre of gravity, kg m².",
        example="1.3",
        positive=True,
    )] = None  # fmt: skip
    ixz_kg_m2: Annotated[float | None, Key(
        "Product of inertia in the plane of symmetry, kg m². None: 0.",
        example="0.0",
    )] = None  # fmt: skip
    cg_percent_chord: Annotated[float | None, Key(
        "Distance of the centre of gravity behind the leading edge of the mean aerodynamic chord, % of "
        "the chord.",
        example="25.0",
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
    p: Annotated[str | None, Key("Output: roll rate. Roll and yaw also need r, bank, and a_y or beta.")] = (
        None
    )
    r: Annotated[str | None, Key("Output: yaw rate.")] = None
    bank: Annotated[str | None, Key("Output: bank angle.")] = None
    a_y: Annotated[str | None, Key("Output: specific force along body y, m/s².")] = None
    beta: Annotated[str | None, Key("Output: sideslip, positive where the wind comes from the right.")] = None
    aileron: Annotated[str | None, Key("Input: aileron; the replay uses the logged one if there is one.")] = (
        None
    )
    rudder: Annotated[str | None, Key("Input: rudder; the replay uses the logged one if there is one.")] = (
        None
    )
    throttle: Annotated[
        str | None, Key("Input: throttle; the replay uses the logged one if there is one.")
    ] = None
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
