"""The improved simulator as a file: the aircraft file with the flight's findings."""

from collections.abc import Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import yaml

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.gap.candidates.known import less_of_the_servo, together
from advisor.gap.result import Diagnosis
from advisor.process.atomic_file import write_atomically
from advisor.words.plain import plain


def improved_file(diagnosis: Diagnosis, aircraft: Aircraft) -> Mapping[str, Any]:
    """Return the aircraft file with the fitted model and the effects found in it."""
    content: dict[str, Any] = {"name": f"{aircraft.name}, improved"}
    flown, effects = less_of_the_servo(aircraft, together(aircraft.effects, diagnosis.effects))
    kept = replace(flown, name=Aircraft().name, model={}, effects={}, simulator=None)
    content.update(_beyond(asdict(kept), asdict(Aircraft())))
    if diagnosis.reference_airspeed_m_s is not None:
        as_read = diagnosis.reference_airspeed_m_s / diagnosis.true_over_read
        content["reference_airspeed_m_s"] = round(as_read, 4)
    side = {name: value for name, value in aircraft.model.items() if name in SIDE_PARAMETERS}
    content["model"] = side | {name: _digits(v.value) for name, v in diagnosis.model.items()}
    content["effects"] = {
        effect: {name: _digits(value) for name, value in values.items()} for effect, values in effects.items()
    }
    return content


def _beyond(content: Mapping[str, Any], usual: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of a file that differ from the defaults, section by section."""
    found = {}
    for key, value in content.items():
        if isinstance(value, Mapping) and (inside := _beyond(value, usual.get(key) or {})):
            found[key] = inside
        elif not isinstance(value, Mapping) and value != usual.get(key):
            found[key] = value
    return found


def write_improved(diagnosis: Diagnosis, aircraft: Aircraft, path: Path) -> Path:
    """Write the improved simulator as a file that ``advisor`` and ``python -m sim`` load."""
    text = yaml.safe_dump(plain(improved_file(diagnosis, aircraft)), sort_keys=False, allow_unicode=True)
    head = "# Written by `advisor gap`: the simulator with the findings of the flight.\n"
    write_atomically(path, head + text)
    return path


def improved_name(diagnosis: Diagnosis, aircraft_file: str | None) -> str:
    """Return the name ``<aircraft>-with-<effect>.yaml``."""
    stem = Path(aircraft_file).stem if aircraft_file is not None else "aircraft"
    first = next(iter(diagnosis.effects), "fitted-model")
    return f"{stem}-with-{first.replace('_', '-')}.yaml"


def _digits(x: float) -> float:
    return float(f"{x:.6g}")
