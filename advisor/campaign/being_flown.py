"""The input that is being flown, for live faces: its errors, and the word that it is enough."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.arriving_information import ArrivingInformation
from advisor.campaign.state import AxisState
from advisor.decision.arriving import Arriving
from advisor.flight.maneuvers.announced import Announced
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.stream.flights import Flights
from advisor.process.aside import Aside
from advisor.process.parts import Parts
from advisor.words.axes import AxisName

Axes = Callable[[], Mapping[AxisName, AxisState[Any]]]
"""Function that returns the state of each axis before the input."""


@dataclass(frozen=True, slots=True)
class InputEnough:
    """The data of a multisine that a script flies are enough: the script may end it."""

    number: int
    """Number of the input in the script's texts."""


class BeingFlown:
    """Computes what is known of the input that is being flown. No verdict depends on it.

    Parameters
    ----------
    informs
        Whether the information of the input is computed.
    aside
        Compute the information in another thread.
    """

    def __init__(
        self, aircraft: Aircraft, flights: Flights, parts: Parts, informs: bool, aside: bool
    ) -> None:
        self._flights, self._parts = flights, parts
        self._information = ArrivingInformation(aircraft) if informs else None
        self._computing: Aside[Arriving | None] = Aside(aside)
        self._newest: Arriving | None = None
        self._heard_enough: Announced | None = None

    def arrived(self, flying: Maneuver | None, axes: Axes | None) -> Arriving | None:
        """Return the errors with the information of the input.

        They add to the estimate of all manoeuvres before. ``axes`` is None while one of these is being
        judged.
        """
        information = self._information
        if information is None or axes is None:
            return None
        if not self._computing.is_busy and (flying is None or information.is_due(self._flights.stream.now_s)):
            before = axes()
            pitch, side = before["pitch"], before.get("lateral")
            follow = partial(information.follow, flying, pitch.model, pitch.flight_test, side)
            part = "information of the manoeuvre being flown"
            self._computing.do(lambda: self._parts.make(part, follow, lambda _: None))
        for arrived in self._computing.made():
            self._newest = arrived
        newest = self._newest
        of_earlier = newest is None or flying is None or newest.until_s < flying.span.start_s
        return None if of_earlier else newest

    def enough(self, axes: Axes | None) -> InputEnough | None:
        """Return the event of a multisine of a script whose data have become enough; None else."""
        stream = self._flights.stream
        flown = stream.marks.announced_now
        if flown is None or flown.input != "multisine" or self._information is None:
            self._heard_enough = None
            return None
        if flown == self._heard_enough or not self._information.is_due(stream.now_s):
            return None
        arrived = self.arrived(self._flights.so_far(), axes)
        if arrived is None or not arrived.is_enough:
            return None
        self._heard_enough = flown
        return InputEnough(flown.number)
