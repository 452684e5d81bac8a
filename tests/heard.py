"""What the stream of a flight tells of a log or of messages, for tests of every room."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import FlightEvent, Maneuver, ManeuverFlown, Notice, SideManeuverFlown
from advisor.flight.signals.messages import Columns
from advisor.flight.stream.stream import FlightStream
from advisor.mavlink.logs.logs import open_log


@dataclass(frozen=True)
class Heard:
    """A stream at its end, with all that it told."""

    stream: FlightStream
    events: list[FlightEvent]

    @property
    def maneuvers(self) -> list[Maneuver]:
        """Manoeuvres of the elevator."""
        return [event.maneuver for event in self.events if isinstance(event, ManeuverFlown)]

    @property
    def sideways(self) -> list[Maneuver]:
        """Manoeuvres of aileron and rudder."""
        return [event.maneuver for event in self.events if isinstance(event, SideManeuverFlown)]

    @property
    def notices(self) -> list[Notice]:
        return [event for event in self.events if isinstance(event, Notice)]

    @property
    def samples(self) -> list[tuple[float, ...]]:
        """Start and every sample of every channel, of each manoeuvre of the elevator."""
        return [
            (
                m.span.start_s,
                *np.concatenate([np.r_[channel.t, channel.y] for channel in m.channels.values()]),
            )
            for m in self.maneuvers
        ]


def hear(batches: Iterable[list[Columns]], aircraft: Aircraft | None = None, **options: Any) -> Heard:
    """Feed all messages to a stream, and end it."""
    stream = FlightStream(aircraft or Aircraft(), **options)
    events = [event for batch in batches for event in stream.feed(batch)]
    return Heard(stream, events + stream.finish())


def hear_log(path: Path, aircraft: Aircraft | None = None, **options: Any) -> Heard:
    """Feed a log to a stream, and end it."""
    return hear(open_log(path), aircraft, **options)
