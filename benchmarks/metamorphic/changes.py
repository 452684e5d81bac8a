"""Changes of a flight's records that natural telemetry makes, and that no answer may depend on."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.record import Channel

COMMANDS = ("elevator", "aileron", "rudder")
RATES = ("p", "q", "r")
FLOW = ("alpha", "beta")
"""Angles of one message, which are late together."""

_Edit = Callable[[Channel], Channel]


@dataclass(frozen=True)
class Change:
    """One natural change of a flight's records."""

    name: str
    """Size and subject of the change, as the table prints both."""
    channels: tuple[str, ...]
    """Channels that the change affects; empty for a change of the list of manoeuvres."""
    edit: _Edit
    size: float
    """Size of the change, in the unit of ``width``."""
    width: float
    """Standard deviation of the nuisance between aircraft; infinite where no nuisance describes the change.
    Sources are data sheets and logs of autopilots: stamps of commands 10 ms, air speed 5 % and 120 ms, the
    autopilot's angle of attack 30 ms, bias of a MEMS gyro .2 deg/s."""

    @property
    def allowed_nats(self) -> float:
        """Largest change of log odds, nats, that the nuisance's prior gives to a flight within two standard
        deviations; infinite where no nuisance describes the change."""
        if not np.isfinite(self.width):
            return float("inf")
        in_widths = self.size / self.width
        return 2.0 * in_widths + 0.5 * in_widths**2

    def changes(self, maneuvers: Sequence[Maneuver]) -> bool:
        """Return whether the change alters a flight that can still be diagnosed."""
        if not self.channels:
            return len(maneuvers) > FEWEST
        return any(name in m.channels for m in maneuvers for name in self.channels)

    def apply(self, maneuvers: Sequence[Maneuver]) -> list[Maneuver]:
        """Return the manoeuvres after the change."""
        if not self.channels:
            return list(maneuvers[:-1])
        return [replace(m, channels=self._edited(m.channels)) for m in maneuvers]

    def _edited(self, channels: Mapping[str, Channel]) -> dict[str, Channel]:
        return {name: self.edit(c) if name in self.channels else c for name, c in channels.items()}


FEWEST = 3
"""Least number of manoeuvres before one is left out. A search needs two manoeuvres."""


def _later(seconds: float) -> _Edit:
    return lambda channel: replace(channel, t=channel.t + seconds)


def _times(factor: float) -> _Edit:
    return lambda channel: replace(channel, y=channel.y * factor)


def _plus(offset: float) -> _Edit:
    return lambda channel: replace(channel, y=channel.y + offset)


_GYRO_RAD_S = float(np.radians(0.1))
_SPEED = ("airspeed",)

CHANGES: tuple[Change, ...] = (
    Change("command stamps + 16 ms", COMMANDS, _later(0.016), 0.016, 0.010),
    Change("command stamps - 16 ms", COMMANDS, _later(-0.016), 0.016, 0.010),
    Change("read air speed x .97", _SPEED, _times(0.97), 0.03, 0.05),
    Change("read air speed x 1.03", _SPEED, _times(1.03), 0.03, 0.05),
    Change("air speed 120 ms later", _SPEED, _later(0.12), 0.12, 0.12),
    Change("alpha 20 ms later", FLOW, _later(0.02), 0.02, 0.03),
    Change("gyro bias + .1 deg/s", RATES, _plus(_GYRO_RAD_S), 0.1, 0.2),
    Change("gyro bias - .1 deg/s", RATES, _plus(-_GYRO_RAD_S), 0.1, 0.2),
    Change("one manoeuvre less", (), lambda channel: channel, 1.0, float("inf")),
)
"""Every change, in the order of the table."""
