"""Format ``ardupilot``: coefficients of the built-in plane, and a file with its servo parameters.

ArduPilot's plane in the loop reads the keys by ``--model plane:FILE.json``, and keeps its own numbers for
missing keys. Its conventions, from its source (``libraries/SITL/SIM_Plane``):

- forces are divided by a fixed mass of 2 kg: lift, drag and side force are scaled by 2 kg/m;
- the drag is c_drag_p + C_L²/(π·oswald·b²/s): a scaled lift needs c_drag_p and oswald scaled alike;
- the torque is used as the rotational acceleration: pitch is divided by I_yy, and derivatives of roll and yaw
  with the products of inertia inside fit as they are, c_l_b = L_β/(q̄·S·b);
- rates are made dimensionless by c/(2·V) and b/(2·V), as in ``advisor.oem.coefficients``;
- the sideslip is positive with wind from the right;
- ``CGOffset`` moves the forces from the centre of gravity; it is zero, because the derivatives refer to that
point.

The file is read from its first brace, and lines behind ``#`` are comments (``AP_JSON``).

ArduPilot's simulated surfaces are numbers from -1 to 1, at 1000 and 2000 us. Coefficients of a control are
therefore per 500 us, with the sign of the calibration.
"""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

from advisor.aircraft.aircraft import Aircraft, Pairs
from advisor.aircraft.reference import SIDE_PARAMETERS, Reference
from advisor.exports.models.flown import FlownModel, SideModel
from advisor.exports.models.formats import AxisAsked, ModelFormat, refuse_lacking
from advisor.exports.models.improvement import (
    REFERENCE_KEYS,
    Exported,
    ExportedServo,
    Improvement,
    air_note,
    commented,
    effects_beside,
    missing_reference,
)
from advisor.model.axes.lateral import LATERAL
from advisor.words.problems import ConfigurationError

NEUTRAL_US, HALF_TRAVEL_US = 1500.0, 500.0
OUTPUTS = {"aileron": 1, "elevator": 2, "rudder": 4}
"""Servo output from which ArduPilot's plane reads each control."""
FUNCTIONS = {"aileron": 4, "elevator": 19, "rudder": 21}
"""Value of SERVOn_FUNCTION for each control."""


@dataclass(frozen=True)
class Travel:
    """Straight line through the end points of a calibration."""

    neutral_rad: float
    """Deflection at 1500 us, rad."""
    per_half_rad: float
    """Change of the deflection per 500 us, rad."""
    low_us: float
    high_us: float
    """Pulse widths at both ends of the calibration, us."""

    @property
    def trim_us(self) -> float:
        """Pulse width at zero deflection, within the ends, us."""
        at = NEUTRAL_US - HALF_TRAVEL_US * self.neutral_rad / self.per_half_rad
        return min(max(at, self.low_us), self.high_us)


def travel_of(aircraft: Aircraft, control: str) -> Travel:
    """Return the travel of the elevator, aileron or rudder.

    Raises
    ------
    ConfigurationError
        The aircraft file has no calibration of this control.
    """
    parts = _calibrations(aircraft, control)
    if not parts:
        raise ConfigurationError(
            f"--export ardupilot: coefficients are per full travel of the servo; give {control}.calibration "
            "in the aircraft file."
        )
    total = sum(weight for weight, _ in parts)
    neutral = travel = 0.0
    for weight, pairs in parts:
        (low_us, low), (high_us, high) = min(pairs), max(pairs)
        slope = (high - low) / (high_us - low_us)
        neutral += weight / total * (low + slope * (NEUTRAL_US - low_us))
        travel += weight / total * slope * HALF_TRAVEL_US
    ends = parts[0][1]
    return Travel(math.radians(neutral), math.radians(travel), min(ends)[0], max(ends)[0])


def calibrated(aircraft: Aircraft) -> list[str]:
    """Return the controls with a calibration in the aircraft file."""
    return [name for name in ("elevator", *LATERAL.inputs) if _calibrations(aircraft, name)]


def _calibrations(aircraft: Aircraft, control: str) -> list[tuple[float, Pairs]]:
    """Return the calibrations of a control's outputs, with their weights."""
    stated = getattr(aircraft, control)
    if stated.calibration:
        return [(1.0, stated.calibration)]
    return [(o.weight, o.calibration) for o in getattr(stated, "outputs", ()) if o.calibration]


SERVO_TRAVEL_DEG = 45.0
"""Deflection for full travel in ArduPilot's servo model, deg."""
_RIGHT = {"elevator": "M_delta_e", "aileron": "L_delta_a", "rudder": "N_delta_r"}
"""Derivative whose sign gives the direction of each control."""


