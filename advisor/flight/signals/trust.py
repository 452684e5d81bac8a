"""Channels that cannot be right: a frozen one while the aircraft moves, or two that contradict each other.

A larger input remedies neither. Advice to a crew starts with this check.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import degrees, radians

import numpy as np

from advisor.flight.signals.derived_alpha import SLOWEST_FLIGHT_M_S
from advisor.flight.signals.messages import FloatArray
from advisor.flight.signals.motion import bank_at, integrated
from advisor.flight.signals.record import Channel

MOVED_RAD = radians(2.0)
"""Least range of the pitch angle, or of the integrated pitch rate, of an aircraft that has moved, rad. Every
manoeuvre on record moves by more, and no parked aircraft does."""
_ALIKE = (0.5, 2.0)
"""Range of the ratio of the pitch angle's change to the integrated pitch rate, within which both belong to
one motion. The manoeuvres on record have 0.96 to 1.04. A rate in deg/s has 0.02, and one with a wrong sign
-1."""
_LEAST_SAMPLES = 20
"""Fewest samples that show whether a channel is frozen."""
_LONGEST_GAP_S = 0.5
"""Longest gap, s, across which the pitch rate is integrated."""
_WATCHED = {
    "q": ("pitch rate", "deg/s", degrees(1.0)),
    "a_z": ("normal acceleration", "m/s^2", 1.0),
    "alpha": ("angle of attack", "deg", degrees(1.0)),
    "airspeed": ("air speed", "m/s", 1.0),
}
"""Channels that always change in flight: name, unit and factor for people."""
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
    """Description of the defect, without a full stop."""
    fix: str
    """Remedy, without a full stop."""
    value: float
    """Frozen value in SI, or the ratio of both motions."""

    @property
    def sentence(self) -> str:
        """Description of the defect with a capital letter, without a full stop."""
        return f"{self.text[0].upper()}{self.text[1:]}"

    @property
    def stops(self) -> bool:
        """Whether nothing can be estimated. The pitch rate is needed; any other frozen channel is left
        out."""
        return self.channel == "q"


def frozen(ranges: Mapping[str, tuple[float, float]]) -> list[Distrust]:
    """Return channels that are frozen while the pitch angle or the pitch rate shows that the aircraft moves.

    Parameters
    ----------
    ranges
        Channel name to its lowest and highest value in SI, over one flight.
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
    """Return the channels of one stretch of flight that cannot be right; empty where all seem sound."""
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
    """Return the regression of the pitch angle on the integral of its rate; None where the angle hardly
    moves.

    The pitch angle's rate is q cos φ − r sin φ. Offsets and drifts of both do not count.
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
