"""The aircraft file of a model: pitch, roll and yaw at one air speed, with their servos."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from advisor.aircraft.aircraft import Aircraft
from advisor.exports.models.flown import FlownModel, SideModel
from advisor.model.lateral import LATERAL
from advisor.process.atomic_file import write_atomically
from advisor.report.improved import file_content, improved_file, text_of


def file_text(model: FlownModel) -> str:
    """Return the text of the aircraft file."""
    return text_of(file_of(model))


def write_file(model: FlownModel, path: Path) -> None:
    """Write the aircraft file as a whole."""
    write_atomically(path, file_text(model))


def file_of(model: FlownModel) -> dict[str, Any]:
    """Return the aircraft file with all known derivatives, and with the servos of aileron and rudder."""
    aircraft, side = _with_servos(model.aircraft, model.side), model.side
    if model.diagnosis is not None:
        content = dict(improved_file(model.diagnosis, aircraft))
    elif model.pitch is not None:
        pitch = model.pitch
        flown = replace(aircraft, elevator=replace(aircraft.elevator, lag_s=pitch.servo.lag_s or None))
        numbers = {name: value.value for name, value in pitch.model.items()}
        content = file_content(flown, pitch.air.read_speed(pitch.airspeed_m_s), numbers, aircraft.effects)
    else:
        content = file_content(aircraft, aircraft.reference_airspeed_m_s, aircraft.model, aircraft.effects)
    if side is not None:
        read = side.air.read_speed(side.trim.airspeed_m_s)
        content.setdefault("reference_airspeed_m_s", round(read, 4))
        content["model"] = content["model"] | _at(side, content["reference_airspeed_m_s"] / read)
    return content


def _with_servos(aircraft: Aircraft, side: SideModel | None) -> Aircraft:
    """Return the aircraft with the lag and the delay of each servo of roll and yaw that are known."""
    changed: dict[str, Any] = {}
    for name, servo in (side.servos if side is not None else {}).items():
        control = getattr(aircraft, name)
        changed[name] = replace(
            control, lag_s=_known(servo.lag_s, control.lag_s), delay_s=_known(servo.delay_s, control.delay_s)
        )
    return replace(aircraft, **changed)


def _known(found: float, stated: float | None) -> float | None:
    return round(found, 6) if found else stated


def _at(side: SideModel, faster: float) -> Mapping[str, float]:
    """Return the derivatives of roll and yaw at another air speed, ``faster`` times theirs."""
    powers = {term.name: term.power for term in LATERAL.shared}
    return {name: float(f"{value.value * faster ** powers[name]:.6g}") for name, value in side.values.items()}
