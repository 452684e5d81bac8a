"""Improved simulator as a file: the aircraft file with the flight's results."""

from collections.abc import Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import yaml

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.gap.candidates.known import less_of_the_servo, together
from advisor.gap.result import Diagnosis
from advisor.words.plain import plain


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
