"""Made-up aircraft and manoeuvres whose truth is known."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from advisor.aircraft.reference import PARAMETERS
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel

JET = np.array([-0.009, -0.483, 0.104, 0.676, 0.475, -4.93, -2.01, -7.21])
"""The published short-period case of a twin-jet research aircraft."""
UAV = np.array([0.05, -8.0, -0.03, 0.8, 0.45, -48.0, -4.2, -102.0])
"""A small, fast aircraft."""
Array = NDArray[np.float64]


def elevator_3211(
    t: Array, *, trim: float, amplitude: float, unit_s: float = 1.0, begin_s: float = 1.0
) -> Array:
    """Return a modified 3-2-1-1 that begins up."""
    u = np.full(len(t), trim)
    edge = begin_s
    for length, sign, size in ((3, 1, 0.8), (2, -1, 1.2), (1, 1, 1.1), (1, -1, 1.1)):
        u[(t >= edge - 1e-9) & (t < edge + length * unit_s - 1e-9)] += sign * size * amplitude
        edge += length * unit_s
    return u


def trim_elevator(theta: Array) -> float:
    """Return the elevator that holds q = 0."""
    system = np.array([[theta[1], theta[3]], [theta[5], theta[7]]])
    return float(np.linalg.solve(system, -theta[[0, 4]])[1])


def trim_alpha(theta: Array) -> float:
    """Return the angle of attack at that elevator."""
    system = np.array([[theta[1], theta[3]], [theta[5], theta[7]]])
    return float(np.linalg.solve(system, -theta[[0, 4]])[0])


def simulate(theta: Array, x0: Sequence[float], t_input: Array, u: Array, t: Array) -> Array:
    """Return (n, 3) α, q, ∫q of Eqs. (1)-(2) at ``t`` by the general matrix exponential, input linear.

    Written without the advisor's own code: the state is [α, q, ∫q, δe, δ̇e, 1].
    """
    stamps = np.union1d(t, t_input[(t_input > t[0]) & (t_input < t[-1])])
    where = np.searchsorted(stamps, t)
    z = np.array([*x0, 0.0])
    rows = [z]
    value = np.interp(stamps, t_input, u)
    m = np.zeros((6, 6))
    m[0] = [theta[1], 1 + theta[2], 0, theta[3], 0, theta[0]]
    m[1] = [theta[5], theta[6], 0, theta[7], 0, theta[4]]
    m[2, 1] = 1.0
    m[3, 4] = 1.0
    steps: dict[float, Array] = {}
    for k, h in enumerate(np.diff(stamps)):
        key = round(float(h), 13)
        if key not in steps:
            steps[key] = expm(m * h)
        full = np.array([*z, value[k], (value[k + 1] - value[k]) / h, 1.0])
        z = (steps[key] @ full)[:3]
        rows.append(z)
    return np.array(rows)[where]


def maneuver(
    number: int,
    elevator: tuple[Array, Array],
    channels: Mapping[str, tuple[Array, Array]],
) -> Maneuver:
    """Return a manoeuvre out of plain arrays."""
    t, u = elevator
    span = Span(float(t[0]), float(t[0]) + 1.0, float(t[0]) + 8.0, float(t[-1]), "3-2-1-1", (), "quiet")
    parts = {"elevator": Channel("elevator", t, u)}
    parts |= {name: Channel(name, stamps, y) for name, (stamps, y) in channels.items()}
    return Maneuver(number, 0, span, parts)


def flown(
    theta: Array,
    *,
    number: int = 1,
    noise: float = 0.0,
    rate_hz: float = 50.0,
    length_s: float = 14.0,
    amplitude: float = 0.03,
    sign: float = 1.0,
    unit_s: float = 1.0,
    alpha_late_s: float = 0.003,
    seed: int = 0,
) -> Maneuver:
    """Return a manoeuvre of the linear aircraft; α and q at own stamps, noise relative to the spread of
    each."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, length_s, 1.0 / rate_hz)
    u = elevator_3211(t, trim=trim_elevator(theta), amplitude=sign * amplitude, unit_s=unit_s)
    t_q = t[1:-1] + 0.001
    t_alpha = t[1:-1] + alpha_late_s
    x0 = [trim_alpha(theta) + 0.002, 0.003]
    q = simulate(theta, x0, t, u, np.concatenate([t[:1], t_q]))[1:, 1]
    alpha = simulate(theta, x0, t, u, np.concatenate([t[:1], t_alpha]))[1:, 0]
    alpha = alpha + noise * np.std(alpha) * rng.standard_normal(len(alpha))
    q = q + noise * np.std(q) * rng.standard_normal(len(q))
    return maneuver(number, (t, u), {"alpha": (t_alpha, alpha), "q": (t_q, q)})


def by_name(theta: Array) -> dict[str, float]:
    """Return the vector with its names."""
    return dict(zip(PARAMETERS, theta.tolist(), strict=True))
