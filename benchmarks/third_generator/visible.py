"""How far an effect can be seen, in units of the instruments' noise."""

import numpy as np
from scipy.signal import lfilter

from .fleet import Floats
from .flight import STEP_S, Channels
from .maneuvers import Maneuver
from .setup import Setup

CHANNELS = ("alpha", "q", "a_z", "theta")
EVERY = 4
"""Compared at 50 Hz."""


def linear_answers(model: dict[str, float], driving: Floats) -> Floats:
    """Answer of (alpha, q) to a disturbance of each equation, shape (2 drivings, 2 states, n)."""
    z_a, m_a, m_q = model["Z_alpha"], model["M_alpha"], model["M_q"]
    z_q = 1.0 + model["Z_q"]
    s = 2.0 / STEP_S
    rule = np.array([[s * s, -2 * s * s, s * s], [s, 0.0, -s], [1.0, 2.0, 1.0]])
    bottom = np.array([1.0, -(z_a + m_q), z_a * m_q - m_a * z_q]) @ rule
    tops = [[[0.0, 1.0, -m_q], [0.0, 0.0, m_a]], [[0.0, 0.0, z_q], [0.0, 1.0, -z_a]]]
    return np.array([[lfilter(np.array(top) @ rule, bottom, driving) for top in row] for row in tops])


def _outputs(model: dict[str, float], speed: float, states: Floats, forcing: Floats) -> Floats:
    """Channels of (alpha, q): a_z = V (d alpha/dt - q), theta the integral of q."""
    alpha, q = states
    alpha_dot = model["Z_alpha"] * alpha + (1.0 + model["Z_q"]) * q + forcing
    theta = np.cumsum(q) * STEP_S
    return np.array([alpha, q, speed * (alpha_dot - q), theta])[:, ::EVERY]


def _answers(model: dict[str, float], speed: float, z: Floats, m: Floats) -> Floats:
    """Channels of the linear model whose equations are disturbed by ``z`` and ``m``."""
    return _outputs(model, speed, linear_answers(model, z)[0] + linear_answers(model, m)[1], z)


def _basis(model: dict[str, float], speed: float, command: Floats) -> tuple[Floats, Floats]:
    """What the eight parameters, and what a manoeuvre's own start and offsets, can do: rows of channels."""
    one, none = np.ones(command.size), np.zeros(command.size)
    pulse = none.copy()
    pulse[0] = 1.0 / STEP_S
    states = linear_answers(model, model["Z_delta_e"] * command)[0]
    states = states + linear_answers(model, model["M_delta_e"] * command)[1]
    own = [_answers(model, speed, *pair) for pair in ((one, none), (none, one), (pulse, none), (none, pulse))]
    for k in range(len(CHANNELS)):
        offset = np.zeros_like(own[0])
        offset[k] = 1.0
        own.append(offset)
    shared = [
        _answers(model, speed, *pair)
        for row in (states[0], states[1], command)
        for pair in ((row, none), (none, row))
    ]
    return np.array(own), np.array(shared)


def _difference(
    plain: Channels, other: Channels, test: Maneuver, model: dict[str, float]
) -> tuple[Floats, Floats]:
    part = slice(int(test.start_s / STEP_S), int(test.end_s / STEP_S))
    apart = np.array([other[name][part] - plain[name][part] for name in CHANNELS])[:, ::EVERY]
    steered = other["command"][part] - plain["command"][part]
    # A simulator is given the command that was logged: what the command explains is no gap.
    by_command = _answers(
        model, test.airspeed_m_s, model["Z_delta_e"] * steered, model["M_delta_e"] * steered
    )
    command = other["command"][part]
    return apart - by_command, command - command[0]


def visibility(setup: Setup, plain: Channels, other: Channels) -> dict[str, dict[str, float]]:
    """Root mean square difference of two flights over the noise, by channel.

    Returns
    -------
    dict
        ``ratios``: what the logged command does not explain. ``dynamic_ratios``: what a manoeuvre's own
        start, trim and offsets do not explain either. ``beyond_parameters``: what no derivatives explain.
    """
    model, tests = setup.plan.model, setup.plan.maneuvers
    noise = np.array([setup.kit.noise[name] for name in CHANNELS])[:, None]
    if not setup.kit.sends_alpha:
        noise[CHANNELS.index("alpha")] = np.inf
    raw, moving, shared = [], [], []
    for test in tests:
        apart, command = _difference(plain, other, test, model)
        own, common = _basis(model, test.airspeed_m_s, command)
        raw.append(apart / noise)
        columns = (own / noise).reshape(len(own), -1).T
        orthogonal, _ = np.linalg.qr(columns)
        flat = np.vstack([(apart / noise).reshape(1, -1), (common / noise).reshape(len(common), -1)]).T
        rest = flat - orthogonal @ (orthogonal.T @ flat)
        moving.append(rest[:, 0])
        shared.append(rest[:, 1:])
    stacked, columns = np.concatenate(moving), np.concatenate(shared)
    scale = np.linalg.norm(columns, axis=0)
    solution = np.linalg.lstsq(columns / scale, stacked, rcond=1e-9)[0]
    beyond = stacked - columns / scale @ solution
    lengths = np.cumsum([part.size for part in moving])[:-1]
    return {
        "ratios": _by_channel(raw),
        "dynamic_ratios": _by_channel([part.reshape(len(CHANNELS), -1) for part in moving]),
        "beyond_parameters": _by_channel(
            [part.reshape(len(CHANNELS), -1) for part in np.split(beyond, lengths)]
        ),
    }


def _by_channel(parts: list[Floats]) -> dict[str, float]:
    joined = np.concatenate(parts, axis=1)
    return {name: float(np.sqrt(np.mean(row**2))) for name, row in zip(CHANNELS, joined, strict=True)}
