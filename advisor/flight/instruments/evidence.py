"""Evidence about instruments from the motion of one record, without aerodynamics.

The pitch angle's rate is q cos φ − r sin φ. Over any stretch the mean specific force along the vertical is
1 g, less the change of the climb rate. The angle of attack follows
α̇ = q + (a_z cos α − a_x sin α + g cos γ)/V.
"""

from collections.abc import Mapping
from math import hypot, radians

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.instruments.delayed_fit import Summand, fit_delays
from advisor.flight.instruments.measured import Evidence, Measured
from advisor.flight.signals.derived_alpha import (
    DERIVED_ALPHA,
    SLOWEST_FLIGHT_M_S,
    channel_at,
    path_turning,
    speed_rate,
)
from advisor.flight.signals.record import Channel, renewed
from advisor.process.arrays import FloatArray

Channels = Mapping[str, Channel]

MOVED_RAD = radians(2.0)
"""Least range of the pitch angle, rad, for a test of the pitch rate. Every recorded manoeuvre has a larger
range, and no parked aircraft has."""
VANE_WIDTH = 0.15
"""Prior standard deviation of a vane's scale, as a share, due to upwash and position. Recorded vanes read
0.93 to 1.00 of the angle from the motion."""
COMPUTED_WIDTH = 0.03
"""Prior standard deviation of the scale of an autopilot's computed angle of attack, as a share. Wind and
magnetic heading cause errors of this size."""
_LATEST_COMPUTED_S = 0.05
"""Longest delay of an autopilot's computed angle of attack, s. Recorded computed angles of attack are 20 to
35 ms late. A longer delay may be that of a vane ahead of the centre of gravity."""
_LONGEST_GAP_S = 0.5
"""Longest gap between two samples, s, across which a rate is integrated."""
_FEWEST_SAMPLES = 20
_SHORTEST_S = 2.0
"""Shortest record, s, with which the mean specific force is compared with gravity. Over 2 s, 1 m/s of climb
rate is 5 % of 1 g."""
_CLIMB_M_S = 1.0
"""Error of a change of the climb rate, m/s: lag of its filter in a manoeuvre."""
_ALIGNMENT = 0.02
"""Prior error of the mean vertical force, as a share of 1 g: alignment and attitude of 2 deg each, and
bias."""
_SIDE_FORCE = 0.1
"""Prior standard deviation of the specific force along body y, in g: a sideslip of some degrees."""
_YAW_SHARE = 0.5
"""Largest ratio of the yaw rate's part to the pitch rate's part in the pitch angle's rate, as RMS. Above this
ratio the yaw rate dominates the result."""
_LARGEST_ALPHA_RAD = radians(30.0)
"""Largest angle of attack, rad, of a short-period manoeuvre. Beyond this angle every wing has stalled."""
_STEP = 0.05
"""Finite-difference step of the scale of α for delays and air speed, as a share."""


def rate_against_attitude(channels: Channels) -> Evidence:
    """Return ``theta_scale``, the pitch angle's change over the integral of the pitch rate, and ``q_delay``,
    the pitch rate's delay relative to the attitude, s.

    The result is empty if the angle hardly moves.
    """
    if not usable(channels, "q", "theta"):
        return {}
    q, theta = channels["q"], channels["theta"]
    bank = channel_at("bank", q.t, channels)
    pitching, yawing = q.y * np.cos(bank), channel_at("r", q.t, channels) * np.sin(bank)
    if np.ptp(theta.y) < MOVED_RAD and np.ptp(np.cumsum(pitching)) / q.rate_hz < MOVED_RAD:
        return {}
    if float(np.std(yawing)) > _YAW_SHARE * float(np.std(pitching)):
        return {}
    fit = fit_delays(theta.t, theta.y, [Summand(q.t, pitching - yawing)])
    return {} if fit is None else {"theta_scale": fit.factor(), "q_delay": fit.lateness}


