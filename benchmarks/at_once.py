"""Inputs of three surfaces at once, flown by ArduPlane, against the truth by its simulator's formulas.

    python -m benchmarks.at_once [TLOG ...] [--coefficients FILE] [--keep FILE]
    python -m benchmarks.at_once --airframes 9 [--seed N] [--keep FILE]

With ``--airframes``, each of so many drawn airframes flies, as ``benchmarks.arduplane_generator`` draws them.
Without a log, ArduPlane in software in the loop flies three multisines of 20 s. Each moves elevator, aileron
and rudder at once. The table shows each derivative of both axes, with its truth at the true air speed flown.
The ground speed is the true air speed, because no wind blows. The exit code is 0 if every stretch is found
once and accepted on each axis.
"""

import argparse
import json
import struct
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.campaign import Campaign
from advisor.campaign.state import CampaignState, JudgedManeuver
from advisor.mavlink.logs.whole import read_whole_log
from advisor.oem.estimate import Estimate
from benchmarks.ardupilot_plane import MASS_KG, SKYWALKER
from benchmarks.arduplane_generator.airframe import DENSITY, draw_airframe
from benchmarks.arduplane_generator.simulator import FOLDER, fly, is_here

STRETCHES = 3
FULL_RAD = float(np.radians(25.0)) * 500.0 / 400.0
"""Deflection at the simulator's control of 1, rad: 500 us, of which SERVOn_MIN and MAX give 400 us 25 deg."""
ARM_M = (-0.15, -0.05)
"""Place of the stock plane's centre of gravity along body x and z, m (CGOffset)."""
NEAR = 0.05
NORMAL_95 = 1.96
_SCRIPT = Path(__file__).with_name("at_once.lua")


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table of each log; 1 if a stretch is not accepted on both axes."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("logs", nargs="*", type=Path)
    parser.add_argument("--coefficients", type=Path, default=FOLDER / "light.json")
    parser.add_argument(
        "--keep", type=Path, default=Path("at-once.tlog"), help="where a flown log is written"
    )
    parser.add_argument("--airframes", type=int, default=0, help="number of drawn airframes that fly")
    parser.add_argument("--seed", type=int, default=29)
    given = parser.parse_args(arguments)
    if not given.logs and not is_here():
        print(f"No log is given, and {FOLDER} holds no simulator: give a log.", file=sys.stderr)
        return 2
    coefficients = json.loads(given.coefficients.read_text(encoding="utf-8"))
    if given.airframes:
        drawn = [draw_airframe(np.random.default_rng([given.seed, k])) for k in range(given.airframes)]
        return max(_table(_flown(one.coefficients, given.keep), one.coefficients) for one in drawn)
    logs = given.logs or [_flown(coefficients, given.keep)]
    return max(_table(log, coefficients) for log in logs)


def _flown(coefficients: Mapping[str, float], path: Path) -> Path:
    """Fly the script, and return the path of the tlog."""
    lua = _SCRIPT.read_text(encoding="utf-8")
    heard = fly(coefficients, {}, lua)
    with path.open("wb") as log:
        for boot_s, message in heard.messages:
            log.write(struct.pack(">Q", round(1.7e15 + 1e6 * boot_s)) + bytes(message.get_msgbuf()))
    return path


def _table(log: Path, coefficients: Mapping[str, float]) -> int:
    """Print what the advisor makes of a log, and return 1 if a stretch is not accepted on both axes."""
    campaign = Campaign(Aircraft(), lateral=True)
    for columns in read_whole_log(log):
        campaign.feed(columns)
    campaign.finish()
    found = campaign.state
    sideways = found.lateral.maneuvers if found.lateral is not None else ()
    print(f"\n{log.name}: {_counted(found.maneuvers)} in pitch, {_counted(sideways)} in roll and yaw")
    print("\n| derivative | estimate | truth | off | inside |\n|---|---|---|---|---|")
    rows = list(_rows(log, found, coefficients))
    for name, value, half, truth in rows:
        off = f"{100.0 * (value / truth - 1.0):+.1f} %" if truth else "–"
        inside = "yes" if abs(value - truth) <= half else "**no**"
        print(f"| {name} | {value:.3g} ± {half:.2g} | {truth:.3g} | {off} | {inside} |")
    near = sum(bool(truth) and abs(value / truth - 1.0) <= NEAR for _, value, _, truth in rows)
    inside = sum(abs(value - truth) <= half for _, value, half, truth in rows)
    print(f"\n{inside} of {len(rows)} intervals hold; {near} estimates lie within {100.0 * NEAR:.0f} %.")
    for axis, state in found.axes.items():
        at = state.flight_test.stopped_at
        print(f"{axis}: {f'TEST COMPLETE after stretch {at}' if at else 'the test goes on'}")
        refused = [one.verdict.sentence for one in state.maneuvers if not one.verdict.accepted]
        print("".join(f"{axis} refused: {sentence}\n" for sentence in refused), end="", flush=True)
    accepted = [sum(one.verdict.accepted for one in axis) for axis in (found.maneuvers, sideways)]
    return 0 if accepted == [STRETCHES, STRETCHES] else 1


def _counted(maneuvers: Sequence[JudgedManeuver]) -> str:
    accepted = sum(one.verdict.accepted for one in maneuvers)
    return f"{accepted} of {len(maneuvers)} tests accepted"


def _rows(
    log: Path, found: CampaignState, coefficients: Mapping[str, float]
) -> Iterator[tuple[str, float, float, float]]:
    """Yield name, estimate, half of the 95 % interval and truth of each derivative."""
    side = found.lateral
    axes = ((found.model, found.maneuvers), (side.model, side.maneuvers) if side is not None else (None, ()))
    for model, maneuvers in axes:
        if model is not None:
            truth = derivatives(coefficients, _true_speed(log, maneuvers))
            yield from _compared(model, truth)


def _compared(model: Estimate, truth: Mapping[str, float]) -> Iterator[tuple[str, float, float, float]]:
    for name in model.names:
        if name in truth and name not in model.not_identifiable:
            k = model.names.index(name)
            yield name, float(model.theta[k]), NORMAL_95 * float(model.std[k]), truth[name]


def _true_speed(log: Path, maneuvers: Sequence[JudgedManeuver]) -> float:
    """Return the mean speed over the accepted manoeuvres, m/s, from the velocity over the ground."""
    speeds: list[float] = []
    for columns in (one for several in read_whole_log(log) for one in several):
        if columns.name != "GLOBAL_POSITION_INT":
            continue
        t = columns.fields["time_boot_ms"] * 1e-3
        v = 0.01 * np.sqrt(sum(columns.fields[name].astype(float) ** 2 for name in ("vx", "vy", "vz")))
        for span in (one.maneuver.span for one in maneuvers if one.verdict.accepted):
            speeds += v[(t >= span.record_from_s) & (t <= span.end_s)].tolist()
    if not np.any(speeds):
        raise SystemExit(f"{log.name} has no velocity over the ground: give a tlog with GLOBAL_POSITION_INT.")
    return float(np.mean(speeds))


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


if __name__ == "__main__":
    sys.exit(main())
