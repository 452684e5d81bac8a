"""A, B, C, D of roll and yaw for MATLAB and Octave, with the derivatives and their intervals.

    x = [β; p; r; φ],  u = [δa; δr],  y = [p; r; φ; a_y; β],  all departures from level flight

The specific force along body y at the centre of gravity is V times the derivatives' part of β̇.
"""

import numpy as np

from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.exports.models.exported import Exported, commented
from advisor.exports.models.flown import FlownModel, SideModel
from advisor.exports.models.matlab import script_text
from advisor.flight.signals.messages import FloatArray
from advisor.model.lateral import state_matrix
from advisor.words.quantiles import NORMAL_95
from advisor.words.quantities import SIDE_PARAMETERS as QUANTITIES


def both_axes_text(model: FlownModel) -> Exported:
    """Return the script: the variables of the short period, then ``lateral`` as one structure."""
    text = script_text(model.pitch).text if model.pitch is not None else ""
    return Exported(text + (_side_text(model.name, model.side) if model.side is not None else ""))


def matrices(side: SideModel) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return A (4, 4), B (4, 2), C (5, 4) and D (5, 2)."""
    value = dict(zip(SIDE_PARAMETERS, side.found.estimate.theta.tolist(), strict=True))
    b = np.array([[value[f"{y}_{u}"] for u in ("delta_a", "delta_r")] for y in "YLN"] + [[0.0, 0.0]])
    c, d = np.zeros((5, 4)), np.zeros((5, 2))
    c[0, 1] = c[1, 2] = c[2, 3] = c[4, 0] = 1.0
    c[3, :3] = [side.trim.airspeed_m_s * value[f"Y_{x}"] for x in ("beta", "p", "r")]
    d[3] = side.trim.airspeed_m_s * b[0]
    return state_matrix(side.found.estimate.theta, side.trim), b, c, d


def _side_text(name: str, side: SideModel) -> str:
    estimate = side.found.estimate
    head = commented(
        [
            f"{name}: roll and yaw by the inflight advisor.",
            "State x = [beta; p; r; phi] (rad, rad/s), input u = [delta_a; delta_r] (rad; a positive aileron",
            "rolls, a positive rudder yaws to the left), output y = [p; r; phi; a_y; beta] (SI).",
            "L and N hold the products of inertia. xdot = A*x + B*u, y = C*x + D*u.",
        ],
        "%",
    )
    lines = [f"lateral.V = {side.trim.airspeed_m_s:.8g};  % air speed of the derivatives, m/s"]
    for letter, matrix in zip("ABCD", matrices(side), strict=True):
        rows = "; ".join(", ".join(f"{x:.8g}" for x in row) for row in matrix.tolist())
        lines.append(f"lateral.{letter} = [{rows}];")
    half = (NORMAL_95 * estimate.std).tolist()
    for parameter, value, width in zip(SIDE_PARAMETERS, estimate.theta.tolist(), half, strict=True):
        if parameter in estimate.not_identifiable:
            lines.append(f"% {parameter} is not identifiable: {estimate.not_identifiable[parameter]}")
            continue
        unit = QUANTITIES[parameter].unit.replace("²", "^2")
        lines += [
            f"lateral.parameters.{parameter}.value = {value:.8g};  % {unit}",
            f"lateral.parameters.{parameter}.ci95 = [{value - width:.8g}, {value + width:.8g}];",
        ]
    return head + "\n".join(lines) + "\n"
