"""The files of a case: the log and the aircraft file that the diagnosis sees, the key that it does not."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from .design import assignments
from .draw import Case, draw_case, largest_speed_change
from .telemetry import record
from .tlog import tlog


def log_bytes(case: Case) -> bytes:
    """The case's tlog."""
    rng = np.random.default_rng(case.record_seed + 1)
    time = case.experiment.time
    streams = record(time, case.flown.observed, case.flown.truth, case.recorder, case.noise, rng)
    return tlog(streams, case.wiring, case.experiment.aircraft.elevation_m)


def aircraft_text(case: Case) -> str:
    """The case's aircraft file: what a crew knows."""
    aircraft = case.experiment.aircraft
    document: dict[str, Any] = {
        "name": "test aircraft",
        "elevator": {
            "output": "auto",
            "calibration": [list(point) for point in case.wiring.calibration],
            "lag_s": None,
            "delay_s": None,
        },
        "alpha": {"source": "auto", "vane_arm_m": _rounded(case.stated_arms["vane"])},
        "accelerometer": {"arm_m": _rounded(case.stated_arms["accelerometer"])},
        "airspeed_m_s": None,
        "reference_airspeed_m_s": aircraft.airspeed_m_s,
        "reference": {
            "mass_kg": aircraft.mass_kg,
            "wing_area_m2": aircraft.wing_area_m2,
            "chord_m": aircraft.chord_m,
            "iyy_kg_m2": aircraft.pitch_inertia_kg_m2,
        },
    }
    if case.believed is not None:
        document["model"] = {name: _rounded(value) for name, value in case.believed.as_dict().items()}
    return yaml.safe_dump(document, sort_keys=False)


def _rounded(value: float | None) -> float | None:
    return None if value is None else float(f"{value:.5g}")


def key_entry(case: Case) -> dict[str, Any]:
    """What is true about the case, SI units."""
    experiment = case.experiment
    effects = [
        {
            "effect": sized.effect.name,
            "block": sized.effect.block,
            "dynamic": sized.effect.dynamic,
            "size": sized.size,
            "parameters": sized.parameters,
            "ratios": sized.ratios,
            "dynamic_ratios": sized.dynamic_ratios,
            "largest_dynamic_ratio": sized.largest_dynamic_ratio,
        }
        for sized in case.effects
    ]
    return {
        "class": case.assignment.kind,
        "effects": effects,
        "condition": {
            "name": "hard" if case.troubles else "clean",
            "troubles": list(case.troubles),
            "background_turbulence_rms_m_s": case.background_rms,
            "pre_filtered_hz": case.recorder.low_pass,
            "stamp_jitter_s": case.recorder.jitter,
            "command": "linear" if experiment.link.period == 1 else "held",
            "largest_speed_change": largest_speed_change(experiment.plan, case.flown),
        },
        "aircraft": asdict(experiment.aircraft),
        "linear_model": experiment.linear.as_dict(),
        "short_period": {
            "natural_frequency_rad_s": experiment.omega,
            "damping_ratio": experiment.linear.damping_ratio,
        },
        "believed_model": None if case.believed is None else case.believed.as_dict(),
        "stated_arms_m": case.stated_arms,
        "noise": asdict(case.noise),
        "rates_hz": case.recorder.rates,
        "imu": case.wiring.imu,
        "boot_s": case.wiring.boot_s,
        "maneuvers": [asdict(maneuver) for maneuver in experiment.plan.maneuvers],
    }


def draw_set(folder: Path, count: int, seed: int, only: str | None = None) -> None:
    """Write `count` cases below a folder, and their key beside it."""
    key = {}
    for index, assignment in enumerate(assignments(count, seed, only), start=1):
        name = f"{index:04d}"
        case = draw_case(assignment, seed, index)
        place = folder / name
        place.mkdir(parents=True, exist_ok=True)
        (place / "flight.tlog").write_bytes(log_bytes(case))
        (place / "aircraft.yaml").write_text(aircraft_text(case))
        key[name] = key_entry(case)
    document = {"seed": seed, "only": only, "cases": key}
    key_file(folder).write_text(json.dumps(document, indent=1, sort_keys=True) + "\n")


def key_file(folder: Path) -> Path:
    """Where the key of a folder of cases is."""
    return folder.parent / f"{folder.name}.key.json"