def parameters_text(model: FlownModel) -> Exported:
    """Return parameters of ArduPilot's servos, one on each line."""
    servos = _servos(model)
    control, servo = next(iter(servos.items()), ("elevator", ExportedServo()))
    head = [
        f"{model.name}: servos by the inflight advisor, for ArduPilot's simulation.",
        "ArduPilot's plane reads aileron, elevator and rudder from outputs 1, 2 and 4.",
        f"Lag, delay and rate are the {control}'s: ArduPilot's model is the same for every servo.",
        *(f"{name}: {', '.join(s.lines()) or 'follows at once'}." for name, s in servos.items()),
    ]
    lines = "".join(
        f"{name} {value:.6g}\n" for name, value in (*_outputs(model), *_motion(servo, model, control))
    )
    slack = {"actuator backlash": servo.play_rad, "actuator deadband": servo.deadband_rad}
    left = [name for name, size in slack.items() if size]
    left += [f"{name}: {', '.join(s.lines())}" for name, s in servos.items() if s != servo and s.lines()]
    effects = effects_beside(model.pitch) if model.pitch is not None else ()
    return Exported(commented(head, "#") + lines, (*left, *effects))


def _servos(model: FlownModel) -> dict[str, ExportedServo]:
    """Return the servo of each control with a known model, the elevator's first."""
    pitch = {"elevator": model.pitch.servo} if model.pitch is not None else {}
    return pitch | (dict(model.side.servos) if model.side is not None else {})


def _outputs(model: FlownModel) -> Iterator[tuple[str, float]]:
    """Yield function, direction and end points of each output with a calibration."""
    values = {n: v.value for n, v in (model.pitch.model if model.pitch is not None else {}).items()}
    if model.side is not None:
        values |= {n: v.value for n, v in model.side.values.items()}
    for control in calibrated(model.aircraft):
        travel, output = travel_of(model.aircraft, control), OUTPUTS[control]
        yield f"SERVO{output}_FUNCTION", FUNCTIONS[control]
        # ArduPilot lengthens the pulse for nose up, roll to the right and nose right, unless it is reversed.
        power = values.get(_RIGHT[control], -1.0) * travel.per_half_rad
        yield f"SERVO{output}_REVERSED", float(power < 0.0)
        yield f"SERVO{output}_MIN", travel.low_us
        yield f"SERVO{output}_TRIM", round(travel.trim_us)
        yield f"SERVO{output}_MAX", travel.high_us


def _motion(servo: ExportedServo, model: FlownModel, control: str) -> Iterator[tuple[str, float]]:
    """Yield the parameters of a servo's lag, delay and rate."""
    # Alone, SIM_SERVO_SPEED is a first-order lag's time constant; with a delay or filter, a rate limit.
    lag_s = max(servo.lag_s, 0.0)
    speed, delay, cutoff = lag_s, servo.delay_s, 0.0
    if delay > 0.0 or servo.rate_rad_s or servo.damping:
        speed = 0.0
        cutoff = math.sqrt(2.0) / (2.0 * math.pi * lag_s) if lag_s > 0.0 else 0.0
    if servo.rate_rad_s:
        travel = travel_of(model.aircraft, control).per_half_rad
        speed = 60.0 * abs(travel) / (SERVO_TRAVEL_DEG * servo.rate_rad_s)
        # Without a delay or filter, the speed would be read as a lag. One step is the least delay.
        delay = delay if delay > 0.0 or cutoff > 0.0 else 0.001
    yield from {"SIM_SERVO_SPEED": speed, "SIM_SERVO_DELAY": delay, "SIM_SERVO_FILTER": cutoff}.items()


MASS_KG = 2.0
"""Fixed mass by which ArduPilot's plane divides its forces, kg."""
OWN_DRAG, OWN_OSWALD = 0.1, 0.9
"""Zero-lift drag and Oswald factor of ArduPilot's own plane (``skywalker_2013``). The flight determines
neither drag nor Oswald factor, so the defaults are kept."""
SIDE_KEYS = ("wing_area_m2", "span_m")
FACTORS = {"beta": "b", "p": "p", "r": "r", "delta_a": "deltaa", "delta_r": "deltar"}
"""ArduPilot's spelling of each factor of a derivative."""
_CONTROLS = {"delta_a": "aileron", "delta_r": "rudder"}
FIRST_VERSION = "4.7"
"""First ArduPlane version that reads a file of coefficients (ArduPilot's pull request 29809, April 2025)."""
LOADED = "Loaded plane aero coefficients from"
"""Beginning of ArduPlane's message after it has read the file."""
FRAME_WORDS = (
    "-heavy", "-jet", "-sr75", "-revthrust", "-elevon", "-vtail", "-dspoilers", "-redundant", "-elevrev",
    "-catapult", "-bungee", "-throw", "-tailsitter", "-steering", "-3d", "-ice", "-soaring",
)  # fmt: skip
"""Words that change ArduPilot's plane if they occur in the model's name or file name."""

