"""Slopes of side force, roll and yaw of a JSBSim aircraft, measured in a separate process.

    python -m advisor.exports.models.jsbsim.axes.lateral_slopes

The aircraft is trimmed in lift and pitch, then perturbed in β, p, r, aileron and rudder at rest. Forces and
accelerations are read before any motion.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from advisor.exports.models.jsbsim.slopes import STEPS, Request, answer, measured

VARIABLES = {
    "beta": "aero/beta-rad",
    "p": "velocities/p-aero-rad_sec",
    "r": "velocities/r-aero-rad_sec",
    "delta_a": "fcs/left-aileron-pos-rad",
    "delta_r": "fcs/rudder-pos-rad",
}
"""Property that represents each variable of roll and yaw."""
_SIZES = (0.01, 0.05, 0.05, 0.1, 0.1)
"""Perturbations of β, p and r in rad and rad/s, and of the commands of aileron and rudder (-1 to 1)."""


@dataclass(frozen=True)
class SideRequest:
    """Flight condition in which a JSBSim aircraft is measured."""

    airspeed_m_s: float
    height_m: float


@dataclass(frozen=True)
class SideSlopes:
    """Measured slopes of roll and yaw in one condition."""

    derivatives: dict[str, float]
    """Fifteen lateral derivatives, SI. Derivatives by a control are per radian of the control's property."""
    signs: dict[str, float]
    """Sign of each control's property, by the control's name. The sign is positive if a positive property
    turns to the left."""
    turning: list[list[float]]
    """Shape (2, 2): roll and yaw acceleration per roll and yaw moment, 1/(slug·ft²)."""
    momentum: float
    """Mass times speed, slug·ft/s."""
    pressure_psf: float
    span_time_s: float
    """Time b/(2·V) that makes rates dimensionless, s."""


def side_measured(fdm: Any, asked: SideRequest) -> SideSlopes:
    """Return the slopes of a loaded aircraft from perturbations about its trim.

    Raises
    ------
    ArithmeticError
        The aircraft has no trim in this condition, or a control moves nothing.
    """
    trim = measured(fdm, Request([], "fcs/elevator-pos-rad", asked.airspeed_m_s, asked.height_m, False)).trim
    momentum = float(fdm["inertia/mass-slugs"] * fdm["velocities/vt-fps"])

    def respond(change: Any) -> tuple[Any, Any]:
        fdm["ic/alpha-rad"], fdm["ic/q-rad_sec"] = trim["alpha"], 0.0
        fdm["ic/beta-rad"], fdm["ic/p-rad_sec"], fdm["ic/r-rad_sec"] = change[:3]
        fdm["fcs/aileron-cmd-norm"], fdm["fcs/rudder-cmd-norm"] = change[3:]
        fdm.run_ic()
        for _ in range(STEPS):
            fdm.run()
        read = (
            "accelerations/pdot-rad_sec2", "accelerations/rdot-rad_sec2", "moments/l-total-lbsft",
            "moments/n-total-lbsft",
        )  # fmt: skip
        side = fdm["forces/fby-aero-lbs"] / momentum
        return np.array([fdm[name] for name in VARIABLES.values()]), np.array([side, *(fdm[n] for n in read)])

    moved, responses = [], []
    for k, size in enumerate(_SIZES):
        ends = [respond(sign * size * np.eye(len(_SIZES))[k]) for sign in (1.0, -1.0)]
        moved.append(ends[0][0] - ends[1][0])
        responses.append(ends[0][1] - ends[1][1])
    slopes = np.linalg.solve(np.array(moved), np.array(responses))
    signs = {"delta_a": -float(np.sign(slopes[3, 1])), "delta_r": -float(np.sign(slopes[4, 2]))}
    if not all(signs.values()):
        raise ArithmeticError("the aileron or the rudder moves nothing")
    turning, *_ = np.linalg.lstsq(slopes[:, 3:], slopes[:, 1:3], rcond=None)
    return SideSlopes(
        {f"{y}_{x}": float(slopes[i, j]) for j, y in enumerate("YLN") for i, x in enumerate(VARIABLES)},
        signs,
        turning.T.tolist(),
        momentum,
        float(fdm["aero/qbar-psf"]),
        float(fdm["aero/bi2vel"]),
    )


if __name__ == "__main__":
    answer(lambda fdm, told: side_measured(fdm, SideRequest(**told)))
