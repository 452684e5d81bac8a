"""From spans of elevator samples to manoeuvres: the channels cut out, and what is none left aside."""

from collections import Counter
from dataclasses import replace

import numpy as np

from advisor.flight.channels import SLOWEST_FLIGHT_M_S
from advisor.flight.events import FlightEvent, ManeuverFlown, Notice
from advisor.flight.identity import Identity
from advisor.flight.maneuver import Maneuver, Span
from advisor.flight.marked_input import marked_span
from advisor.flight.marks import Mark
from advisor.flight.record import UNITS
from advisor.flight.segmentation import LEAD_IN_S
from advisor.flight.sense import Sense, turned
from advisor.flight.shape import is_3211
from advisor.flight.track import Tracks
from advisor.flight.vehicle import closes_pitch_loop


class Cutting:
    """Cuts manoeuvres out of the tracks of one vehicle.

    Parameters
    ----------
    tracks, who
        The vehicle's channels, and who it is.
    calibrated
        Whether the aircraft file says which way the elevator moves.
    """

    def __init__(self, tracks: Tracks, who: Identity, calibrated: bool) -> None:
        self._tracks, self._who = tracks, who
        self._sense = None if calibrated else Sense()
        self._modes = [(-np.inf, who.mode)]
        self.maneuvers = 0
        """How many manoeuvres have been found."""
        self.autopilots: Counter[str] = Counter()
        """Inputs that were the autopilot's own, by flight mode."""

    @property
    def is_backwards(self) -> bool:
        """Whether the elevator was found to move the other way than its output suggests."""
        return self._sense is not None and bool(self._sense.backwards)

    def begin(self, mode: str) -> None:
        """Nothing was flown before in this mode."""
        self._modes = [(-np.inf, mode)]

    def change(self, mode: str, since_s: float) -> None:
        """The flight mode has changed."""
        self._modes.append((since_s, mode))

    def so_far(self, span: Span, boot: int) -> Maneuver:
        """The manoeuvre that would be flown if it ended here."""
        maneuver = self._cut(span, boot, None)
        return turned(maneuver) if self.is_backwards else maneuver

    def flown(self, span: Span, boot: int, up_to_order: int | None) -> list[FlightEvent]:
        """What a span that has ended was: a manoeuvre, an input on the ground, an autopilot's own."""
        maneuver = self._cut(span, boot, up_to_order)
        airspeed = maneuver.channels.get("airspeed")
        if airspeed is not None and 0.0 < float(np.median(airspeed.y)) < SLOWEST_FLIGHT_M_S:
            said = f"Elevator input at {span.start_s:.1f} s ignored: the aircraft does not fly."
            return [Notice("on_ground", said)]
        if closes_pitch_loop(maneuver.mode) and not is_3211(span.kind):
            # In such a mode steps are the autopilot's own, unless their timing shows a test input.
            self.autopilots[maneuver.mode] += 1
            return []
        return self._counted(maneuver)

    def marked(self, mark: Mark, boot: int, up_to_order: int | None) -> list[FlightEvent]:
        """A marked stretch is a manoeuvre, whatever the finder would make of it."""
        elevator = self._tracks.cut("elevator", mark.start_s - LEAD_IN_S, mark.end_s, up_to_order)
        return self._counted(self._cut(marked_span(mark, elevator), boot, up_to_order))

    def _counted(self, maneuver: Maneuver) -> list[FlightEvent]:
        self.maneuvers += 1
        if self._sense is None or "elevator" not in maneuver.channels:
            return [ManeuverFlown(maneuver)]
        maneuver, found = self._sense.right(maneuver)
        return [*found, ManeuverFlown(maneuver)]

    def _cut(self, span: Span, boot: int, up_to_order: int | None) -> Maneuver:
        channels = {}
        for name in UNITS:
            channel = self._tracks.cut(name, span.record_from_s, span.end_s, up_to_order)
            if channel is not None:
                channels[name] = replace(
                    channel, provenance=self._who.provenance(channel.source, channel.provenance)
                )
        mode = next(mode for since, mode in reversed(self._modes) if since <= span.start_s)
        return Maneuver(self.maneuvers + 1, boot, span, channels, mode)