AXES = {"pitch": "pitch", "lateral": "roll and yaw"}
Keys = dict[str, float | list[float]]


class Part(NamedTuple):
    """Coefficients of one axis."""

    keys: Keys
    notes: Sequence[str]
    left: Sequence[str]
    """Derivatives and effects that the file does not contain."""


def plane_text(model: FlownModel, file_name: str) -> Exported:
    """Return the coefficients of all known axes as JSON with comments.

    Raises
    ------
    ConfigurationError
        The aircraft file lacks keys for each known axis.
    """
    aircraft = model.aircraft
    parts, left = [], []
    for axis, missing in lacking(aircraft).items():
        flown = model.pitch if axis == "pitch" else model.side
        if flown is None:
            left.append(f"{AXES[axis]}, which no flight and no file gives")
        elif missing:
            left.append(f"{AXES[axis]}, for want of {', '.join(missing)} in the aircraft file")
        else:
            parts.append(
                _pitch(flown, aircraft) if isinstance(flown, Improvement) else _side(flown, aircraft)
            )
    if not parts:
        raise ConfigurationError(f"--export ardupilot: {file_name} was not written: {'; '.join(left)}.")
    keys: Keys = {key: value for part in parts for key, value in part.keys.items()}
    keys["CGOffset"] = [0.0, 0.0, 0.0]
    rounded = {k: float(f"{v:.6g}") if isinstance(v, float) else v for k, v in keys.items()}
    left += [line for part in parts for line in part.left]
    notes = [note for part in parts for note in part.notes]
    head = [*_head(model.name, file_name), *notes, *(f"Not in this file: {line}." for line in left)]
    return Exported(_commented(head) + json.dumps(rounded, indent=1) + "\n", tuple(left))


def _head(name: str, file_name: str) -> Iterator[str]:
    stem = file_name.removesuffix(".json")
    yield f"{name}: coefficients by the inflight advisor, for the plane of ArduPilot's simulation. Load:"
    yield f"  sim_vehicle.py -v ArduPlane --model plane:{file_name} --add-param-file {stem}.parm"
    yield f'ArduPlane {FIRST_VERSION} and later print "{LOADED} {file_name}".'
    yield "An older version ignores the file silently: use a newer one, or apply pull request 29809."


def _commented(head: list[str]) -> str:
    # ArduPilot's reader begins at the first brace of the file.
    return commented([line.translate({ord("{"): "(", ord("}"): ")"}) for line in head], "#")


def _pitch(pitch: Improvement, aircraft: Aircraft) -> Part:
    reference = pitch.reference
    coefficients = pitch.coefficients()
    travel = travel_of(aircraft, "elevator")
    neutral, full = travel.neutral_rad, travel.per_half_rad
    c = {name: coefficient.value for name, coefficient in coefficients.items()}
    mass, inertia = reference.mass_kg or math.nan, reference.iyy_kg_m2 or math.nan
    lift, moment = MASS_KG / mass, 1.0 / inertia
    keys: Keys = {
        "s": reference.wing_area_m2 or math.nan,
        "c": reference.chord_m or math.nan,
        "c_lift_0": lift * (c["C_L_0"] + c["C_L_delta_e"] * neutral),
        "c_lift_a": lift * c["C_L_alpha"],
        "c_lift_q": lift * c["C_L_q"],
        "c_lift_deltae": lift * c["C_L_delta_e"] * full,
        "c_drag_p": lift * OWN_DRAG,
        "oswald": lift * OWN_OSWALD,
        "c_m_0": moment * (c["C_m_0"] + c["C_m_delta_e"] * neutral),
        "c_m_a": moment * c["C_m_alpha"],
        "c_m_q": moment * c["C_m_q"],
        "c_m_deltae": moment * c["C_m_delta_e"] * full,
    }
    if reference.span_m is not None:
        keys["b"] = reference.span_m
    notes = [
        f"c_lift_* are C_L times 2 kg / {mass:.6g} kg: the mass of ArduPilot's plane is 2 kg.",
        f"c_drag_p and oswald are scaled alike: C_D0 {OWN_DRAG:g} and e {OWN_OSWALD:g} are ArduPilot's own.",
        f"c_m_* are C_m divided by I_yy = {inertia:.6g} kg m2: ArduPilot takes the torque as acceleration.",
        f"c_*_deltae are per 500 us of pulse width, {math.degrees(full):+.4g} deg here.",
        f"Pitch at {pitch.true_airspeed_m_s:.4g} m/s true. {air_note(pitch.air)}",
        "C_L and C_m per radian: " + ", ".join(f"{name} {value:.6g}" for name, value in c.items()) + ".",
    ]
    return Part(keys, notes, (*effects_beside(pitch), *pitch.untold))


