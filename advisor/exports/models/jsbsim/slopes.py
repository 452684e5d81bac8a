"""Derivatives of a JSBSim aircraft, from small perturbations.

The module runs in a separate process (``python -m``), because JSBSim writes on stdout and may abort. The
states are fixed while the forces settle, so that motion does not affect a derivative. α̇ and q̇ respond to α,
q and elevator with all dependent terms. The terms of α̇ are part of the derivatives of α and q, as in a
flight. For roll and yaw, the aircraft is perturbed in β, p, r, aileron and rudder at rest.
"""

import json
import os
import sys
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

FOOT_M = 0.3048
SEA_FLOOR_FT = -10000.0
"""Height of the ground, ft, so low that there is no ground effect."""
GUESS = 0.6
"""Throttle at which JSBSim's trim begins."""
FULL_TRIM = 1
"""JSBSim's number for trimming all axes in straight flight."""
_STEPS = 300
"""Number of calls after which forces and servos have settled."""
SIZES = (0.004, 0.01, 0.02)
"""Perturbations of α (rad), q (rad/s) and the elevator's command (-1 to 1)."""
_ROUNDS, _AT_REST = 30, 1e-7
_FLAT = 1e-6
"""Z_alpha of an aircraft without lift, 1/s, which is only rounding."""


SIDE_VARIABLES = {
    "beta": "aero/beta-rad",
    "p": "velocities/p-aero-rad_sec",
    "r": "velocities/r-aero-rad_sec",
    "delta_a": "fcs/left-aileron-pos-rad",
    "delta_r": "fcs/rudder-pos-rad",
}
"""Property that represents each variable of roll and yaw."""
_SIDE_SIZES = (0.01, 0.05, 0.05, 0.1, 0.1)
"""Perturbations of β, p and r in rad and rad/s, and of the commands of aileron and rudder (-1 to 1)."""


@dataclass(frozen=True)
class Request:
    """Flight condition, and quantities to measure on a JSBSim aircraft."""

    airspeed_m_s: float
    height_m: float
    powered: bool = True
    """Whether JSBSim's trim finds the throttle. False for a closed throttle."""
    surface: str = "fcs/elevator-pos-rad"
    """Property of the elevator's position."""
    sideways: bool = False
    """Whether the slopes of roll and yaw are requested instead of those of the short period."""


@dataclass(frozen=True)
class Slopes:
    """Measured slopes of a JSBSim aircraft in one condition."""

    derivatives: dict[str, float]
    """Six short-period derivatives, SI. Derivatives by the elevator are per unit of the JSBSim property that
    moves the elevator."""
    trim: dict[str, float]
    """Values of ``alpha``, ``q`` and ``delta_e`` in the trim."""
    pressure_psf: float
    momentum: float
    """Mass times speed, slug·ft/s."""
    inertia: float
    """I_yy, slug·ft²."""
    chord_time_s: float
    """Time c/(2·V) that makes rates dimensionless, s."""
    powered: bool
    """Whether JSBSim's trim found a throttle for steady speed."""

    def per_force(self, letter: str) -> float:
        """Return the change of α̇ (``Z``) by a lift of 1 lb, or of q̇ (``M``) by a moment of 1 lb·ft."""
        return -1.0 / self.momentum if letter == "Z" else 1.0 / self.inertia


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


def measured(fdm: Any, asked: Request) -> Slopes:
    """Return the slopes of a loaded aircraft at its trim in lift and moment.

    Raises
    ------
    ArithmeticError
        No angle of attack and elevator balance the aircraft in this condition, or its lift does not grow.
    """
    fdm["ic/terrain-elevation-ft"] = SEA_FLOOR_FT
    fdm["ic/h-sl-ft"] = asked.height_m / FOOT_M
    fdm["ic/vt-fps"] = asked.airspeed_m_s / FOOT_M
    fdm["ic/gamma-deg"] = 0.0
    fdm["fcs/throttle-cmd-norm"] = GUESS if asked.powered else 0.0
    fdm["fcs/mixture-cmd-norm"] = 0.9
    fdm.run_ic()
    fdm["propulsion/set-running"] = -1
    powered = asked.powered and _finds_its_throttle(fdm)
    fdm.suspend_integration()

    def respond(alpha: float, q: float, command: float) -> tuple[Any, Any]:
        fdm["ic/alpha-rad"], fdm["ic/q-rad_sec"] = alpha, q
        fdm["fcs/elevator-cmd-norm"] = command
        _settle(fdm)
        variables = [fdm["aero/alpha-rad"], fdm["velocities/q-rad_sec"], fdm[asked.surface]]
        rates = [fdm["aero/alphadot-rad_sec"], fdm["accelerations/qdot-rad_sec2"]]
        return np.array(variables), np.array(rates)

    trim = np.array([0.05, 0.0])
    for _ in range(_ROUNDS):
        _, here = respond(trim[0], 0.0, trim[1])
        if np.max(np.abs(here)) < _AT_REST:
            break
        columns = [
            (respond(trim[0] + a, 0.0, trim[1] + c)[1] - here) / (a + c)
            for a, c in ((SIZES[0], 0.0), (0.0, SIZES[2]))
        ]
        step = np.linalg.solve(np.column_stack(columns), here)
        trim = trim - np.clip(step, -0.1, 0.1)
    else:
        raise ArithmeticError("no trim")
    if abs(trim[1]) > 1.0:
        raise ArithmeticError("the elevator's travel ends before the trim")
    at_trim, _ = respond(trim[0], 0.0, trim[1])
    slopes = _slopes(lambda x: respond(trim[0] + x[0], x[1], trim[1] + x[2]), SIZES)
    z, m = slopes[:, 0] - [0.0, 1.0, 0.0], slopes[:, 1]
    derivatives = dict(
        zip(("Z_alpha", "Z_q", "Z_delta_e", "M_alpha", "M_q", "M_delta_e"), [*z, *m], strict=True)
    )
    if derivatives["Z_alpha"] > -_FLAT:
        raise ArithmeticError("the lift does not grow at the trim: the wing is stalled, or its tables end")
    return Slopes(
        {name: float(value) for name, value in derivatives.items()},
        {"alpha": float(at_trim[0]), "q": 0.0, "delta_e": float(at_trim[2])},
        float(fdm["aero/qbar-psf"]),
        float(fdm["inertia/mass-slugs"] * fdm["velocities/vt-fps"]),
        float(fdm["inertia/iyy-slugs_ft2"]),
        float(fdm["aero/ci2vel"]),
        powered,
    )


