"""Angle of attack inferred from the motion, for aircraft without a vane.

Pitch rate, specific force, attitude and air speed give the rate of the angle of attack,

    α̇ = q + (a_z·cos α − a_x·sin α + g·cos γ)/V

(Klein & Morelli, *Aircraft System Identification*, chapter 10). The integral has the shape of the angle of
attack, but drifts because of instrument biases. A climb rate, if available, corrects level and drift.
"""

from collections.abc import Mapping

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.signals.motion import channel_at, integrated, path_turning
from advisor.flight.signals.record import Channel
from advisor.process.arrays import FloatArray

NEEDED = ("q", "theta", "a_z")
_PASSES = 2
_DRIFT = 2
"""Degree of the polynomial in time for the effect of biases on the integrated α."""


def alpha_rate(
    t: FloatArray, alpha: FloatArray, speed: FloatArray, channels: Mapping[str, Channel], arm_m: float = 0.0
) -> FloatArray:
    """Return the rate of the angle of attack from the motion, rad/s, at times ``t`` of the pitch rate.

    Parameters
    ----------
    t, alpha, speed
        Shape (n,): stamps of channel ``q`` (s), angle of attack (rad) and air speed (m/s) at these stamps.
    channels
        Channels ``q``, ``theta`` and ``a_z``; ``a_x`` and ``bank`` are used if present.
    arm_m
        Distance of the accelerometer ahead of the centre of gravity, m.
    """

    def at(name: str) -> FloatArray:
        return np.interp(t, channels[name].t, channels[name].y)

    q, theta, a_z = channels["q"].y, at("theta"), at("a_z")
    if arm_m:
        a_z = a_z + arm_m * np.gradient(q, t)
    has_a_x = "a_x" in channels and len(channels["a_x"]) > 1
    a_x = at("a_x") if has_a_x else GRAVITY_M_S2 * np.sin(theta)
    return np.asarray(q + path_turning(a_x, a_z, theta, alpha, channel_at("bank", t, channels)) / speed)


def inferred_alpha(channels: Mapping[str, Channel], speed: FloatArray) -> Channel | None:
    """Return the angle of attack from the motion; None without pitch rate, attitude or a_z.

    Parameters
    ----------
    channels
        Channels of a manoeuvre. An ``alpha`` among them, such as from the climb rate, corrects level and
        drift.
    speed
        Shape (n,): air speed at the stamps of channel ``q``, m/s.
    """
    if any(name not in channels or len(channels[name]) < 2 for name in NEEDED) or np.min(speed) <= 0.0:
        return None
    t = channels["q"].t
    level = channels.get("alpha")
    anchor = np.interp(t, level.t, level.y) if level is not None and len(level) > 1 else np.zeros(len(t))
    drift = np.vander((t - t.mean()) / max(float(np.ptp(t)), 1e-9), _DRIFT + 1)
    alpha = anchor
    for _ in range(_PASSES):
        shape = integrated(t, alpha_rate(t, alpha, speed, channels))
        alpha = shape + drift @ np.linalg.lstsq(drift, anchor - shape, rcond=None)[0]
    return Channel("alpha", t, alpha, "q, a_z, theta, airspeed", "inferred")
