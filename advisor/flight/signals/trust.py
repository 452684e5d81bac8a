"""Channels that contradict the motion: frozen while the aircraft moves, or found wrong by the motion.

A larger input does not help with a frozen channel. Advice to a crew therefore begins with this check.
``advisor.flight.instruments`` finds contradictions between channels.

An instrument has the parameters sign, scale, unit, delay, lag, place, bias and rate. The motion gives these
parameters without aerodynamics, or the fit estimates them with the derivatives. Doctor, screens, fit, verdict
and aircraft file all read this result.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import degrees, nan, radians
from typing import Literal

import numpy as np

from advisor.flight.signals.derived_alpha import SLOWEST_FLIGHT_M_S
from advisor.flight.signals.record import Channel
from advisor.words.problems import Problem

Quantity = Literal["sign", "scale", "unit", "delay_s", "lag_s", "arm_m", "bias", "rate"]


@dataclass(frozen=True, slots=True)
class InstrumentFinding:
    """One property of one instrument, as found from the data."""

    channel: str
    """Channel name: ``elevator``, ``alpha``, ``q``, ``theta``, ``a_z``, ``airspeed``."""
    quantity: Quantity
    stated: float | str | None
    """Value that the aircraft file, a parameter or the message's definition states, SI; None without one."""
    value: float | str
    """Value from the data, SI, or the name of a unit."""
    std: float = nan
    """Standard deviation of ``value``, SI."""
    contradicts: bool = False
    """Whether the data exclude the stated value, or any value possible for such an instrument."""
    text: str = ""
    """Sentence about the finding, without a full stop."""
    fix: str = ""
    """Line for the aircraft file, or remedy on the aircraft, without a full stop."""
    used: bool = False
    """Whether the estimates use the value from the data."""
    removed_s: float = 0.0
    """Delay that was removed from the channel's stamps, s."""

    @property
    def code(self) -> str:
        """Code of the finding from channel and quantity, equal in all outputs."""
        return f"{self.channel}_{self.quantity}"

    @property
    def sentence(self) -> str:
        """Sentence about the finding with a capital letter, without a full stop."""
        return f"{self.text[:1].upper()}{self.text[1:]}"

    @property
    def problem(self) -> Problem:
        return Problem(self.code, f"{self.sentence}.", f"Fix: {self.fix}.")

    @property
    def refuses(self) -> bool:
        """Whether no estimate can be accepted, because the stated value is excluded and no better one is
        used."""
        return self.contradicts and not self.used


MOVED_RAD = radians(2.0)
"""Least range of the pitch angle, or of the integrated pitch rate, for an aircraft in motion, rad. Every
recorded manoeuvre has a larger range, and no parked aircraft has."""
_LEAST_SAMPLES = 20
"""Least number of samples for a test whether a channel is frozen."""
_WATCHED = {
    "q": ("pitch rate", "deg/s", degrees(1.0)),
    "a_z": ("normal acceleration", "m/s^2", 1.0),
    "alpha": ("angle of attack", "deg", degrees(1.0)),
    "airspeed": ("air speed", "m/s", 1.0),
}
"""Channels that always change in flight, with name, unit and factor for people."""
_MENDS = {
    "q": "check the gyro and how its rate is recorded",
    "a_z": "check the accelerometer and how it is recorded",
    "alpha": "check the vane, or what the autopilot derives it from",
    "airspeed": "check the air speed sensor and its tube",
}


@dataclass(frozen=True, slots=True)
class Distrust:
    """A frozen channel that cannot be right."""

    code: str
    """``frozen``."""
    channel: str
    text: str
    """Description of the defect, without a full stop."""
    fix: str
    """Remedy, without a full stop."""
    value: float
    """Frozen value of the channel, SI."""

    @property
    def sentence(self) -> str:
        """Description of the defect with a capital letter, without a full stop."""
        return f"{self.text[0].upper()}{self.text[1:]}"

    @property
    def stops(self) -> bool:
        """Whether the defect prevents any estimate. Every estimate needs the pitch rate."""
        return self.channel == "q"

    @property
    def left_out(self) -> bool:
        """Whether estimates are made without the channel. Either specific force or angle of attack
        suffices."""
        return self.channel in ("a_z", "alpha")

    @property
    def finding(self) -> InstrumentFinding:
        """The defect as a property of the instrument: its values are renewed at a rate of zero."""
        return InstrumentFinding(
            self.channel,
            "rate",
            None,
            0.0,
            0.0,
            contradicts=True,
            text=self.text,
            fix=self.fix,
            used=self.left_out,
        )


def frozen(ranges: Mapping[str, tuple[float, float]]) -> list[Distrust]:
    """Return the channels that are frozen while pitch angle or pitch rate show motion.

    Parameters
    ----------
    ranges
        Lowest and highest value of each channel over one flight, SI, by the channel's name.
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
    """Return the frozen channels of one stretch of flight; empty if all change."""
    sampled = {name: c for name, c in channels.items() if len(c) >= _LEAST_SAMPLES}
    return frozen({name: (float(np.min(c.y)), float(np.max(c.y))) for name, c in sampled.items()})


def _stands_still(name: str, value: float) -> Distrust:
    plain, unit, factor = _WATCHED[name]
    text = f"{plain} stands still at {value * factor + 0.0:.3g} {unit}"
    return Distrust("frozen", name, text, _MENDS[name], value)