def side_measured(fdm: Any, asked: Request) -> SideSlopes:
    """Return the slopes of roll and yaw of a loaded aircraft from perturbations about its trim.

    Raises
    ------
    ArithmeticError
        The aircraft has no trim in this condition, or a control moves nothing.
    """
    trim = measured(fdm, asked).trim
    momentum = float(fdm["inertia/mass-slugs"] * fdm["velocities/vt-fps"])

    def respond(change: Any) -> tuple[Any, Any]:
        fdm["ic/alpha-rad"], fdm["ic/q-rad_sec"] = trim["alpha"], 0.0
        fdm["ic/beta-rad"], fdm["ic/p-rad_sec"], fdm["ic/r-rad_sec"] = change[:3]
        fdm["fcs/aileron-cmd-norm"], fdm["fcs/rudder-cmd-norm"] = change[3:]
        _settle(fdm)
        read = (
            "accelerations/pdot-rad_sec2", "accelerations/rdot-rad_sec2", "moments/l-total-lbsft",
            "moments/n-total-lbsft",
        )  # fmt: skip
        side = fdm["forces/fby-aero-lbs"] / momentum
        variables = np.array([fdm[name] for name in SIDE_VARIABLES.values()])
        return variables, np.array([side, *(fdm[n] for n in read)])

    slopes = _slopes(respond, _SIDE_SIZES)
    signs = {"delta_a": -float(np.sign(slopes[3, 1])), "delta_r": -float(np.sign(slopes[4, 2]))}
    if not all(signs.values()):
        raise ArithmeticError("the aileron or the rudder moves nothing")
    turning, *_ = np.linalg.lstsq(slopes[:, 3:], slopes[:, 1:3], rcond=None)
    return SideSlopes(
        {f"{y}_{x}": float(slopes[i, j]) for j, y in enumerate("YLN") for i, x in enumerate(SIDE_VARIABLES)},
        signs,
        turning.T.tolist(),
        momentum,
        float(fdm["aero/qbar-psf"]),
        float(fdm["aero/bi2vel"]),
    )


def _settle(fdm: Any) -> None:
    fdm.run_ic()
    for _ in range(_STEPS):
        fdm.run()


def _slopes(respond: Callable[[Any], tuple[Any, Any]], sizes: Sequence[float]) -> Any:
    """Return central differences, shape (n, responses), of a function to variables and their responses."""
    ends = [(respond(step), respond(-step)) for step in np.diag(sizes)]
    moved, responses = (np.array([up[i] - down[i] for up, down in ends]) for i in (0, 1))
    return np.linalg.solve(moved, responses)


def _finds_its_throttle(fdm: Any) -> bool:
    """Return whether JSBSim's trim finds a throttle; a glider and a weak engine have none."""
    try:
        fdm["simulation/do_simple_trim"] = FULL_TRIM
    except RuntimeError:
        return False
    finally:
        fdm["fcs/pitch-trim-cmd-norm"] = 0.0
    return True


def answer() -> None:
    """Read one request as JSON from stdin, and answer with one line of JSON, the last on stdout."""
    request = json.load(sys.stdin)
    foreign = request.pop("foreign")
    model, *places = (request.pop(key) for key in ("model", "aircraft", "engine", "systems"))
    os.environ["JSBSIM_DEBUG"] = "0"
    import jsbsim

    fdm = jsbsim.FGFDMExec(None)
    fdm.set_debug_level(0)
    for name in foreign:
        fdm[name] = 0.0
    aircraft, engine, systems = places
    fdm.load_model_with_paths(model, aircraft, engine, systems, True)
    asked = Request(**request)
    slopes = side_measured(fdm, asked) if asked.sideways else measured(fdm, asked)
    print("\n" + json.dumps(asdict(slopes), allow_nan=False))


if __name__ == "__main__":
    answer()
