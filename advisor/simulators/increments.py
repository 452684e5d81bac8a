"""Effects added to a simulator: force and moment inside, by Eqs. (1)-(2) with the effects minus without them,
and effects on command and instruments around.

The equations are those of the diagnosis (``advisor.gap.simulator.right_sides``). An effect therefore has the
same terms in the user's simulator as in the diagnosis' model.
"""

from dataclasses import dataclass, field
from math import cos, exp

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.gap.candidates.known import PROPELLER
from advisor.gap.simulator.layout import (
    DERIVATIVES,
    EFFECT_ENTRIES,
    ENTRIES,
    EQUATION_ENTRIES,
    INDEX,
    LAYOUT,
    SKEWS,
)
from advisor.gap.simulator.right_sides import right_sides
from advisor.oem.lag import lagged
from advisor.process.arrays import FloatArray
from advisor.simulators.protocol import State

COMMAND = EFFECT_ENTRIES[: EFFECT_ENTRIES.index("M_delta2")]
"""Entries for effects between command and surface."""


def instruments(
    grid: FloatArray, speed: FloatArray, surface: FloatArray, h: float, p: FloatArray
) -> FloatArray:
    """Return the motion as its instruments read it, without the skew of their stamps.

    Parameters
    ----------
    grid
        Shape (4, n + 1): α, q, a_z, θ every ``h`` seconds.
    speed
        Shape (n + 1,): air speed, m/s.
    surface
        Shape (n,): mean deflection over each step, rad from trim, which excites a structural mode.
    h
        Time step, s.
    p
        Shape (entries,): simulator inputs in the order of ``advisor.gap.simulator.layout.ENTRIES``.

    Returns
    -------
    Shape (4, n + 1).
    """
    alpha, q, a_z, theta = grid
    trim = alpha[0]
    vane = lagging(alpha - p[INDEX["vane_arm_m"]] * q / speed, h, float(p[INDEX["alpha_lag_s"]]))
    bend, rate = second_order_response(
        surface, h, float(p[INDEX["mode_rad_s"]]), float(p[INDEX["mode_damping"]])
    )
    softness = 1.0 / p[INDEX["mode_rad_s"]] if p[INDEX["mode_rad_s"]] > 0.0 else 0.0
    of_rate = p[INDEX["mode_rate_gain"]] * softness
    gyro = (
        (1.0 + p[INDEX["q_scale"]]) * q + p[INDEX["q_bias"]] + p[INDEX["mode_gain"]] * bend + of_rate * rate
    )
    return np.stack(
        [
            trim + (1.0 + p[INDEX["alpha_scale"]]) * (vane - trim),
            gyro,
            a_z - p[INDEX["imu_arm_m"]] * np.gradient(q, h),
            theta + p[INDEX["mode_attitude"]] * of_rate * bend,
        ]
    )


def skewed(grid: FloatArray, h: float, p: FloatArray) -> FloatArray:
    """Return the series, shape (4, n + 1), delayed by the skews in ``p``."""
    t = np.arange(grid.shape[1]) * h
    return np.stack([np.interp(t - p[INDEX[name]], t, y) for name, y in zip(SKEWS, grid, strict=True)])


def lagging(y: FloatArray, h: float, lag_s: float) -> FloatArray:
    """Return a series of shape (n,) after a first-order lag, linear between samples; a negative lag leads."""
    if lag_s <= 0.0:
        return y - lag_s * np.gradient(y, h) if lag_s < 0.0 else y
    return lagged(np.full(len(y) - 1, h), y[:-1], y[1:], lag_s, float(y[0]))


def second_order_response(
    surface: FloatArray, h: float, omega_rad_s: float, damping: float
) -> tuple[FloatArray, FloatArray]:
    """Return the angle of a structural mode excited by the surface, rad, and its rate, each (n + 1,)."""
    n = len(surface)
    bend, rate = np.zeros(n + 1), np.zeros(n + 1)
    if omega_rad_s <= 0.0:
        return bend, rate
    damped = np.sqrt(max(1.0 - damping**2, 1e-6))
    fade = np.exp(-damping * omega_rad_s * h)
    swing = np.cos(omega_rad_s * damped * h)
    turn = np.sin(omega_rad_s * damped * h) / damped
    for i in range(n):
        off, at = bend[i] - surface[i], rate[i]
        bend[i + 1] = surface[i] + fade * ((swing + damping * turn) * off + turn * at / omega_rad_s)
        rate[i + 1] = fade * ((swing - damping * turn) * at - omega_rad_s * turn * off)
    return bend, rate


