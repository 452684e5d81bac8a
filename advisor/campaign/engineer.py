"""The engineer's decisions during a flight: exclusions, notes, and marks of moments and manoeuvres."""

import math
from collections.abc import Mapping
from dataclasses import replace

from advisor.campaign.axis_campaign import AxisCampaign
from advisor.campaign.journal import Journal
from advisor.campaign.state import ByHand, HandDecision, Remark
from advisor.flight.maneuvers.maneuver import Notice
from advisor.flight.stream.flights import Flights
from advisor.words.axes import AxisName
from advisor.words.quantities import clock

OF: Mapping[AxisName, str] = {"pitch": "", "lateral": "roll and yaw, "}
"""Words before the number of a manoeuvre, by the name of its axis."""


class Engineer:
    """Applies decisions by hand to a campaign, and writes each decision into the event log.

    Parameters
    ----------
    axes
        Campaign of each axis. Without roll and yaw, both entries are the elevator's campaign.
    decided
        Decisions by hand from an earlier reading of the flight.
    """

    def __init__(
        self, flights: Flights, journal: Journal, axes: Mapping[AxisName, AxisCampaign], decided: ByHand
    ) -> None:
        self._flights = flights
        self._journal = journal
        self._axes = axes
        self.decided = decided
        """The decisions so far."""
        self._to_remark = list(decided.remarks)

    def apply(self, decision: HandDecision) -> None:
        """Apply a decision, after which the campaign recomputes every dependent decision."""
        match decision.verb:
            case "exclude":
                self.exclude(decision.number, decision.text, decision.axis)
            case "include":
                self.include(decision.number, decision.axis)
                self.note(decision.number, f"included again: {decision.text}", decision.axis)
            case "note":
                self.note(decision.number, decision.text, decision.axis)
            case "mark":
                self.mark(decision.text)
            case "begin":
                self.begin_maneuver()
            case "end":
                self.end_maneuver()

    def exclude(self, number: int, because: str | None, axis: AxisName = "pitch") -> None:
        """Exclude a manoeuvre of an axis from every decision, and decide again on all later manoeuvres.

        Without a reason the manoeuvre is included again.
        """
        half = self._axes[axis]
        self.decided = self.decided.excluding(half.numbered(number).maneuver, because)
        what = "included again" if because is None else f"excluded: {because}"
        self._write(f"{OF[axis]}manoeuvre {number} {what}")
        half.exclude(number, because)

    def include(self, number: int, axis: AxisName = "pitch") -> None:
        """Include an excluded manoeuvre again."""
        self.exclude(number, None, axis)

    def mark(self, text: str) -> None:
        """Set a mark in the event log at the newest vehicle time."""
        if math.isfinite(self._now_s):
            here = Remark(self._now_s, text, self._flights.stream.boot, self._flights.flight)
            self.decided = self.decided.remarking(here)
        self._write(f"mark: {text}")

    def begin_maneuver(self) -> None:
        """Begin the mark of a manoeuvre at the newest vehicle time. A mark that is already open is
        deleted."""
        if not math.isfinite(self._now_s):
            self._journal.write("nothing can be marked before the vehicle's clock is heard")
            return
        self._flights.stream.marks.begin_by_hand(self._now_s)
        self._write("a manoeuvre is marked from here")

    def end_maneuver(self) -> None:
        """End the open mark at the newest vehicle time. The marked manoeuvre is judged when all its data have
        arrived."""
        ended = self._flights.stream.marks.end_by_hand(self._now_s)
        if isinstance(ended, Notice):
            self._write(ended.text)
            return
        self.decided = self.decided.marking(replace(ended, flight=self._flights.flight))
        self._write(f"a manoeuvre is marked from {clock(ended.start_s)} to here")

    def note(self, number: int, text: str, axis: AxisName = "pitch") -> None:
        half = self._axes[axis]
        self.decided = self.decided.noting(half.numbered(number).maneuver, text)
        self._write(f"note on {OF[axis]}manoeuvre {number}: {text}")
        half.note(number, text)

    def repeat_remarks(self) -> None:
        """Write earlier remarks into the event log, each at its own time."""
        now = (self._flights.flight, self._flights.stream.boot, self._flights.stream.now_s)
        for remark in [r for r in self._to_remark if (r.flight, r.boot, r.at_s) <= now]:
            self._to_remark.remove(remark)
            self._journal.write(f"mark: {remark.text}", remark.at_s)

    @property
    def _now_s(self) -> float:
        """Newest vehicle time, s, rounded to the millisecond as in the file of decisions."""
        return round(self._flights.stream.now_s, 3)

    def _write(self, sentence: str) -> None:
        """Write a sentence at the newest vehicle time."""
        self._journal.write(sentence, self._flights.stream.now_s)
