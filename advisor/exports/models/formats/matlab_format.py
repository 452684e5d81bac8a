"""Format ``matlab``: a MATLAB and Octave script with A, B, C, D of both axes, and all intervals.

    x = [α; q],  u = δe,  y = [α; q; a_z],  all departures from trim
    x = [β; p; r; φ],  u = [δa; δr],  y = [p; r; φ; a_y; β],  all departures from level flight

With N = α̇ - q, the specific force along body z at the centre of gravity is V·N to first order. The rows of
the normal acceleration are V times (Z_α, Z_q) and V·Z_δe. The specific force along body y is V times the
derivatives' part of β̇.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from advisor.aircraft.reference import PARAMETERS, SIDE_PARAMETERS
from advisor.exports.flights.findings import PARAMETER_UNITS
from advisor.exports.models.flown import FlownModel, SideModel
from advisor.exports.models.formats import ModelFormat
from advisor.exports.models.improvement import Exported, Improvement, air_note, commented, effects_beside
from advisor.gap.result import Value
from advisor.model.axes.lateral import state_matrix
from advisor.process.arrays import FloatArray
from advisor.words.quantities import NORMAL_95
from advisor.words.quantities import SIDE_PARAMETERS as QUANTITIES


class MatlabFormat(ModelFormat):
    """A script without dependencies."""

    suffix = ".m"

    def made(self, model: FlownModel, file: Path) -> Exported:
        return both_axes_text(model)


FORMAT = MatlabFormat()


def both_axes_text(model: FlownModel) -> Exported:
    """Return the script: the variables of the short period, then ``lateral`` as one structure."""
    nothing = Exported("", ("pitch, which no flight and no file gives",))
    pitch = script_text(model.pitch) if model.pitch is not None else nothing
    if model.side is None:
        return replace(pitch, left_out=(*pitch.left_out, "roll and yaw, which no flight and no file gives"))
    side = _side_text(model.name, model.side)
    return Exported(pitch.text + side, (*pitch.left_out, *model.side.left_out))


def matrices(side: SideModel) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return A (4, 4), B (4, 2), C (5, 4) and D (5, 2)."""
    value = dict(zip(SIDE_PARAMETERS, side.numbers.tolist(), strict=True))
    speed = side.true_airspeed_m_s
    b = np.array([[value[f"{y}_{u}"] for u in ("delta_a", "delta_r")] for y in "YLN"] + [[0.0, 0.0]])
    c, d = np.zeros((5, 4)), np.zeros((5, 2))
    c[0, 1] = c[1, 2] = c[2, 3] = c[4, 0] = 1.0
    c[3, :3] = [speed * value[f"Y_{x}"] for x in ("beta", "p", "r")]
    d[3] = speed * b[0]
    return state_matrix(side.numbers, replace(side.trim, airspeed_m_s=speed)), b, c, d


def _side_text(name: str, side: SideModel) -> str:
    head = commented(
        [
            f"{name}: roll and yaw by the inflight advisor.",
            "State x = [beta; p; r; phi] (rad, rad/s), input u = [delta_a; delta_r] (rad; a positive aileron",
            "rolls, a positive rudder yaws to the left), output y = [p; r; phi; a_y; beta] (SI).",
            "L and N hold the products of inertia. xdot = A*x + B*u, y = C*x + D*u.",
            air_note(side.air),
        ],
        "%",
    )
    lines = [f"lateral.V = {side.true_airspeed_m_s:.8g};  % true air speed of the derivatives, m/s"]
    for letter, matrix in zip("ABCD", matrices(side), strict=True):
        rows = "; ".join(", ".join(f"{x:.8g}" for x in row) for row in matrix.tolist())
        lines.append(f"lateral.{letter} = [{rows}];")
    for parameter in SIDE_PARAMETERS:
        if parameter in side.values:
            unit = QUANTITIES[parameter].unit.replace("²", "^2")
            lines += _valued(f"lateral.parameters.{parameter}", side.values[parameter], unit)
        else:
            lines.append(f"% {parameter} is not identifiable: {side.untold[parameter]}")
    for name, servo in side.servos.items():
        lines.append(f"lateral.servo.{name}.lag_s = {servo.lag_s:.6g};  % s")
        lines.append(f"lateral.servo.{name}.delay_s = {servo.delay_s:.6g};  % s")
    return head + "\n".join(lines) + "\n"


def script_text(improvement: Improvement) -> Exported:
    """Return the script. The script needs no toolbox, and sets variables in the workspace."""
    m = {name: improvement.number(name) for name in PARAMETERS}
    speed, servo = improvement.true_airspeed_m_s, improvement.servo
    head = commented(
        [
            f"{improvement.name}: short period found by the inflight advisor.",
            "State x = [alpha; q] (rad, rad/s), input u = delta_e (rad, trailing edge down positive),",
            "output y = [alpha; q; a_z] (rad, rad/s, m/s^2; body z is down): departures from trim.",
            "xdot = A*x + B*u, y = C*x + D*u, where u has passed the servo below.",
            air_note(improvement.air),
        ],
        "%",
    )
    matrices = [
        f"V = {speed:.8g};  % true air speed of the derivatives, m/s",
        f"A = [{m['Z_alpha']:.8g}, {1.0 + m['Z_q']:.8g}; {m['M_alpha']:.8g}, {m['M_q']:.8g}];",
        f"B = [{m['Z_delta_e']:.8g}; {m['M_delta_e']:.8g}];",
        f"C = [1, 0; 0, 1; V*({m['Z_alpha']:.8g}), V*({m['Z_q']:.8g})];",
        f"D = [0; 0; V*({m['Z_delta_e']:.8g})];",
        "% Each parameter: value, and the ends of its 95 % interval.",
    ]
    for name in PARAMETERS:
        matrices += _valued(f"parameters.{name}", improvement.model[name], PARAMETER_UNITS[name])
    rate = f"{servo.rate_rad_s:.6g}" if servo.rate_rad_s else "Inf"
    between = [
        "% Between command and surface: delay, then lag, then what limits the surface.",
        f"servo.delay_s = {servo.delay_s:.6g};  % s",
        f"servo.lag_s = {servo.lag_s:.6g};  % s, by which the surface trails a ramp",
        f"servo.damping = {servo.damping or 0.0:.6g};  % 0: a lag of first order, 1/(lag_s*s + 1)",
        f"servo.rate_limit_rad_s = {rate};  % rad/s",
        f"servo.backlash_rad = {servo.play_rad:.6g};  % rad, whole width",
        f"servo.deadband_rad = {servo.deadband_rad:.6g};  % rad, whole width",
        f"servo.deadband_neutral_rad = {servo.neutral_rad:.6g};  % rad, its middle",
    ]
    left = (*effects_beside(improvement), *improvement.untold)
    return Exported(head + "\n".join([*matrices, *between]) + "\n", left)


def _valued(path: str, value: Value, unit: str) -> list[str]:
    """Return the script's statements for a parameter: value, and both ends of its 95 % interval."""
    half = NORMAL_95 * value.std
    return [
        f"{path}.value = {value.value:.8g};  % {unit}",
        f"{path}.ci95 = [{value.value - half:.8g}, {value.value + half:.8g}];",
    ]
