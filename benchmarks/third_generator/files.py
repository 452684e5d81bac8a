"""The files of a set: a log and an aircraft file for each case, and one key beside the folder."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from benchmarks.second_generator.case_files import key_file

from .cases import EFFECTS, Case, assignments, draw_case
from .messages import MANUAL, STABILIZE, log_bytes
from .plan import as_key
from .recording import record
from .trim import short_period


def tlog(case: Case) -> bytes:
    """The case's log."""
    streams = record(case.shown, case.setup.kit, np.random.default_rng(case.noise_seed))
    mode = STABILIZE if case.setup.plan.gains.damper > 0.0 else MANUAL
    return log_bytes(streams, case.wiring, case.ground_m, mode)


def _five(value: float | None) -> float | None:
    return None if value is None else float(f"{value:.5g}")


def aircraft_file(case: Case) -> str:
    """What a crew knows of its aircraft; a servo without a stated lag has none."""
    plan, kit, servo = case.setup.plan, case.setup.kit, case.setup.servo
    stated = servo.lag_s > 0.0
    document: dict[str, Any] = {
        "name": plan.aircraft.name,
        "elevator": {
            "output": "auto",
            "calibration": [list(point) for point in case.wiring.calibration],
            "lag_s": _five(servo.lag_s) if stated else None,
            "delay_s": _five(servo.delay_s) if stated else None,
        },
        "alpha": {"source": "auto", "vane_arm_m": _five(kit.vane_arm_m)},
        "accelerometer": {"arm_m": _five(kit.stated_imu_arm_m)},
        "airspeed_m_s": None,
        "reference_airspeed_m_s": _five(plan.aircraft.airspeed_m_s),
        "reference": {
            "mass_kg": _five(plan.shape.mass),
            "wing_area_m2": _five(plan.shape.area),
            "chord_m": _five(plan.shape.chord),
            "iyy_kg_m2": _five(plan.shape.inertia),
        },
        "model": {name: _five(value) for name, value in case.believed.items()},
    }
    return yaml.safe_dump(document, sort_keys=False)


def _equipment(case: Case) -> str:
    if case.setup.kit.boom:
        return "boom"
    return "autopilot" if case.setup.kit.sends_alpha else "no alpha"


def key_entry(case: Case) -> dict[str, Any]:
    """What is true of a case, SI units."""
    kit, turbulent = case.setup.kit, case.turbulence_rms > 0.0
    own, damping = short_period(case.setup.plan.model)
    return {
        "class": case.assignment.kind,
        "effects": [
            {
                "effect": one.name,
                "block": EFFECTS[one.name].block,
                "dynamic": EFFECTS[one.name].dynamic,
                "size": one.size,
                "parameters": one.parameters,
                "largest_dynamic_ratio": max(one.seen["dynamic_ratios"].values()),
                **one.seen,
            }
            for one in case.wrong
        ],
        "condition": {
            "name": f"{_equipment(case)}, {'turbulent' if turbulent else 'calm'}",
            "troubles": list(case.troubles),
            "background_turbulence_rms_m_s": case.turbulence_rms,
            "pre_filtered_hz": None,
        },
        "believed_model": case.believed,
        "short_period": {"natural_frequency_rad_s": own, "damping_ratio": damping},
        "instruments": asdict(kit),
        "servo": {"lag_s": case.setup.servo.lag_s, "delay_s": case.setup.servo.delay_s},
        "boot_s": case.wiring.boot_s,
        **as_key(case.setup.plan),
    }


def draw_set(folder: Path, count: int, seed: int, only: str | None = None) -> None:
    """Write ``count`` cases below a folder, and their key beside the folder."""
    key = {}
    for index, assignment in enumerate(assignments(count, seed, only), start=1):
        case = draw_case(assignment, seed, index)
        place = folder / f"{index:04d}"
        place.mkdir(parents=True, exist_ok=True)
        (place / "flight.tlog").write_bytes(tlog(case))
        (place / "aircraft.yaml").write_text(aircraft_file(case))
        key[place.name] = key_entry(case)
    document = {"seed": seed, "only": only, "cases": key}
    key_file(folder).write_text(json.dumps(document, indent=1, sort_keys=True) + "\n")
