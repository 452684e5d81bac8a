"""The event log of a campaign: sentences, each with the vehicle's time."""

from collections import deque
from math import inf, isfinite, nan

from advisor.flight.maneuvers.maneuver import (
    READER_NOTICE,
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
from advisor.flight.maneuvers.marks import MARK_NOTICES
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.words.quantities import CLOCK, clock

KEPT = 1000
"""Largest number of sentences in the event log, 0.1 kB each: enough for some hundred manoeuvres."""
WIDTH = 7
"""Width of a sentence's time, in characters: enough for 999 minutes."""
_LATE_S = 1.0
"""Least delay of a sentence after its event, s, at which the sentence states the event's time. Stamps of
simultaneous messages differ by less than this delay."""


class Journal:
    """Writes sentences with their times, which never decrease within one power-on.

    The time of a sentence is that of its event, or the newest earlier time if that is later. A restart of the
    vehicle's clock is reported by a sentence.
    """

    def __init__(self) -> None:
        self._kept: deque[str] = deque(maxlen=KEPT)
        self.lines: tuple[str, ...] = ()
        """The newest sentences, oldest first; the same object until a sentence is added."""
        self.mark_notes: tuple[str, ...] = ()
        """Sentences about marks, for the report."""
        self.reader_notes: tuple[str, ...] = ()
        """Sentences of the reader about the record, for the report."""
        self._newest_s = -inf
        self._vehicle: Vehicle | None = None
        self._last_said: VehicleSaid | None = None

    def write(self, text: str, at_s: float = nan) -> None:
        """Write a sentence into the event log.

        Parameters
        ----------
        text
            Sentence of one line.
        at_s
            Vehicle time of the event, s since power-on. NaN: the newest time so far.
        """
        when = f"at {clock(at_s)}, " if at_s < self._newest_s - _LATE_S else ""
        self._newest_s = max(self._newest_s, at_s) if isfinite(at_s) else self._newest_s
        self._kept.append(f"{clock(self._newest_s):>{WIDTH}}  {when}{text}")
        self.lines = tuple(self._kept)

    def write_of_past(self, text: str, at_s: float) -> None:
        """Write a sentence that already states the time of its event. The event ended at ``at_s``."""
        self.write(text, max(at_s, self._newest_s))

    def take(self, event: FlightEvent) -> None:
        """Write the sentence of a flight event; the campaign handles events without a sentence."""
        match event:
            case ModeChanged(mode, at_s):
                self.write(f"mode {mode}", at_s)
            case Notice(code, text):
                self.write(text)
                self.mark_notes += (text,) if code in MARK_NOTICES else ()
                self.reader_notes += (text,) if code == READER_NOTICE else ()
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
        """Begin a new clock, whose times may be smaller; ``text`` reports this."""
        self._newest_s = -inf
        self.write(text)

    def _say(self, said: VehicleSaid) -> None:
        """Write a vehicle's text, once if the vehicle repeats the text exactly."""
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
