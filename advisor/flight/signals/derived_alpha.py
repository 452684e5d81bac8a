"""Motion of the aircraft from its instruments, and the angle of attack in still air that follows from the
motion.

Pitch angle, climb rate and air speed have separate stamps. Attitude and air speed are interpolated at the
stamps of the climb rate. The derived angle of attack is independent of the messages' order and delay.

Pitch rate, specific force, attitude and air speed give the rate of the angle of attack,

    α̇ = q + (a_z·cos α − a_x·sin α + g·cos γ)/V

(Klein & Morelli, *Aircraft System Identification*, chapter 10). The integral has the shape of the angle of
attack, but drifts because of instrument biases. A climb rate, if available, corrects level and drift.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.signals.messages import Columns
from advisor.flight.signals.record import Channel
from advisor.flight.signals.track import ChannelStatus, Track
from advisor.process.arrays import FloatArray, IntArray


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


DERIVED_ALPHA = "theta - asin(VFR_HUD.climb / airspeed)"
SLOWEST_FLIGHT_M_S = 4.0
"""Air speed, m/s, below which no aircraft flies, so that no angle of attack can be derived."""
_AROUND_S = 2.0
"""Margin around a stretch that contains the neighbouring samples, s. Air speed may come once a second (PX4's
airspeed_validated)."""


class DerivedAlpha:
    """Derived angle of attack, with the interface of a track.

    Parameters
    ----------
    track
        Function that returns the track of a channel's best source; None without samples.
    speed
        Function that returns the true air speed between two times, from messages up to an order.
    airspeed_m_s
        Air speed if none is measured, m/s. None if unknown.
    """

    def __init__(
        self,
        track: Callable[[str], Track | None],
        speed: Callable[[float, float, int | None], Channel | None],
        airspeed_m_s: float | None,
    ) -> None:
        self._track = track
        self._speed = speed
        self._airspeed_m_s = airspeed_m_s

    @property
    def exists(self) -> bool:
        """Whether an angle of attack can be derived so far."""
        if self._track("climb_rate") is None or self._track("theta") is None:
            return False
        airspeed = self._track("airspeed")
        fastest = -np.inf if airspeed is None else airspeed.highest
        return max(fastest, self._airspeed_m_s or 0.0) > SLOWEST_FLIGHT_M_S

    @property
    def newest_s(self) -> float:
        """Older of the newest stamps of climb rate and pitch angle, s since boot."""
        return min(track.newest_s for track in (self._track("climb_rate"), self._track("theta")) if track)

    @property
    def status(self) -> ChannelStatus:
        """Arrival status of the derived angle, equal to that of the climb rate."""
        climb = self._track("climb_rate")
        assert climb is not None
        return replace(
            climb.status,
            source=DERIVED_ALPHA,
            provenance="derived",
            lowest=-np.inf,
            highest=np.inf,
            newest=np.nan,
        )

    def cut(self, start_s: float, end_s: float, up_to_order: int | None = None) -> Channel:
        """Return the angle with ``start_s <= t <= end_s`` from messages up to ``up_to_order``."""
        climb = self._track("climb_rate")
        assert climb is not None
        at = climb.cut(start_s, end_s, up_to_order)
        around = {
            name: track.cut(start_s - _AROUND_S, end_s + _AROUND_S, up_to_order)
            for name in ("theta", "bank")
            if (track := self._track(name)) is not None
        }
        speed = self._speed(start_s - _AROUND_S, end_s + _AROUND_S, up_to_order)
        around |= {} if speed is None else {"airspeed": speed}
        t, alpha = _angles(at, around, self._airspeed_m_s)
        return Channel("alpha", t, alpha, DERIVED_ALPHA, "derived")


def derived_alpha(
    climb_m_s: FloatArray, airspeed_m_s: FloatArray, theta: FloatArray, bank: FloatArray
) -> FloatArray:
    """Return θ − γ with sin γ = climb rate / air speed, rad. In a bank, return the angle of attack that gives
    this γ. The angle is NaN at too low an air speed.

    Parameters
    ----------
    climb_m_s, airspeed_m_s, theta, bank
        Shape (n,) each, at equal times; angles in rad.
    """
    flying = airspeed_m_s > SLOWEST_FLIGHT_M_S
    sine = np.divide(climb_m_s, airspeed_m_s, out=np.zeros_like(airspeed_m_s), where=flying)
    up, size = gravity_in_plane(theta, bank)
    path = np.arcsin(np.clip(sine * GRAVITY_M_S2 / size, -1.0, 1.0))
    return np.where(flying, up - path, np.nan)


def promised(hud: Columns, airspeed_m_s: float | None) -> IntArray:
    """Return the orders of the VFR_HUD messages that give an angle of attack, now or in flight.

    A standing aircraft has no derived angle of attack, which is no fault of the stream.

    Parameters
    ----------
    hud
        Messages of type VFR_HUD. Messages from an autopilot's log may contain the climb rate alone.
    airspeed_m_s
        Air speed if none is measured, m/s; None if unknown.
    """
    if "climb" not in hud.fields:
        return hud.order[:0]
    if "airspeed" not in hud.fields or airspeed_m_s is not None:
        return hud.order
    flies = np.asarray(hud.fields["airspeed"]) > SLOWEST_FLIGHT_M_S
    stands = np.asarray(hud.fields.get("groundspeed", np.inf)) <= SLOWEST_FLIGHT_M_S
    return hud.order[flies | stands]


def _angles(
    climb: Channel, around: dict[str, Channel], airspeed_m_s: float | None
) -> tuple[FloatArray, FloatArray]:
    """Return stamps and angles, only at stamps with an attitude before and after."""
    theta, bank, speed = around.get("theta"), around.get("bank"), around.get("airspeed")
    if theta is None or len(theta) == 0:
        return np.empty(0), np.empty(0)
    within = (climb.t >= theta.t[0]) & (climb.t <= theta.t[-1])
    t = climb.t[within]
    v = np.full(len(t), np.nan)
    if speed is not None and len(speed):
        v = np.interp(t, speed.t, speed.y)
    if airspeed_m_s is not None:
        v = np.where(v > SLOWEST_FLIGHT_M_S, v, airspeed_m_s)
    rolled = np.interp(t, bank.t, bank.y) if bank is not None and len(bank) else np.zeros(len(t))
    alpha = derived_alpha(climb.y[within], v, np.interp(t, theta.t, theta.y), rolled)
    good = np.isfinite(alpha)
    return t[good], alpha[good]


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
