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
"""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import SIDE_PARAMETERS, Reference
from advisor.exports.models.ardupilot.servos import calibrated, parameters_text, travel_of
from advisor.exports.models.exported import Exported, commented, effects_beside
from advisor.exports.models.flown import FlownModel, SideModel
from advisor.exports.models.formats import AxisAsked, ModelFormat, refuse_lacking
from advisor.exports.models.improvement import REFERENCE_KEYS, Improvement, air_note, missing_reference
from advisor.words.problems import ConfigurationError

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
