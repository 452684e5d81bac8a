"""Aircraft files as the simulator reads them: the linear aircraft of a file's ``model``."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from .effects.terms import problems_with
from .linear import ShortPeriod
from .loading import ScenarioError
from .servo import Calibration


@dataclass(frozen=True)
class AircraftFile:
    """The part of an aircraft file that a flight needs."""

    model: ShortPeriod
    calibration: Calibration | None = None
    elevator_output: int | None = None
    lag_s: float = 0.0
    delay_s: float = 0.0
    airspeed_m_s: float | None = None
    vane_arm_m: float = 0.0
    accelerometer_arm_m: float = 0.0
    effects: Mapping[str, Mapping[str, float]] = field(default_factory=dict)


def read_aircraft(path: Path) -> AircraftFile:
    """Read an aircraft file.

    Raises
    ------
    ScenarioError
        The file cannot be read, its ``model`` lacks a parameter, or an effect is unknown.
    """
    try:
        data = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise ScenarioError([f"{path}: cannot be read as YAML ({type(error).__name__})"]) from error
    if not isinstance(data, Mapping):
        raise ScenarioError([f"{path}: an aircraft file is a mapping of keys to values"])
    problems: list[str] = []
    elevator, alpha = _section(data, "elevator", problems), _section(data, "alpha", problems)
    model = _section(data, "model", problems)
    missing = [name for name in ShortPeriod.__dataclass_fields__ if name not in model]
    if missing:
        problems.append(f"model: {', '.join(missing)} missing; all eight are needed to fly")
    problems += [
        f"model.{name}: must be a number, is {value}" for name, value in model.items()
        if not (isinstance(value, int | float) and math.isfinite(value))
    ]  # fmt: skip
    if elevator.get("outputs"):
        problems.append(
            "elevator.outputs: the bundled aircraft has one elevator output; give elevator.output and "
            "elevator.calibration to fly it"
        )
    effects = {str(name): _numbers(sizes) for name, sizes in _section(data, "effects", problems).items()}
    problems += problems_with(effects)
    if problems:
        raise ScenarioError(problems)
    output = elevator.get("output")
    return AircraftFile(
        model=ShortPeriod(**{name: float(model[name]) for name in ShortPeriod.__dataclass_fields__}),
        calibration=_calibration(elevator.get("calibration")),
        elevator_output=output if isinstance(output, int) else None,
        lag_s=float(elevator.get("lag_s") or 0.0),
        delay_s=float(elevator.get("delay_s") or 0.0),
        airspeed_m_s=data.get("reference_airspeed_m_s") or data.get("airspeed_m_s"),
        vane_arm_m=float(alpha.get("vane_arm_m") or 0.0),
        accelerometer_arm_m=float(_section(data, "accelerometer", problems).get("arm_m") or 0.0),
        effects=effects,
    )


def _section(data: Mapping[str, Any], name: str, problems: list[str]) -> Mapping[str, Any]:
    section = data.get(name) or {}
    if not isinstance(section, Mapping):
        problems.append(f"{name}: must be a mapping")
        return {}
    return section


def _numbers(sizes: object) -> dict[str, float]:
    if not isinstance(sizes, Mapping):
        return {}
    return {
        str(name): float(value)
        for name, value in sizes.items()
        if isinstance(value, int | float) and math.isfinite(value)
    }


def _calibration(points: object) -> Calibration | None:
    if not isinstance(points, list):
        return None
    return Calibration(tuple(sorted((float(pulse), float(angle)) for pulse, angle in points)))
