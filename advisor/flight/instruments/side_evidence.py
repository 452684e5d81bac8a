"""Evidence on the instruments of roll and yaw from the motion of one record.

The bank's rate is p + tan θ·(q·sin φ + r·cos φ). The sideslip's rate is β̇ = a_y/V + b + c. The part of the
weight is b = (g/V)·cos θ·sin φ, and that of turning is c = sin α·p - cos α·r. On every aircraft the side
force opposes the sideslip, a_y/V = Y_β·β with Y_β < 0 and a small part of the rudder's. So the sign of each
part in a measured sideslip, and in a side force, is known without any aerodynamics.
"""

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.instruments.delayed_fit import DelayedFit, Summand, fit_delays
from advisor.flight.instruments.evidence import MOVED_RAD, Channels, channel_at, usable
from advisor.flight.instruments.measured import Evidence, Measured
from advisor.flight.signals.messages import FloatArray
from advisor.flight.signals.renewal import renewed

_TURNED_RAD = 0.75 * np.pi
"""Largest bank, rad, of a record that tells of the roll rate. Beyond half a turn the bank jumps."""


def rate_against_bank(channels: Channels) -> Evidence:
    """Return ``bank_scale``, the bank's change over the integral of its rate, and ``p_delay``, s.

    The delay is that of the roll rate relative to the bank. Empty where the bank hardly moves, or turns over.
    """
    if not usable(channels, "p", "bank", "theta"):
        return {}
    p, bank = channels["p"], channels["bank"]
    angle, theta = channel_at("bank", p.t, channels), channel_at("theta", p.t, channels)
    by_turn = channel_at("q", p.t, channels) * np.sin(angle) + channel_at("r", p.t, channels) * np.cos(angle)
    if np.ptp(bank.y) < MOVED_RAD or np.max(np.abs(bank.y)) > _TURNED_RAD:
        return {}
    fit = fit_delays(bank.t, bank.y, [Summand(p.t, p.y + np.tan(theta) * by_turn)])
    if fit is None:
        return {}
    return {
        "bank_scale": Measured(float(fit.factors[0]), float(fit.factor_stds[0])),
        "p_delay": Measured(-float(fit.delays_s[0]), float(np.sqrt(fit.delay_covariance[0, 0]))),
    }


def sideslip_against_motion(channels: Channels) -> Evidence:
    """Return the factors of the parts of β̇ in a measured sideslip; empty where nothing moves.

    ``beta_by_weight``, ``beta_by_turn`` and ``beta_by_motion``, that of both together, are near 1.
    ``beta_by_force``, also near 1, is the side force over its reading.
    """
    parts = _parts(channels, "beta")
    if parts is None:
        return {}
    t, weight, turn = parts
    stamps, beta = renewed(channels["beta"].t, channels["beta"].y)
    apart = fit_delays(stamps, beta, [Summand(t, weight), Summand(t, turn)])
    together = fit_delays(stamps, beta, [Summand(t, weight + turn)])
    if apart is None or together is None:
        return {}
    found = _factors("beta", apart, together)
    force = channel_at("a_y", t, channels) / channel_at("airspeed", t, channels)
    both = [Summand(t, weight + turn, 1.0), Summand(t, force)]
    with_force = fit_delays(stamps, beta, both) if np.ptp(force) > 0.0 else None
    if with_force is not None:
        found["beta_by_force"] = Measured(float(with_force.factors[1]), float(with_force.factor_stds[1]))
    return found


def force_against_motion(channels: Channels) -> Evidence:
    """Return the factors of the parts of β̇ in the side force over the speed, 1/s; empty where nothing moves.

    ``a_y_by_weight``, ``a_y_by_turn`` and ``a_y_by_motion``, that of both together, are Y_β. ``a_y_in_g`` is
    V·Y_β/g = C_Yβ/C_L, the side force of one radian over the weight.
    """
    parts = _parts(channels, "a_y")
    if parts is None:
        return {}
    t, weight, turn = parts
    force = channels["a_y"]
    speed = channel_at("airspeed", force.t, channels)
    apart = fit_delays(force.t, force.y / speed, [Summand(t, weight), Summand(t, turn)], np.zeros(2), drift=1)
    together = fit_delays(force.t, force.y / speed, [Summand(t, weight + turn)], np.zeros(1), drift=1)
    if apart is None or together is None:
        return {}
    found = _factors("a_y", apart, together)
    both, per_g = found["a_y_by_motion"], float(np.mean(speed)) / GRAVITY_M_S2
    return {**found, "a_y_in_g": Measured(both.value * per_g, both.std * per_g)}


def _factors(name: str, apart: DelayedFit, together: DelayedFit) -> dict[str, Measured]:
    """Return the factors of weight and turning apart, and of both together."""
    values = (*apart.factors, *together.factors), (*apart.factor_stds, *together.factor_stds)
    parts = ("weight", "turn", "motion")
    return {
        f"{name}_by_{part}": Measured(float(f), float(s)) for part, f, s in zip(parts, *values, strict=True)
    }


def _parts(channels: Channels, name: str) -> tuple[FloatArray, FloatArray, FloatArray] | None:
    """Return stamps, and the parts of β̇ by weight and by turning, rad/s; None without a moving channel."""
    if not usable(channels, "r", "p", "bank", "theta", "airspeed", name):
        return None
    t = channels["r"].t
    speed, bank = channel_at("airspeed", t, channels), channels["bank"]
    still = np.ptp(bank.y) < MOVED_RAD or np.ptp(channels[name].y) == 0.0
    if still or np.min(speed) <= 0.0 or np.min(channels["airspeed"].y) <= 0.0:
        return None
    alpha, theta = channel_at("alpha", t, channels), channel_at("theta", t, channels)
    weight = GRAVITY_M_S2 / speed * np.cos(theta) * np.sin(channel_at("bank", t, channels))
    turn = np.sin(alpha) * channel_at("p", t, channels) - np.cos(alpha) * channels["r"].y
    return t, weight, turn
