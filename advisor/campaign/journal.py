"""The event log of a campaign: sentences, each with the vehicle's time."""

from collections import deque
from collections.abc import Iterable
from math import inf, isfinite, nan

from advisor.flight.maneuvers.events import (
    DataAgain,
    FlightBegan,
    FlightEvent,
    ModeChanged,
    NoData,
    Notice,
    Rebooted,
    VehicleFound,
    VehicleSaid,
)
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.words.vehicle_time import CLOCK, clock


class EventLog:
    """Collects sentences and drops the oldest.

    Parameters
    ----------
    kept
        Number of sentences that are kept.
    """

    def __init__(self, kept: int) -> None:
        self._lines: deque[str] = deque(maxlen=kept)
        self.lines: tuple[str, ...] = ()
        """Oldest first; the same object until something is added."""

    def add(self, sentences: Iterable[str]) -> None:
        """Take further sentences."""
        further = list(sentences)
        if further:
            self._lines.extend(further)
            self.lines = tuple(self._lines)


KEPT = 1000
"""Number of sentences kept, 0.1 kB each: enough for some hundred manoeuvres."""
WIDTH = 7
"""Characters of a time: 999 minutes."""
_LATE_S = 1.0
"""Least delay of a sentence behind its event, s, at which the sentence names the event's time. The stamps of
messages of one moment differ by less."""


class Journal:
    """Writes sentences with their times, which never run backwards within one power-on.

    A sentence stands at the time of its event, or at the newest earlier time where that is later. Where the
    vehicle's clock restarts, a sentence says so.
    """

    def __init__(self) -> None:
        self._log = EventLog(KEPT)
        self._newest_s = -inf
        self._vehicle: Vehicle | None = None
        self._last_said: VehicleSaid | None = None

    @property
    def lines(self) -> tuple[str, ...]:
        """The newest sentences, oldest first."""
        return self._log.lines

    def write(self, text: str, at_s: float = nan) -> None:
        """Write a sentence.

        Parameters
        ----------
        text
            One line.
        at_s
            Vehicle time of the event, s since power-on. NaN: the newest time so far.
        """
        when = f"at {clock(at_s)}, " if at_s < self._newest_s - _LATE_S else ""
        self._newest_s = max(self._newest_s, at_s) if isfinite(at_s) else self._newest_s
        self._log.add([f"{clock(self._newest_s):>{WIDTH}}  {when}{text}"])

    def write_of_past(self, text: str, at_s: float) -> None:
        """Write a sentence that names the time of its event itself; the event was over at ``at_s``."""
        self.write(text, max(at_s, self._newest_s))

    def take(self, event: FlightEvent) -> None:
        """Write the sentence of an event of the flight; events without one are left to the campaign."""
        match event:
            case ModeChanged(mode, at_s):
                self.write(f"mode {mode}", at_s)
            case Notice(_, text):
                self.write(text)
            case VehicleSaid():
                self._say(event)
            case NoData(problems, at_s):
                for problem in problems:
                    self.write(f"NO DATA: {problem}", at_s)
            case DataAgain(at_s):
                self.write("the data serve again", at_s)
            case VehicleFound(vehicle):
                self._vehicle = vehicle
                self._begin(f"following {vehicle}; times are {CLOCK}")
            case FlightBegan(flight, name):
                self._begin(f"{name}: flight {flight + 1} begins; its times count from its own power-on")
            case Rebooted(boot):
                self._begin(
                    f"the vehicle's clock went back, as after a reboot: power-on {boot + 1}; "
                    "times count from this power-on"
                )

    def _begin(self, text: str) -> None:
        """Begin another clock, whose times may be smaller; ``text`` says so."""
        self._newest_s = -inf
        self.write(text)

    def _say(self, said: VehicleSaid) -> None:
        """Write a vehicle's text, once where the vehicle repeats it word for word."""
        last, self._last_said = self._last_said, said
        if last is not None and (said.text, said.system, said.component) == (
            last.text,
            last.system,
            last.component,
        ):
            return
        vehicle = self._vehicle
        own = vehicle is not None and (said.system, said.component) == (vehicle.system, vehicle.component)
        sender = "vehicle" if own else f"system {said.system}/{said.component}"
        self.write(f"{sender}{said.severity and f', {said.severity}'}: {said.text}", said.at_s)