def force_against_climb(channels: Channels) -> Evidence:
    """Return ``a_z_behind_climb``, the delay of the specific force relative to the climb rate, s.

    The climb rate is the integral of the vertical force less gravity. A climb rate may be late but is never
    early, so the force is at least this late.
    """
    if not usable(channels, "a_x", "a_z", "theta", "climb_rate"):
        return {}
    force, climb = channels["a_z"], channels["climb_rate"]
    theta, bank = channel_at("theta", force.t, channels), channel_at("bank", force.t, channels)
    along = channel_at("a_x", force.t, channels)
    rising = along * np.sin(theta) - force.y * np.cos(theta) * np.cos(bank) - GRAVITY_M_S2
    fit = fit_delays(climb.t, climb.y, [Summand(force.t, rising)])
    return {} if fit is None else {"a_z_behind_climb": fit.lateness}


def force_against_gravity(channels: Channels) -> Evidence:
    """Return ``a_z_scale``, the ratio of the measured mean vertical specific force to the force from the
    motion; empty if unknown.
    """
    if not usable(channels, "a_z", "theta"):
        return {}
    force, t = channels["a_z"], channels["a_z"].t
    length_s = float(t[-1] - t[0])
    if length_s < _SHORTEST_S:
        return {}
    theta, bank = channel_at("theta", t, channels), channel_at("bank", t, channels)
    down = force.y * np.cos(theta) * np.cos(bank) - channel_at("a_x", t, channels) * np.sin(theta)
    climb = channels.get("climb_rate")
    gained, unsure = 0.0, _CLIMB_M_S
    if climb is not None and len(climb) > 1:
        gained = float(climb.y[-1] - climb.y[0])
    else:
        unsure += float(np.max(channel_at("airspeed", t, channels))) * abs(float(theta[-1] - theta[0]))
    per_g = 1.0 / (length_s * GRAVITY_M_S2)
    motion = 1.0 + gained * per_g
    mean = float(np.sum(np.diff(t) * (down[1:] + down[:-1])) / (2.0 * length_s))
    scale = -mean / GRAVITY_M_S2 / motion
    sideways = _SIDE_FORCE * float(np.mean(np.abs(np.sin(bank))))
    return {"a_z_scale": Measured(scale, abs(scale / motion) * hypot(unsure * per_g, _ALIGNMENT, sideways))}


def speed_against_force(channels: Channels) -> Evidence:
    """Return ``speed_scale``, the ratio of the measured change of air speed to the change from the
    accelerometers.

    V̇ = a_x cos α + a_z sin α − g sin γ holds in steadily moving air. An error of α cancels to first order.
    """
    if not usable(channels, "a_x", "a_z", "theta", "airspeed"):
        return {}
    force, speed = channels["a_z"], channels["airspeed"]
    t, alpha = (
        force.t,
        np.clip(channel_at("alpha", force.t, channels), -_LARGEST_ALPHA_RAD, _LARGEST_ALPHA_RAD),
    )
    theta = channel_at("theta", t, channels)
    rate = speed_rate(channel_at("a_x", t, channels), force.y, theta, alpha, channel_at("bank", t, channels))
    fit = fit_delays(speed.t, speed.y, [Summand(t, rate)], drift=1)
    return {} if fit is None else {"speed_scale": fit.factor()}


def alpha_against_motion(channels: Channels) -> Evidence:
    """Return ``alpha_scale``, the ratio of the measured angle of attack to the angle from the motion.

    The result is empty without a measured angle of attack, or without motion.
    """
    parts = _parts(channels)
    if parts is None or channels["alpha"].source == DERIVED_ALPHA:
        return {}
    t, pitching, turning, t_alpha, alpha = parts
    fit = fit_delays(t_alpha, alpha, [Summand(t, pitching + turning)])
    return {} if fit is None else {"alpha_scale": fit.factor()}


def rate_moves_alpha(channels: Channels) -> bool | None:
    """Return whether a positive pitch rate raises a measured angle of attack; None if unknown."""
    parts = _parts(channels)
    if parts is None or channels["alpha"].source == DERIVED_ALPHA:
        return None
    t, pitching, turning, t_alpha, alpha = parts
    fit = fit_delays(t_alpha, alpha, [Summand(t, pitching), Summand(t, turning)])
    return None if fit is None else bool(fit.factors[0] > 0.0)


