"""Kinematics of any aircraft without aerodynamics: gravity, the rate of the speed, and the wind."""

from collections.abc import Mapping

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.signals.record import Channel
from advisor.process.arrays import FloatArray


def channel_at(name: str, t: FloatArray, channels: Mapping[str, Channel]) -> FloatArray:
    """Return a channel at times ``t`` in s, shape (n,); zero if the log has no such channel."""
    channel = channels.get(name)
    return np.zeros(len(t)) if channel is None or len(channel) == 0 else np.interp(t, channel.t, channel.y)


def gravity_in_plane(theta: FloatArray, bank: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return gravity in the aircraft's plane of symmetry: the direction of up, and the size.

    In a bank a part of gravity acts sideways. Along the path gravity is −size · sin(up − α), across it size ·
    cos(up − α). With level wings ``up`` is the pitch angle.

    Parameters
    ----------
    theta, bank
        Shape (n,): pitch angle and bank, rad.

    Returns
    -------
    up
        Shape (n,): direction of up, rad from the body's x axis.
    size
        Shape (n,): size of gravity in the plane of symmetry, m/s².
    """
    along, down = np.sin(theta), np.cos(theta) * np.cos(bank)
    return np.arctan2(along, down), GRAVITY_M_S2 * np.hypot(along, down)


def path_turning(
    a_x: FloatArray, a_z: FloatArray, theta: FloatArray, alpha: FloatArray, bank: FloatArray
) -> FloatArray:
    """Return specific force plus gravity normal to the path, positive down, m/s². This sum divided by the
    speed is α̇ − q.

    a_z cos α − a_x sin α + g cos γ; specific force in m/s², angles in rad, all of shape (n,).
    """
    up, size = gravity_in_plane(theta, bank)
    return np.asarray(a_z * np.cos(alpha) - a_x * np.sin(alpha) + size * np.cos(up - alpha))


def speed_rate(
    a_x: FloatArray, a_z: FloatArray, theta: FloatArray, alpha: FloatArray, bank: FloatArray
) -> FloatArray:
    """Return the rate of the speed from the accelerometers, m/s², valid in steadily moving air.

    V̇ = a_x cos α + a_z sin α − g sin γ; specific force in m/s², angles in rad, all of shape (n,).
    """
    up, size = gravity_in_plane(theta, bank)
    return np.asarray(a_x * np.cos(alpha) + a_z * np.sin(alpha) - size * np.sin(up - alpha))


def speed_rate_at(t: FloatArray, channels: Mapping[str, Channel]) -> FloatArray:
    """Return the rate of the speed, m/s², from the channels a_x, a_z, theta, alpha and bank.

    Parameters
    ----------
    t
        Shape (n,): times, s.
    channels
        Channels by name; only the bank may be missing.
    """
    a_x, a_z, theta, alpha = (
        np.interp(t, channels[name].t, channels[name].y) for name in ("a_x", "a_z", "theta", "alpha")
    )
    return speed_rate(a_x, a_z, theta, alpha, channel_at("bank", t, channels))


def integrated(t: FloatArray, rate: FloatArray) -> FloatArray:
    """Return the running integral by trapezoids over stamps ``t`` in s, shape (n,), 0 at the first."""
    total: FloatArray = np.concatenate(([0.0], np.cumsum(np.diff(t) * (rate[1:] + rate[:-1]) / 2.0)))
    return total


def along_heading(north: Channel, east: Channel, heading: Channel) -> dict[str, Channel]:
    """Return the channels ``wind_along`` and ``wind_right`` at the stamps of the wind.

    Parameters
    ----------
    north, east
        Horizontal velocity of the air, m/s, from one message.
    heading
        Heading in rad, which may jump by 2π.
    """
    facing = np.interp(north.t, heading.t, np.unwrap(heading.y))
    cos, sin = np.cos(facing), np.sin(facing)
    to_east = np.interp(north.t, east.t, east.y)
    of = {"wind_along": cos * north.y + sin * to_east, "wind_right": cos * to_east - sin * north.y}
    return {name: Channel(name, north.t, y, north.source, north.provenance) for name, y in of.items()}