def _side(side: SideModel, aircraft: Aircraft) -> Part:
    reference = aircraft.reference
    area, span = reference.wing_area_m2 or math.nan, reference.span_m or math.nan
    speed = side.true_airspeed_m_s
    pressure = side.air.dynamic_pressure(side.trim.airspeed_m_s)
    moment = 1.0 / (pressure * area * span)
    scale = {"Y": MASS_KG * speed / (pressure * area), "L": moment, "N": moment}
    rate = 2.0 * speed / span
    travel = {factor: travel_of(aircraft, name).per_half_rad for factor, name in _CONTROLS.items()}
    factors = {"beta": 1.0, "p": rate, "r": rate, **travel}
    keys: Keys = {"s": area, "b": span}
    for parameter in SIDE_PARAMETERS:
        if parameter in side.values:
            letter, factor = parameter[0], parameter[2:]
            value = scale[letter] * factors[factor] * side.number(parameter)
            keys[f"c_{letter.lower()}_{FACTORS[factor]}"] = value
    notes = [
        "c_l_* and c_n_* hold the moments of inertia: ArduPilot takes the torque as acceleration.",
        "c_y_* are for 2 kg, the mass of ArduPilot's plane.",
        "c_*_deltaa and c_*_deltar are per 500 us of pulse width, "
        f"{math.degrees(travel['delta_a']):+.4g} and {math.degrees(travel['delta_r']):+.4g} deg here.",
        f"Roll and yaw at {speed:.4g} m/s true. {air_note(side.air)}",
    ]
    return Part(keys, notes, side.left_out)


def lacking(aircraft: Aircraft) -> Mapping[str, list[str]]:
    """Return the missing keys of the aircraft file for each axis' coefficients."""
    reference: Reference = aircraft.reference
    measured = calibrated(aircraft)
    return {
        "pitch": [
            *missing_reference(reference, REFERENCE_KEYS),
            *(["elevator.calibration"] if "elevator" not in measured else []),
        ],
        "lateral": [
            *missing_reference(reference, SIDE_KEYS),
            *(f"{name}.calibration" for name in ("aileron", "rudder") if name not in measured),
        ],
    }


PARAMETERS = ".parm"
"""Ending of the parameter file that is written next to the coefficients."""
ENDINGS = (PARAMETERS, ".param")
"""Endings of ArduPilot's parameter files."""


class ArduPilotFormat(ModelFormat):
    """Format with ``.json`` and a ``.parm`` next to it, or ``.parm`` alone."""

    suffix = ".json"

    def files(self, file: Path) -> tuple[Path, ...]:
        """Return the ordered file, and the servo parameter file next to coefficients."""
        return (file, file.with_suffix(PARAMETERS)) if file.suffix == self.suffix else (file,)

    def refuse(self, file: Path, aircraft: Aircraft, axis: AxisAsked) -> None:
        """Refuse an ending, a name that ArduPilot takes for a frame, and missing keys of the axis."""
        if file.suffix not in (self.suffix, *ENDINGS):
            raise ConfigurationError(
                f"--export ardupilot: {file} must end in .json (coefficients, with the servos in "
                f"{file.stem}.parm) or .parm (servos alone)."
            )
        if file.suffix != self.suffix:
            return
        word = next((w for w in FRAME_WORDS if w in file.name), None)
        if word is not None:
            raise ConfigurationError(
                f"--export ardupilot: ArduPilot takes {word} in {file.name} for one of its frames; "
                "name the file without it."
            )
        missing = lacking(aircraft)
        refuse_lacking([missing[axis]] if axis != "both" else [*missing.values()], "ardupilot")

    def made(self, model: FlownModel, file: Path) -> Exported:
        """Return the coefficients with the parameters next to them, or the parameters."""
        parameters = parameters_text(model)
        if file.suffix != self.suffix:
            return parameters
        plane = plane_text(model, file.name)
        left = tuple(dict.fromkeys((*plane.left_out, *parameters.left_out)))
        return replace(plane, left_out=left, beside=(parameters.text,))


FORMAT = ArduPilotFormat()