def stds_of_delays(covariance: FloatArray) -> tuple[float, float] | None:
    """Return the standard deviations of the second delay and of its difference from the first, s.

    None if rounding errors dominate a variance, as in a damaged record.

    Parameters
    ----------
    covariance
        Shape (2, 2): covariance of the two delays, s².
    """
    variances = np.array([covariance[0, 0] + covariance[1, 1] - 2.0 * covariance[0, 1], covariance[1, 1]])
    if not np.all(variances > 0.0):
        return None
    apart, alone = map(float, np.sqrt(variances))
    return apart, alone


def force_against_alpha(channels: Channels) -> Evidence:
    """Return the delay of the specific force and the scale of the air speed, from a valid angle of attack.

    The angle of attack is fitted as α(t) = ∫q(t − τ_q) + f·∫n(t − τ_n), where n is the rate of the path's
    angle. ``airspeed_scale`` is f, the ratio of stated to true air speed. ``a_z_least`` and ``a_z_most``
    bound the delay of a_z relative to the pitch rate, s. A vane ahead of the centre of gravity delays ∫q
    alone, and a late climb rate delays ∫n alone. Neither delays ∫n negatively, so −τ_n bounds the delay of
    a_z from below.
    """
    parts = _parts(channels)
    if parts is None:
        return {}
    t, pitching, turning, t_alpha, alpha = parts
    source = channels["alpha"]
    fit = fit_delays(t_alpha, alpha, [Summand(t, pitching, 1.0), Summand(t, turning)])
    if fit is None:
        return {}
    steeper = [Summand(t, pitching, 1.0 + _STEP), Summand(t, turning)]
    other = fit_delays(t_alpha, alpha, steeper, fit.delays_s)
    assert other is not None
    of_rate, of_force = (float(delay) for delay in fit.delays_s)
    computed = source.provenance == "derived" and abs(of_rate) < _LATEST_COMPUTED_S
    width = COMPUTED_WIDTH if computed else VANE_WIDTH
    by_scale = width * (other.delays_s - fit.delays_s) / _STEP
    covariance = fit.delay_covariance + np.outer(by_scale, by_scale)
    stds = stds_of_delays(covariance)
    if stds is None:
        return {}
    together = Measured(of_rate - of_force, stds[0])
    bound = Measured(-of_force, stds[1])
    if source.source == DERIVED_ALPHA:
        return {"a_z_least": bound}
    by_width = width * float(other.factors[1] - fit.factors[1]) / _STEP
    return {
        "a_z_least": bound if bound.value < together.value else together,
        "a_z_most": together,
        "airspeed_scale": Measured(float(fit.factors[1]), hypot(float(fit.factor_stds[1]), by_width)),
    }


def _parts(channels: Channels) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray] | None:
    """Return stamps, pitch rate and turn rate of the path, then stamps and values of α; None if missing."""
    if not usable(channels, "q", "theta", "a_z", "alpha", "airspeed"):
        return None
    q, source = channels["q"], channels["alpha"]
    t, speed = q.t, channel_at("airspeed", q.t, channels)
    if np.min(speed) < SLOWEST_FLIGHT_M_S or np.ptp(channels["theta"].y) < MOVED_RAD:
        return None
    t_alpha, alpha = renewed(source.t, source.y)
    theta, bank = channel_at("theta", t, channels), channel_at("bank", t, channels)
    along = channel_at("a_x", t, channels) if "a_x" in channels else GRAVITY_M_S2 * np.sin(theta)
    # A reading in another unit may give any angle; the force's direction takes a possible one.
    angle = np.clip(np.interp(t, t_alpha, alpha), -_LARGEST_ALPHA_RAD, _LARGEST_ALPHA_RAD)
    turning = path_turning(along, channel_at("a_z", t, channels), theta, angle, bank) / speed
    return t, q.y, turning, t_alpha, alpha


def usable(channels: Channels, *names: str) -> bool:
    """Return whether all named channels have enough samples without a long gap."""
    return all(
        name in channels
        and len(channels[name]) >= _FEWEST_SAMPLES
        and channels[name].largest_gap_s <= _LONGEST_GAP_S
        for name in names
    )
