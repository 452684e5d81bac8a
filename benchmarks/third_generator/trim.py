"""Steady level flight, and the eight derivatives of the short period about it."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq, root

from .fleet import Aircraft, Floats, Shape, shape
from .motion import WAKE_DELAY, Around, Faults, at_rest, slopes

STEP_RAD = 2e-4
NAMES = ("Z_0", "Z_alpha", "Z_q", "Z_delta_e", "M_0", "M_alpha", "M_q", "M_delta_e")


@dataclass(frozen=True)
class Trim:
    """Angle of attack and elevator [rad], throttle (0 to about 1), at a speed [m/s] and a height [m]."""

    alpha: float
    delta: float
    throttle: float
    speed: float
    height: float
    state: Floats


def settled(y: Floats, delta: float, around: Around, body: Shape, faults: Faults) -> Floats:
    """The state with the downwash and the oscillators where they stay."""
    for _ in range(3):
        out, a_x, a_z = slopes(y, delta, 0.0, around, body, faults)
        y = y.copy()
        speed = np.hypot(y[0], y[1])
        y[5] += out[5] * WAKE_DELAY * body.tail_x / speed
        y[7] += out[8] / faults.bend_rad_s**2
        y[11] += out[12] / faults.flex_rad_s**2
        y[9] = -a_x / a_z
    return y


def trim(body: Shape, faults: Faults, around: Around, speed: float, height: float) -> Trim:
    """Solve for no acceleration in level flight.

    Raises
    ------
    ValueError
        When the aircraft cannot fly there.
    """

    def state(unknown: Floats) -> Floats:
        return settled(at_rest(speed, unknown[0], height, 0.0), unknown[1], around, body, faults)

    def rest(unknown: Floats) -> Floats:
        out, _, _ = slopes(state(unknown), unknown[1], unknown[2], around, body, faults)
        return np.array([out[0], out[1], out[2] * body.chord])

    found = root(rest, np.array([0.02, 0.0, 0.3]), tol=1e-12)
    if np.max(np.abs(rest(found.x))) > 1e-6:
        raise ValueError(f"no level flight at {speed:.1f} m/s")
    alpha, delta, throttle = (float(value) for value in found.x)
    return Trim(alpha, delta, throttle, speed, height, state(found.x))


def with_elevator_near(aircraft: Aircraft, delta: float) -> Shape:
    """The aircraft's shape with its tail set so that it flies trimmed with this elevator."""

    def off(setting: float) -> float:
        return trim(shape(aircraft, setting), Faults(), Around(), aircraft.airspeed_m_s, 1e4).delta - delta

    return shape(aircraft, float(brentq(off, -0.35, 0.35, xtol=1e-6)))


def jacobian(body: Shape, flown: Trim) -> tuple[Floats, Floats]:
    """Derivatives of (alpha, q, downwash) by themselves, shape (3, 3), and by the elevator, shape (3,).

    Speed and flight path stay as they are, as Eqs. (1) and (2) have it; central differences.
    """

    def rates(at: Floats) -> Floats:
        alpha, q, downwash, delta = at
        y = at_rest(flown.speed, alpha, flown.height, downwash)
        y[2] = q
        out, _, _ = slopes(y, delta, flown.throttle, Around(), body, Faults())
        alpha_dot = (y[0] * out[1] - y[1] * out[0]) / flown.speed**2
        return np.array([alpha_dot, out[2], out[5]])

    at = np.array([flown.alpha, 0.0, flown.state[5], flown.delta])
    steps = STEP_RAD * np.eye(4)
    columns = [(rates(at + step) - rates(at - step)) / (2.0 * STEP_RAD) for step in steps]
    return np.array(columns[:3]).T, columns[3]


def derivatives(body: Shape, flown: Trim) -> dict[str, float]:
    """The eight derivatives at a trim, the lagging downwash folded in.

    Eqs. (1) and (2) have no memory: the downwash is put on the slow plane on which it follows (alpha, q).
    That keeps both roots of the short period; the downwash's own fast part is taken as settled.
    """
    a, b = jacobian(body, flown)
    roots, vectors = np.linalg.eig(a)
    slow = vectors[:, np.argsort(np.abs(roots))[:2]]
    plane = np.real(slow[2] @ np.linalg.inv(slow[:2]))
    fast = a[2, 2] - plane @ a[:2, 2]
    left = -(b[2] - plane @ b[:2]) / fast
    states = a[:2, :2] + np.outer(a[:2, 2], plane)
    control = b[:2] + a[:2, 2] * left
    z, m = np.column_stack([states, control])
    at = np.array([flown.alpha, 0.0, flown.delta])
    values = (-z @ at, z[0], z[1] - 1.0, z[2], -m @ at, m[0], m[1], m[2])
    return {name: float(value) for name, value in zip(NAMES, values, strict=True)}


def short_period(model: dict[str, float]) -> tuple[float, float]:
    """Natural frequency [rad/s] and damping ratio."""
    stiffness = model["Z_alpha"] * model["M_q"] - model["M_alpha"] * (1.0 + model["Z_q"])
    own = float(np.sqrt(max(stiffness, 1e-3)))
    return own, -(model["Z_alpha"] + model["M_q"]) / (2.0 * own)
