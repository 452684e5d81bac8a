"""The table of a script: its inputs with their sizes, for one aircraft.

The rows of ``mixers.py`` read a control from the outputs' pulses. The forward mixer of a script is the
inverse. One degree of a control moves each output by its factor and leaves every other control unchanged.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import degrees, inf, radians

import numpy as np

from advisor.aircraft.aircraft import Aircraft, Pairs, ScriptIdentity
from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.decision.conditions import ALPHA_MARGIN, LINEAR_RAD, travel_of
from advisor.decision.inputs import StepInput
from advisor.flight.vehicle.mixers import Control as AnyControl
from advisor.flight.vehicle.mixers import Role, arduplane_roles
from advisor.model.axes.lateral import Trim, state_matrix
from advisor.model.short_period import ShortPeriod
from advisor.process.arrays import FloatArray
from advisor.scripts.inputs import CONTROLS, NAMES, Control, ScriptInput, input_of
from advisor.scripts.pace import Pace, pace_of

_ALL: tuple[AnyControl, ...] = (*CONTROLS, "flap")
_FUNCTIONS = ((4,), (19,), (21,), (24, 25), (77, 78), (79, 80))
"""Values of SERVOn_FUNCTION that a script moves, in groups that a mixer drives together."""


@dataclass(frozen=True, slots=True)
class StatedOutput:
    """A servo output that the aircraft file names for a control."""

    output: int
    factor: float
    """Degrees of the output for one degree of the control."""
    calibration: Pairs | None


def forward(roles: Mapping[int, Role]) -> dict[int, dict[Control, float]]:
    """Return degrees of each output for one degree of each control, for outputs of one mixer.

    The factors are the pseudo-inverse of the reading weights, so that reading them back gives the control
    alone.
    """
    outputs = sorted(roles)
    weights = np.array([[roles[n].weight(control) for n in outputs] for control in _ALL])
    factors = np.linalg.pinv(weights)
    return {
        n: {
            control: round(float(factors[row, column]), 6)
            for column, control in enumerate(CONTROLS)
            if abs(factors[row, column]) > 1e-9
        }
        for row, n in enumerate(outputs)
    }


def factors_by_function() -> dict[int, dict[Control, float]]:
    """Return degrees of an output for one degree of each control, by the output's SERVOn_FUNCTION."""
    factors: dict[int, dict[Control, float]] = {}
    for functions in _FUNCTIONS:
        roles = arduplane_roles(dict(enumerate(functions, 1)), None)
        factors |= {functions[n - 1]: moves for n, moves in forward(roles).items()}
    return factors


def stated_outputs(aircraft: Aircraft, control: Control) -> tuple[StatedOutput, ...]:
    """Return the outputs that the aircraft file names for a control; empty where the autopilot's parameters
    name them.
    """
    surface = getattr(aircraft, control)
    if control == "elevator" and aircraft.elevator.outputs:
        listed = aircraft.elevator.outputs
        return tuple(StatedOutput(o.output, float(np.sign(o.weight)), o.calibration) for o in listed)
    if surface.output == "auto":
        return ()
    return (StatedOutput(surface.output, 1.0, surface.calibration),)


LOWEST_M = 30.0
"""Usual height above home below which no input begins and every input ends, m. A pilot needs 2 s to see and
to recover, in which an aircraft at 30 deg nose down and 20 m/s loses 20 m."""


@dataclass(frozen=True, slots=True)
class FlightLimits:
    """Limits of a script, each with its unit in the name."""

    bank_deg: float
    airspeed_percent: float
    """Largest change of the air speed from its value before the input, %."""
    lowest_m: float
    pitch_deg: float = 30.0
    """Largest change of the pitch angle from its value before the input, deg. At a larger change, the weight
    along the path accelerates the aircraft by more than a third of g.
    """
    stick_percent: float = 10.0
    """Largest motion of a stick during an input, % of its travel from neutral. A larger motion means that a
    pilot takes over.
    """
    link_s: float = 3.0
    """Longest silence of the ground station, s. The limit applies if a ground station was heard before."""

    @classmethod
    def of(cls, aircraft: Aircraft, lowest_m: float = LOWEST_M) -> "FlightLimits":
        limits = aircraft.limits
        return cls(limits.bank_deg, limits.airspeed_change_percent, lowest_m)


