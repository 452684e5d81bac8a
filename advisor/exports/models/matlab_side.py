"""A, B, C, D of roll and yaw for MATLAB and Octave, with the derivatives and their intervals.

    x = [β; p; r; φ],  u = [δa; δr],  y = [p; r; φ; a_y; β],  all departures from level flight

The specific force along body y at the centre of gravity is V times the derivatives' part of β̇.
"""

from dataclasses import replace

import numpy as np

from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.exports.models.exported import Exported, commented
from advisor.exports.models.flown import FlownModel, SideModel
from advisor.exports.models.improvement import air_note, zero_said
from advisor.exports.models.matlab import script_text
from advisor.flight.signals.messages import FloatArray
from advisor.model.lateral import state_matrix
from advisor.words.quantities import SIDE_PARAMETERS as QUANTITIES


def both_axes_text(model: FlownModel) -> Exported:
    """Return the script: the variables of the short period, then ``lateral`` as one structure."""
    pitch = script_text(model.pitch) if model.pitch is not None else Exported("")
    if model.side is None:
        return pitch
    side = _side_text(model.name, model.side)
    return Exported(pitch.text + side, (*pitch.left_out, *map(zero_said, model.side.zeros)))


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
        if parameter not in side.values:
            lines.append(f"% {parameter} is not identifiable: {side.untold[parameter]}")
            continue
        value, width = side.values[parameter].value, side.half(parameter)
        unit = QUANTITIES[parameter].unit.replace("²", "^2")
        lines += [
            f"lateral.parameters.{parameter}.value = {value:.8g};  % {unit}",
            f"lateral.parameters.{parameter}.ci95 = [{value - width:.8g}, {value + width:.8g}];",
        ]
    for name, servo in side.servos.items():
        lines.append(f"lateral.servo.{name}.lag_s = {servo.lag_s:.6g};  % s")
        lines.append(f"lateral.servo.{name}.delay_s = {servo.delay_s:.6g};  % s")
    return head + "\n".join(lines) + "\n"