EQUATIONS = ("force_equation", "moment_equation")
"""Blocks whose effects are added inside a simulator, as increments."""
_TRIMS = (INDEX["Z_trim"], INDEX["M_trim"])
_CARRIED = np.isin(ENTRIES, (*DERIVATIVES, "Z_trim", "M_trim", *EQUATION_ENTRIES)) & ~np.isin(
    ENTRIES, PROPELLER.entries
)
"""Entries that become increments, shape (entries,). A simulator has its own propeller model."""


@dataclass(frozen=True)
class SimulatorIncrements:
    """Increments of a simulator, with the interface ``advisor.simulators.protocol.Increments``."""

    numbers: FloatArray
    """Shape (2, entries): simulator inputs with the effects, and without them."""
    alpha_trim: float
    """Angle of attack at which the simulator is trimmed, rad."""
    reference_m_s: float
    ground_m: float
    """Height above the ground at the start of the manoeuvre, m. The height in a simulator's state stands for
    the air density."""
    _memory: dict[str, float] = field(default_factory=dict, compare=False, repr=False)

    def __call__(self, state: State) -> tuple[float, float]:
        """Return increments of α̇ in rad/s and of q̇ in rad/s²."""
        lagging, engine = self._remembered(state)
        motion = np.array([
            state.airspeed_m_s, self.ground_m + state.height_m - self._memory["began_m"], state.alpha,
            state.alpha_dot, state.q, state.elevator, self.alpha_trim,
        ])  # fmt: skip
        lift, throttle = np.array([lagging, state.alpha]), np.array([engine, state.throttle])
        changed, plain = right_sides(LAYOUT, self.numbers, motion, self.reference_m_s, lift, throttle)
        return float(changed[0] - plain[0]), float(changed[1] - plain[1])

    def _remembered(self, state: State) -> tuple[float, float]:
        """Return the lift's lagging angle and the engine's lagging throttle at the state's time."""
        seen = self._memory
        if not seen or state.t < seen["t"]:
            seen.update(t=state.t, lift=self.alpha_trim, engine=0.0, began_m=state.height_m)
        passed = state.t - seen["t"]
        for name, entry, towards in (
            ("lift", "lift_lag_s", state.alpha),
            ("engine", "engine_lag_s", state.throttle),
        ):
            lag = float(self.numbers[0, INDEX[entry]])
            keep = exp(-passed / lag) if lag > 0.0 else 0.0
            seen[name] = towards + keep * (seen[name] - towards)
        seen["t"] = state.t
        return seen["lift"], seen["engine"]


def carried(p: FloatArray) -> FloatArray:
    """Return the simulator inputs, shape (entries,), with only the entries that become increments."""
    return np.where(_CARRIED, p, 0.0)


def trimmed(
    p: FloatArray, alpha: float, theta: float, speed: float, height: float, reference: float
) -> FloatArray:
    """Return the simulator inputs, shape (entries,), with the trim terms of steady flight in this state."""
    # Both equations are linear in their trim term.
    both = np.tile(carried(p), (2, 1))
    both[:, _TRIMS] = [[0.0, 0.0], [1.0, 1.0]]
    motion, at_rest = np.array([speed, height, alpha, 0.0, 0.0, 0.0, alpha]), np.full(2, alpha)
    without, per_unit = right_sides(LAYOUT, both, motion, reference, at_rest, np.zeros(2))
    needed = np.array([-GRAVITY_M_S2 / speed * cos(theta - alpha), 0.0])
    out = p.copy()
    out[list(_TRIMS)] = (needed - without) / (per_unit - without)
    return out
