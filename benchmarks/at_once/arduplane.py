"""ArduPlane in software in the loop flies the script's multisines; its formulas tell the truth."""

import json
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.scripts.ardupilot import ardupilot_script
from advisor.scripts.inputs import MULTISINE
from advisor.scripts.table import Source, script_table
from benchmarks.ardupilot_plane import MASS_KG, SKYWALKER
from benchmarks.arduplane_generator.airframe import DENSITY
from benchmarks.scripted.flight import ScriptFlight, level
from benchmarks.scripted.pilot import Airframe, airborne

FULL_RAD = float(np.radians(25.0)) * 500.0 / 400.0
"""Deflection at the simulator's control of 1, rad: 500 us, of which SERVOn_MIN and MAX give 400 us 25 deg."""
ARM_M = (-0.15, -0.05)
"""Place of the stock plane's centre of gravity along body x and z, m (CGOffset)."""
LONGEST_S = 900.0
"""Longest real time of a flight, s."""


def fly(coefficients: Mapping[str, float], log: Path, inputs: int, mode: str) -> None:
    """Fly multisines of the script for an unknown aircraft, and write the log with the coefficients next to
    it."""
    table = script_table(Aircraft(), Source(), (MULTISINE,))
    log.with_suffix(".json").write_text(json.dumps(dict(coefficients), indent=1), encoding="utf-8")
    with tempfile.TemporaryDirectory() as name:
        flown = Path(name) / "flight.tlog"
        with airborne(ardupilot_script(table), Path(name), Airframe(coefficients), LONGEST_S) as pilot:
            flight = ScriptFlight(pilot, table, flown)
            for number in range(1, inputs + 1):
                level(pilot, mode)
                flight.begun(number)
                flight.over(number)
        shutil.copy(flown, log)


def derivatives(coefficients: Mapping[str, float], speed_m_s: float) -> dict[str, float]:
    """Return the derivatives of the simulated plane at a true air speed, rad and s, by the contract's signs.

    The angular acceleration is the aerodynamic moment, with the moments of the forces about the centre of
    gravity (``libraries/SITL/SIM_Plane.cpp``, ``getTorque``). A positive pulse raises the nose. It rolls and
    yaws to the right.
    """
    c = SKYWALKER | dict(coefficients)
    v, x, z = speed_m_s, c.get("CGOffset_x", ARM_M[0]), c.get("CGOffset_z", ARM_M[1])
    force = 0.5 * DENSITY * v**2 * c["s"]
    per_mass, long, span = force / (MASS_KG * v), c["c"] / (2.0 * v), c["b"] / (2.0 * v)
    told = {
        "Z_alpha": -per_mass * (c["c_lift_a"] + c["c_drag_p"]), "Z_q": -per_mass * c["c_lift_q"] * long,
        "Z_delta_e": per_mass * c["c_lift_deltae"] / FULL_RAD,
        "M_alpha": force * (c["c"] * c["c_m_a"] + x * (c["c_lift_a"] + c["c_drag_p"])),
        "M_q": force * c["c"] * c["c_m_q"] * long,
        "M_delta_e": -force * c["c"] * c["c_m_deltae"] / FULL_RAD,
        "Y_beta": per_mass * c["c_y_b"], "Y_p": 0.0, "Y_r": 0.0, "Y_delta_a": 0.0,
        "Y_delta_r": -per_mass * c["c_y_deltar"] / FULL_RAD,
    }  # fmt: skip
    for letter, name, arm in (("L", "l", -z), ("N", "n", x)):
        moments = {
            "beta": c["b"] * c[f"c_{name}_b"] + arm * c["c_y_b"],
            "p": c["b"] * c[f"c_{name}_p"] * span,
            "r": c["b"] * c[f"c_{name}_r"] * span,
            "delta_a": -c["b"] * c[f"c_{name}_deltaa"] / FULL_RAD,
            "delta_r": -(c["b"] * c[f"c_{name}_deltar"] + arm * c["c_y_deltar"]) / FULL_RAD,
        }
        told |= {f"{letter}_{ending}": force * moment for ending, moment in moments.items()}
    return told