FIRST_SHARE: Mapping[str, float] = {"elevator": 0.08, "aileron": 0.08, "rudder": 0.10}
"""Size of the first input as a fraction of the travel, if neither model nor flight is known. In ArduPlane's
simulator this elevator pitches by 4 to 20 deg in a 3-2-1-1, and this aileron banks by 10 deg in a doublet."""
MULTISINE_SHARE = 0.08
"""Peak of a multisine as a fraction of the travel, if neither model nor flight is known."""
LARGEST_SHARE = 0.25
"""Largest size by a model, as a share of the travel. A model that no flight has confirmed may be wrong by a
factor of two, and this size still leaves half of the travel."""
_PITCH_RAD = radians(15.0)
"""Largest pitch excursion of an input, rad: half of the pitch angle at which a script ends an input."""
_BANK_SHARE = 0.5
"""Largest predicted bank as a share of the limit of bank, at which a script ends an input."""
_USUAL_AIRSPEED_M_S = 20.0
"""Air speed for gravity's term in the sideslip equation if no air speed is stated, m/s."""
_STEP_S = 0.02
_PITCH_MODEL = ("Z_alpha", "M_alpha", "M_q", "M_delta_e")
_SIDE_MODEL = ("L_p", "L_delta_a")


@dataclass(frozen=True, slots=True)
class Size:
    """Largest deflection of one control within an input."""

    rad: float
    why: str
    """Reason in words, for the script's head."""


def size_of(
    test: ScriptInput,
    control: Control,
    aircraft: Aircraft,
    model: Mapping[str, float],
    flown_rad: float | None = None,
) -> Size:
    """Return the size of a control's deflection within an input.

    Parameters
    ----------
    model
        Derivatives by name, rad and s; may be empty.
    flown_rad
        Largest deflection from trim in an accepted manoeuvre of this control, rad; None without one.
    """
    travel = travel_of(getattr(aircraft, control).ends_deg)
    assumed = "" if getattr(aircraft, control).ends_deg else " (assumed)"
    of = f"of {np.degrees(travel):.4g} deg travel{assumed}"
    share = MULTISINE_SHARE if test.sines is not None else FIRST_SHARE[control]
    first = Size(share * travel, f"{100 * share:.0f} % {of}, to begin gently")
    if flown_rad is not None:
        first = Size(flown_rad, "size of the accepted manoeuvres in the log")
    most = Size(ALPHA_MARGIN * travel, f"{100 * ALPHA_MARGIN:.0f} % {of}")
    limited = _limited(test, control, aircraft, model)
    if limited is None:
        return min(first, most, key=lambda size: size.rad)
    largest = max(LARGEST_SHARE * travel, flown_rad or 0.0)
    by_share = Size(largest, f"{100 * largest / travel:.0f} % {of}, the most by a model")
    return min(limited, by_share, most, key=lambda size: size.rad)


def _limited(
    test: ScriptInput, control: Control, aircraft: Aircraft, model: Mapping[str, float]
) -> Size | None:
    """Return the size at which the model reaches the nearest limit; None without a model of this axis."""
    needed = _PITCH_MODEL if control == "elevator" else (*_SIDE_MODEL, *_RUDDER.get(control, ()))
    if not set(needed) <= set(model):
        return None
    command = unit_command(test, control)
    bank = _BANK_SHARE * radians(aircraft.limits.bank_deg)
    if control == "elevator":
        alpha, pitch = _peaks(*_pitch(model), command)
        stated = aircraft.limits.alpha_deg
        most = LINEAR_RAD if stated is None else min(LINEAR_RAD, 0.5 * radians(stated))
        limits = {"angle of attack": (most, alpha), "pitch": (_PITCH_RAD, pitch)}
    else:
        airspeed = aircraft.stated_airspeed_m_s or _USUAL_AIRSPEED_M_S
        beta, rolled = _peaks(*_side(model, control, airspeed), command)
        # Aileron and rudder bank the aircraft together.
        several = len({"aileron", "rudder"} & set(test.moved))
        limits = {"sideslip": (LINEAR_RAD, beta), "bank": (bank / several, rolled)}
    sizes = [
        Size(limit / peak if peak > 0.0 else inf, f"{name} of {np.degrees(limit):.3g} deg by the model")
        for name, (limit, peak) in limits.items()
    ]
    return min(sizes, key=lambda size: size.rad)


_RUDDER: Mapping[str, tuple[str, ...]] = {"rudder": ("N_beta", "N_delta_r")}
"""Further derivatives that the rudder's response needs."""


def unit_command(test: ScriptInput, control: Control) -> FloatArray:
    """Return the command of an input of size 1 and the rest after it, at intervals of 20 ms, shape (n,)."""
    t = np.arange(0.0, test.length_s + test.rest_s, _STEP_S)
    if test.sines is not None:
        return np.where(t < test.length_s, test.sines[control].values(t / test.length_s), 0.0)
    ends = test.unit_s * np.cumsum([units for units, _ in test.steps])
    shares = np.array([*(share for _, share in test.steps), 0.0])
    return np.asarray(shares[np.searchsorted(ends, t + 1e-9, side="right")])


def _pitch(model: Mapping[str, float]) -> tuple[FloatArray, FloatArray, tuple[int, int]]:
    """Return A and B of α, q, θ, and the rows of angle of attack and pitch."""
    short = ShortPeriod.from_mapping(model)
    a = np.zeros((3, 3))
    a[:2, :2], a[2, 1] = short.a, 1.0
    return a, np.array([*short.b, 0.0]), (0, 2)


