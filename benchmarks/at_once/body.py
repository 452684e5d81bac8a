"""Aircraft of the other generators as rigid bodies in six degrees of freedom, with drawn roll and yaw.

The generators fly pitch alone. Their aircraft get moments of inertia and lateral coefficients that are drawn
within the ranges of Etkin and Reid (*Dynamics of Flight*, 3rd edition, appendix B). The derivatives follow
from the coefficients. Products of inertia act in the motion and in the derivatives of L and N.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import root

from advisor.model.axes.lateral import LATERAL, Trim, modes_of, state_matrix
from benchmarks.second_generator.aircraft import FLEET as SECOND
from benchmarks.second_generator.aircraft import Aircraft as Pitching
from benchmarks.second_generator.aircraft import scattered
from sim.airframe import LIGHT_AIRCRAFT, UAV, Airframe

from .motion import GRAVITY, HEIGHT_M, Floats, Numbers, level_state, rates

_SIDE = {
    "cy_b": (-0.9, -0.3), "cy_p": (-0.05, 0.05), "cy_r": (0.0, 0.3), "cy_da": (-0.02, 0.02),
    "cy_dr": (0.1, 0.2), "cl_b": (-0.10, -0.03),
    "cl_p": (-0.6, -0.38), "cl_r": (0.06, 0.2), "cl_da": (-0.25, -0.12),
    "cl_dr": (0.005, 0.02), "cn_b": (0.05, 0.12), "cn_p": (-0.06, -0.01), "cn_r": (-0.2, -0.08),
    "cn_da": (0.002, 0.015), "cn_dr": (-0.1, -0.05),
}  # fmt: skip
"""Range of each lateral coefficient: side force y, rolling moment l, yawing moment n. They are by sideslip b,
rates p and r over 2V/span, aileron da and rudder dr, both to the left where positive."""
_SLOWEST_SPIRAL = 0.05
"""Largest eigenvalue of the spiral, 1/s, which triples a bank within a multisine."""


@dataclass(frozen=True)
class Body:
    """One aircraft in level flight at one true air speed, SI."""

    pitching: Pitching
    inertia: tuple[float, float, float, float]
    """I_xx, I_yy, I_zz, I_xz, kg m²."""
    span_m: float
    side: Mapping[str, float]
    density: float = 1.225
    alpha: float = 0.0
    elevator: float = 0.0
    thrust_n: float = 0.0

    @property
    def speed(self) -> float:
        """True air speed of the trim, m/s."""
        return self.pitching.airspeed_m_s

    @property
    def numbers(self) -> Numbers:
        """Numbers of the equations of motion."""
        c, (x, y, z, xz) = self.pitching, self.inertia
        return Numbers(
            c.mass_kg, x, y, z, xz, c.wing_area_m2, c.chord_m, self.span_m, self.density, self.thrust_n,
            c.cl_0, c.cl_alpha, c.cl_q, c.cl_delta_e, c.cd_0, c.induced_drag, c.cm_0, c.cm_alpha, c.cm_q,
            c.cm_delta_e, **self.side,
        )  # fmt: skip

    def derivatives(self, speed: float) -> dict[str, float]:
        """Return the derivatives of both axes at a true air speed near the trim, rad and s."""
        c, s = self.pitching, self.side
        area = 0.5 * self.density * speed**2 * c.wing_area_m2
        force, moment = area / (c.mass_kg * speed), area * c.chord_m / self.inertia[1]
        long, wide = c.chord_m / (2.0 * speed), self.span_m / (2.0 * speed)
        drag = self.thrust_n / (c.mass_kg * speed)
        told = {
            "Z_alpha": -force * c.cl_alpha - drag, "Z_q": -force * c.cl_q * long,
            "Z_delta_e": -force * c.cl_delta_e, "M_alpha": moment * c.cm_alpha, "M_q": moment * c.cm_q * long,
            "M_delta_e": moment * c.cm_delta_e,
        }  # fmt: skip
        x, _, z, xz = self.inertia
        turned = area * self.span_m * np.linalg.inv(np.array([[x, -xz], [-xz, z]]))
        for ending, key, scale in (
            ("beta", "b", 1.0), ("p", "p", wide), ("r", "r", wide), ("delta_a", "da", 1.0),
            ("delta_r", "dr", 1.0),
        ):  # fmt: skip
            told[f"Y_{ending}"] = force * s[f"cy_{key}"] * scale
            both = turned @ np.array([s[f"cl_{key}"], s[f"cn_{key}"]]) * scale
            told[f"L_{ending}"], told[f"N_{ending}"] = float(both[0]), float(both[1])
        return {name: float(value) for name, value in told.items()}

    @property
    def short_period_s(self) -> float:
        """Undamped period of the short period, s."""
        d = self.derivatives(self.speed)
        return float(2.0 * np.pi / np.sqrt(d["Z_alpha"] * d["M_q"] - (1.0 + d["Z_q"]) * d["M_alpha"]))


def _of_sim(name: str, frame: Airframe, airspeed: float) -> Pitching:
    return Pitching(
        name, frame.mass, frame.iyy, frame.wing_area, frame.chord, airspeed, 200.0, 1.0, frame.cl_0,
        frame.cl_alpha, frame.cl_q, frame.cl_delta_e, frame.cd_0, frame.cd_induced,
        frame.cm_0, frame.cm_alpha, frame.cm_q, frame.cm_delta_e,
    )  # fmt: skip


FLEET = (*SECOND, _of_sim("sim uav", UAV, 25.0), _of_sim("sim light aircraft", LIGHT_AIRCRAFT, 55.0))
"""Nine aircraft of two generators."""


def draw_body(rng: np.random.Generator, kind: int) -> Body:
    """Draw an aircraft of the fleet with scattered coefficients, in trim, with stable roll and Dutch roll."""
    pitching = scattered(FLEET[kind], rng)
    density = 1.225 * (1.0 - 2.25577e-5 * (pitching.elevation_m + HEIGHT_M)) ** 4.2559
    while True:
        ixx = pitching.pitch_inertia_kg_m2 * rng.uniform(0.5, 1.2)
        izz = 0.92 * (ixx + pitching.pitch_inertia_kg_m2)
        side = {name: float(rng.uniform(*within)) for name, within in _SIDE.items()}
        inertia = float(ixx), pitching.pitch_inertia_kg_m2, float(izz), float(0.05 * ixx * rng.uniform(-1, 1))
        body = _trimmed(Body(pitching, inertia, pitching.span_m, side, density))
        d = body.derivatives(body.speed)
        theta = np.array([d[name] for name in LATERAL.names.shared])
        modes = modes_of(state_matrix(theta, Trim(body.speed, body.alpha, body.alpha)))
        oscillation, spiral = modes.dutch_roll, modes.spiral
        if (
            oscillation is not None
            and oscillation.real < -0.1
            and spiral is not None
            and spiral < _SLOWEST_SPIRAL
        ):
            return body


def _trimmed(body: Body) -> Body:
    """Return the body with angle of attack, elevator and thrust of level flight."""
    v, weight = body.speed, body.pitching.mass_kg * GRAVITY

    def unbalanced(unknown: Floats) -> Floats:
        alpha, elevator, share = unknown
        x = level_state(v, alpha)
        numbers = replace(body, thrust_n=share * weight).numbers
        return np.asarray(rates(x, np.array([elevator, 0.0, 0.0]), numbers)[0][[0, 2, 4]])

    found = root(unbalanced, np.array([0.03, 0.0, 0.1]), tol=1e-12)
    alpha, elevator, share = (float(value) for value in found.x)
    return replace(body, alpha=alpha, elevator=elevator, thrust_n=share * weight)
