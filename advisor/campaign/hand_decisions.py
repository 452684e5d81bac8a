"""The engineer's decisions by hand on the flights of a campaign: marks, exclusions, notes, remarks.

Each decision refers to vehicle time instead of a manoeuvre's number, because a mark changes the numbers.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

from advisor.campaign.state import CampaignState
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.maneuvers.marks import Mark
from advisor.flight.maneuvers.segmentation import LEAD_IN_S
from advisor.words.axes import AxisName


@dataclass(frozen=True, slots=True)
class Remark:
    """The engineer's sentence on one moment of the flight."""

    at_s: float
    """Vehicle time of the remark, s since boot."""
    text: str
    boot: int = 0
    """Number of the power-on, 0 for the first power-on in the log."""
    flight: int = 0
    """Number of the log or link in the campaign, 0 for the first."""

    def concerns(self, maneuver: Maneuver) -> bool:
        """Return whether the remark's moment lies in a manoeuvre, including the manoeuvre's lead-in."""
        span = maneuver.span
        here = (self.flight, self.boot) == maneuver.power_on
        return here and span.start_s - LEAD_IN_S <= self.at_s < span.end_s


@dataclass(frozen=True, slots=True)
class ByHand:
    """The engineer's decisions by hand, in the order in which they were made."""

    marks: tuple[Mark, ...] = ()
    """Time intervals that the engineer marked as manoeuvres."""
    excluded: tuple[Remark, ...] = ()
    """Manoeuvres excluded from every decision, each with the reason."""
    notes: tuple[Remark, ...] = ()
    """The engineer's notes on manoeuvres."""
    remarks: tuple[Remark, ...] = ()
    """Moments of the flight that are marked in the event log."""

    def excluded_because(self, maneuver: Maneuver) -> str | None:
        """Return the reason for which a manoeuvre is excluded; None for an included manoeuvre."""
        return next((r.text for r in self.excluded if r.concerns(maneuver)), None)

    def notes_on(self, maneuver: Maneuver) -> tuple[str, ...]:
        return tuple(r.text for r in self.notes if r.concerns(maneuver))

    def excluding(self, maneuver: Maneuver, because: str | None) -> "ByHand":
        """Return the decisions with a manoeuvre excluded for a reason, or included again if the reason is
        None."""
        others = tuple(r for r in self.excluded if not r.concerns(maneuver))
        added = () if because is None else (_on(maneuver, because),)
        return replace(self, excluded=(*others, *added))

    def noting(self, maneuver: Maneuver, text: str) -> "ByHand":
        """Return the decisions with one more note on a manoeuvre."""
        return replace(self, notes=(*self.notes, _on(maneuver, text)))

    def remarking(self, remark: Remark) -> "ByHand":
        """Return the decisions with one more moment marked in the event log."""
        return replace(self, remarks=(*self.remarks, remark))

    def marking(self, mark: Mark) -> "ByHand":
        """Return the decisions with one more marked manoeuvre."""
        return replace(self, marks=(*self.marks, mark))

    def on_flight(self, flight: int) -> "ByHand":
        """Return the decisions on one log or link, numbered as if it were the only one."""
        return self._each(lambda entry: [replace(entry, flight=0)] if entry.flight == flight else [])

    def as_flight(self, flight: int) -> "ByHand":
        """Return the decisions on a single log or link, numbered as a flight of a campaign."""
        return self._each(lambda entry: [replace(entry, flight=flight)])

    def _each(self, changed: Callable[[Any], list[Any]]) -> "ByHand":
        """Return the decisions with ``changed`` applied to each of the lists."""
        sections = (self.marks, self.excluded, self.notes, self.remarks)
        return ByHand(*(tuple(new for entry in section for new in changed(entry)) for section in sections))


NOTHING = ByHand()
"""Empty decisions by hand."""


def on_all(decided: Sequence[ByHand]) -> ByHand:
    """Return the decisions on all logs of a campaign, from the decisions on each log."""
    flights = [hand.as_flight(flight) for flight, hand in enumerate(decided)]
    return ByHand(
        tuple(mark for hand in flights for mark in hand.marks),
        tuple(remark for hand in flights for remark in hand.excluded),
        tuple(remark for hand in flights for remark in hand.notes),
        tuple(remark for hand in flights for remark in hand.remarks),
    )


def _on(maneuver: Maneuver, text: str) -> Remark:
    return Remark(round(maneuver.span.start_s, 3), text, maneuver.boot, maneuver.flight)


Verb = Literal["exclude", "include", "note", "mark", "begin", "end"]
"""Kind of decision by hand: ``mark`` names a moment in the log; ``begin`` and ``end`` mark a manoeuvre."""


@dataclass(frozen=True, slots=True)
class HandDecision:
    """One decision by hand, with the engineer's reason."""

    verb: Verb
    text: str = ""
    """Text of the decision: a reason, a note or the name of the moment."""
    number: int = 0
    """Number of the manoeuvre; 0 for a decision on the present moment."""
    axis: AxisName = "pitch"
    """Axis of the manoeuvre."""

    def due(self, state: CampaignState) -> bool:
        """Return whether the flight has reached the manoeuvre or moment of the decision."""
        flown = state.axes[self.axis].maneuvers if self.axis in state.axes else ()
        return self.number == 0 or any(judged.maneuver.number == self.number for judged in flown)
