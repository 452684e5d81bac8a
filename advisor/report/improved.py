"""Improved simulator as a file with the flight's results, and the check of a user's simulator."""

from collections.abc import Iterator, Mapping
from dataclasses import asdict, replace
from math import degrees, isfinite, tau
from pathlib import Path
from typing import Any

import yaml

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.gap.candidates.known import less_of_the_servo, together
from advisor.gap.result import Diagnosis
from advisor.simulators.check import CheckedSimulator
from advisor.words.plain import picked, plain
from advisor.words.quantities import NORMAL_95, with_half


def improved_file(diagnosis: Diagnosis, aircraft: Aircraft) -> Mapping[str, Any]:
    """Return the aircraft file with the fitted model and the effects found."""
    flown, effects = less_of_the_servo(aircraft, together(aircraft.effects, diagnosis.effects))
    speed = diagnosis.reference_airspeed_m_s
    if speed is not None and diagnosis.air is not None:
        speed = diagnosis.air.read_speed(speed)
    model = {name: v.value for name, v in diagnosis.model.items()}
    return file_content(flown, speed, model, effects)


def file_content(
    aircraft: Aircraft,
    read_airspeed_m_s: float | None,
    model: Mapping[str, float],
    effects: Mapping[str, Mapping[str, float]],
) -> dict[str, Any]:
    """Return an aircraft file with new derivatives, their air speed, and new effects.

    Derivatives of roll and yaw that ``model`` lacks are unchanged.
    """
    content: dict[str, Any] = {"name": f"{aircraft.name}, improved"}
    kept = replace(aircraft, name=Aircraft().name, model={}, effects={}, simulator=None)
    content.update(_beyond(asdict(kept), asdict(Aircraft())))
    if read_airspeed_m_s is not None:
        content["reference_airspeed_m_s"] = round(read_airspeed_m_s, 4)
    side = {name: value for name, value in aircraft.model.items() if name in SIDE_PARAMETERS}
    content["model"] = side | {name: _digits(value) for name, value in model.items()}
    content["effects"] = {
        effect: {name: _digits(value) for name, value in values.items()} for effect, values in effects.items()
    }
    return content


def _beyond(content: Mapping[str, Any], usual: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of a file that differ from the defaults, section by section."""
    beyond = {}
    for key, value in content.items():
        if isinstance(value, Mapping) and (inside := _beyond(value, usual.get(key) or {})):
            beyond[key] = inside
        elif not isinstance(value, Mapping) and value != usual.get(key):
            beyond[key] = value
    return beyond


def text_of(content: Mapping[str, Any]) -> str:
    """Return the text of an improved file."""
    text = yaml.safe_dump(plain(content), sort_keys=False, allow_unicode=True)
    return "# Written by the inflight advisor: the simulator with the findings of the flight.\n" + text


def improved_name(diagnosis: Diagnosis, aircraft_file: str | None) -> str:
    """Return the file name ``<aircraft>-with-<effect>.yaml``."""
    stem = Path(aircraft_file).stem if aircraft_file is not None else "aircraft"
    first = next((cause.effect for cause in diagnosis.causes if cause.present), "fitted-model")
    return f"{stem}-with-{first.replace('_', '-')}.yaml"


def _digits(x: float) -> float:
    return float(f"{x:.6g}")


SCHEMA = "advisor.simulator/1"
_LACKS = {
    "increments": "the diagnosis cannot fly effects of force and moment",
    "mass": "the simulator flies at its own mass",
    "wind": "the simulator flies in still air",
    "throttle": "the flight's throttle movements are not flown",
    "aileron": "the flight's aileron is not flown",
    "rudder": "the flight's rudder is not flown",
}


def document(checked: CheckedSimulator) -> dict[str, Any]:
    """Return the ``advisor.simulator/1`` document."""
    fault = checked.fault
    return {
        "schema": SCHEMA,
        "usable": fault is None,
        **picked(checked, "simulator airspeed_m_s height_m alpha_rad trim a_z_m_s2 rest_q_rad_s takes lacks"),
        **picked(checked, "derivatives std side lag_s dead_time_s omega_rad_s damping notes"),
        "problems": []
        if fault is None
        else [picked(fault.refuse(checked.simulator).problem, "code text fix")],
    }


def lines(checked: CheckedSimulator) -> Iterator[str]:
    """Yield the results of the check, one per line."""
    yield f"{checked.simulator} at {checked.airspeed_m_s:.4g} m/s true air speed, {checked.height_m:.0f} m"
    controls = "".join(f", {name} {_control(name, value)}" for name, value in checked.trim.items())
    yield f"trim        α {degrees(checked.alpha_rad):+.2f} deg{controls}"
    turns = f"pitch rate below {degrees(checked.rest_q_rad_s):.3f} deg/s"
    yield f"at rest     a_z {checked.a_z_m_s2:+.2f} m/s², {turns}"
    if checked.fault is not None:
        return
    yield "signs       a_z down, α and q nose up: kinematically consistent"
    yield "units       rad, rad/s, m/s²: kinematically consistent"
    yield f"elevator    dead time {1e3 * checked.dead_time_s:.0f} ms, lag {1e3 * checked.lag_s:.0f} ms"
    if isfinite(checked.damping):
        hertz = checked.omega_rad_s / tau
        yield f"short period {checked.omega_rad_s:.2f} rad/s ({hertz:.2f} Hz), damping {checked.damping:.2f}"
    else:
        yield "short period none: the simulator is statically unstable at this speed"
    yield f"numbers     {_with_errors(checked.derivatives, checked.std)}"
    if checked.side:
        yield f"roll, yaw   {_with_errors(checked.side, checked.std)}"
    yield "            ±: half the 95 % interval, including motion that a linear model does not describe"
    yield f"takes       elevator{''.join(f', {name}' for name in checked.takes)}"
    for name in checked.lacks:
        yield f"does not take {name}: {_LACKS[name]}"
    yield from checked.notes


def _with_errors(values: Mapping[str, float], std: Mapping[str, float]) -> str:
    return ", ".join(f"{name} {with_half(value, NORMAL_95 * std[name])}" for name, value in values.items())


def _control(name: str, value: float) -> str:
    return f"{100.0 * value:.0f} %" if name == "throttle" else f"{degrees(value):+.2f} deg"
