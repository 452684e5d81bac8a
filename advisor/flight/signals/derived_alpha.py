"""The angle of attack in still air, derived from attitude, climb rate and air speed at equal times.

Pitch angle, climb rate and air speed have separate stamps. Attitude and air speed are interpolated at the
stamps of the climb rate. The derived angle of attack is independent of the messages' order and delay.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.signals.messages import Columns
from advisor.flight.signals.motion import gravity_in_plane
from advisor.flight.signals.record import Channel
from advisor.flight.signals.track import ChannelStatus, Track
from advisor.process.arrays import FloatArray, IntArray

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
