"""Channels that cannot be right: one stands still while the aircraft moves, or two contradict each other.

A larger input mends neither. Whoever advises a crew asks here first.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import degrees, radians

import numpy as np

from advisor.flight.derived_alpha import SLOWEST_FLIGHT_M_S
from advisor.flight.messages import FloatArray
from advisor.flight.motion import bank_at, integrated
from advisor.flight.record import Channel

MOVED_RAD = radians(2.0)
"""Least range of the pitch angle, or of the integrated pitch rate, of an aircraft that has moved, rad. Every
manoeuvre on record moves by more, and no parked aircraft does."""
_ALIKE = (0.5, 2.0)
"""Ratio of the pitch angle's change to the integrated pitch rate, within which both are of one motion. The
manoeuvres on record have 0.96 to 1.04; a rate in deg/s has 0.02, one with a wrong sign -1."""
_LEAST_SAMPLES = 20
"""Fewer samples do not show whether a channel stands still."""
_LONGEST_GAP_S = 0.5
"""Across a longer gap, s, and in slower samples, the pitch rate has no integral."""
_WATCHED = {
    "q": ("pitch rate", "deg/s", degrees(1.0)),
    "a_z": ("normal acceleration", "m/s^2", 1.0),
    "alpha": ("angle of attack", "deg", degrees(1.0)),
    "airspeed": ("air speed", "m/s", 1.0),
}
"""Channels that never stand still in flight: name, unit and factor for people."""
_MENDS = {
    "q": "check the gyro and how its rate is recorded",
    "a_z": "check the accelerometer and how it is recorded",
    "alpha": "check the vane, or what the autopilot derives it from",
    "airspeed": "check the air speed sensor and its tube",
}


@dataclass(frozen=True, slots=True)
class Distrust:
    """A channel that cannot be right."""

    code: str
    """``frozen`` or ``contradiction``."""
    channel: str
    text: str
    """What is so, without a full stop."""
    fix: str
    """What to check, without a full stop."""
    value: float
    """The value that stands still in SI, or the ratio of both motions."""

    @property
    def sentence(self) -> str:
        """What is so, from its capital letter to its end without a full stop."""
        return f"{self.text[0].upper()}{self.text[1:]}"

    @property
    def stops(self) -> bool:
        """Whether nothing can be estimated: the pitch rate is needed, what else stands still is left out."""
        return self.channel == "q"


def frozen(ranges: Mapping[str, tuple[float, float]]) -> list[Distrust]:
    """Return channels that stand still while the pitch angle or the pitch rate shows that the aircraft moves.

    Parameters
    ----------
    ranges
        Channel name to its lowest and highest value in SI, over the same flight.
    """
    moves = [ranges[name][1] - ranges[name][0] > MOVED_RAD for name in ("theta", "q") if name in ranges]
    if not any(moves):
        return []
    if "airspeed" in ranges and ranges["airspeed"][1] <= SLOWEST_FLIGHT_M_S:
        # Carried about on the ground: neither a tube nor a vane has anything to measure.
        ranges = {name: both for name, both in ranges.items() if name not in ("airspeed", "alpha")}
    return [
        _stands_still(name, low) for name, (low, high) in ranges.items() if name in _WATCHED and low == high
    ]


def distrusted(channels: Mapping[str, Channel]) -> list[Distrust]:
    """Return channels of one stretch of flight that cannot be right; empty where nothing speaks against
    any."""
    told = {name: c for name, c in channels.items() if len(c) >= _LEAST_SAMPLES}
    found = frozen({name: (float(np.min(c.y)), float(np.max(c.y))) for name, c in told.items()})
    if found or not {"q", "theta"} <= told.keys() or told["q"].largest_gap_s > _LONGEST_GAP_S:
        return found
    ratio = _angle_over_rate(channels)
    if ratio is None or _ALIKE[0] <= ratio <= _ALIKE[1]:
        return []
    text = f"pitch angle moves {ratio:.2g} times as far as the pitch rate says"
    return [Distrust("contradiction", "q", text, "check sign and unit of the pitch rate", ratio)]


def _stands_still(name: str, value: float) -> Distrust:
    plain, unit, factor = _WATCHED[name]
    text = f"{plain} stands still at {value * factor + 0.0:.3g} {unit}"
    return Distrust("frozen", name, text, _MENDS[name], value)


def _angle_over_rate(channels: Mapping[str, Channel]) -> float | None:
    """Return the regression of the pitch angle on the integral of the rates that make it; None where it
    hardly moves.

    The pitch angle's rate is q cos φ − r sin φ. Offsets and drifts of both are left out of account.
    """
    q, theta, r = channels["q"], channels["theta"], channels.get("r")
    bank = bank_at(q.t, channels)
    yaw = np.zeros(len(q)) if r is None or len(r) == 0 else np.interp(q.t, r.t, r.y)
    turned = _level(q.t, integrated(q.t, q.y * np.cos(bank) - yaw * np.sin(bank)))
    angle = _level(q.t, np.interp(q.t, theta.t, theta.y))
    if max(np.ptp(turned), np.ptp(angle)) < MOVED_RAD:
        return None
    power = float(turned @ turned)
    return float(turned @ angle) / power if power > 0.0 else 0.0


def _level(t: FloatArray, y: FloatArray) -> FloatArray:
    """Return values without their mean and their trend."""
    s = t - t.mean()
    return np.asarray(y - y.mean() - s * float(s @ y) / float(s @ s))