def _side(
    model: Mapping[str, float], control: Control, airspeed_m_s: float
) -> tuple[FloatArray, FloatArray, tuple[int, int]]:
    """Return A and B of β, p, r, φ, and the rows of sideslip and bank."""
    theta = np.array([model.get(name, 0.0) for name in SIDE_PARAMETERS])
    ending = "delta_a" if control == "aileron" else "delta_r"
    b = np.array([model.get(f"{letter}_{ending}", 0.0) for letter in ("Y", "L", "N")] + [0.0])
    return state_matrix(theta, Trim(airspeed_m_s)), b, (0, 3)


def _peaks(a: FloatArray, b: FloatArray, rows: tuple[int, int], command: FloatArray) -> tuple[float, float]:
    """Return the largest absolute values of two states while the command is held over each step."""
    from scipy.signal import lsim  # not on the start path

    t = _STEP_S * np.arange(len(command) + 1)
    states = lsim((a, b[:, None], np.eye(len(b)), np.zeros((len(b), 1))), [*command, 0.0], t, interp=False)[1]
    peaks = np.max(np.abs(states), axis=0)
    return float(peaks[rows[0]]), float(peaks[rows[1]])


@dataclass(frozen=True, slots=True)
class Source:
    """Knowledge about the aircraft beyond its file."""

    model: Mapping[str, float] = field(default_factory=dict)
    """Derivatives by name, rad and s."""
    said: str = ""
    """Source of the derivatives, as a noun: ``the aircraft file's model``."""
    flown_rad: Mapping[Control, float] = field(default_factory=dict)
    """Largest deflection from trim in accepted manoeuvres, rad, by the control."""
    controls: tuple[Control, ...] = CONTROLS
    """Controls that the aircraft has."""
    parameters: Mapping[str, float] = field(default_factory=dict)
    """SERVOn parameters of a log, by name, which the script compares with the vehicle's."""


@dataclass(frozen=True, slots=True)
class Entry:
    """One input of a table with the sizes of its controls."""

    test: ScriptInput
    sizes: Mapping[Control, Size]


@dataclass(frozen=True, slots=True)
class ScriptTable:
    """All that a script states at its top."""

    aircraft: Aircraft
    pace: Pace
    entries: tuple[Entry, ...]
    limits: FlightLimits
    switch: int
    """Radio channel of the switch, 1 to 16, or the option 300 to 307 of the switch's RCn_OPTION."""
    outputs: Mapping[Control, tuple[StatedOutput, ...]]
    parameters: Mapping[str, float]

    @property
    def identity(self) -> ScriptIdentity:
        """Name and calibrations of the aircraft file, as the script states them."""
        return ScriptIdentity.of(self.aircraft)

    def travel_rad(self, control: Control) -> float:
        """Return the travel of a control from neutral to the nearer stop, rad."""
        return travel_of(getattr(self.aircraft, control).ends_deg)


def script_table(
    aircraft: Aircraft,
    source: Source,
    names: Sequence[str] = NAMES,
    period_s: float | None = None,
    switch: int = 7,
    limits: FlightLimits | None = None,
) -> ScriptTable:
    """Return the table of a script for one aircraft.

    Inputs of a control that the aircraft lacks are left out; a multisine then moves the others.
    """
    pace = pace_of(source.model, source.said, period_s)
    entries = []
    for name in names:
        test = input_of(name, pace, source.controls)
        if set(test.moved) <= set(source.controls):
            sizes = {
                control: size_of(test, control, aircraft, source.model, source.flown_rad.get(control))
                for control in test.moved
            }
            entries.append(Entry(test, sizes))
    return ScriptTable(
        aircraft,
        pace,
        tuple(entries),
        limits or FlightLimits.of(aircraft),
        switch,
        {control: stated_outputs(aircraft, control) for control in CONTROLS},
        source.parameters,
    )


_NAMES = {
    ("elevator", True): "3-2-1-1",
    ("elevator", False): "reverse 3-2-1-1",
    ("aileron", True): "aileron doublet",
    ("rudder", True): "rudder doublet",
}
"""Name in a script's table, by control and direction of the first step. A script flies the elevator only as
3-2-1-1, which contains the frequencies of other orders of steps.
"""


def next_order(advised: StepInput) -> tuple[int, float, float]:
    """Return the number of the input, its size in deg, and its time unit in s."""
    elevator = advised.control == "elevator"
    name = _NAMES[advised.control, advised.nose_up_first if elevator else True]
    return 1 + NAMES.index(name), round(degrees(advised.amplitude_rad), 2), round(advised.unit_s, 2)


def end_order(number: int) -> tuple[int, float, float]:
    """Return the order to end the multisine of this number, with a size that no script would fly."""
    return 0, -float(number), 0.0
