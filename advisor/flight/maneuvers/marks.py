"""Stretches of flight marked as manoeuvres: by hand, a switch, a text, a script, or the autopilot's SystemID.

A mark replaces every input that the segmenter finds in the marked stretch. A mark during the stream gives the
same manoeuvre as a mark known before the stream.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from advisor.aircraft.aircraft import ScriptIdentity
from advisor.flight.maneuvers.announced import SCRIPT_NOTICE, Announced, Announcement, Announcements
from advisor.flight.maneuvers.maneuver import Notice, Span
from advisor.flight.maneuvers.segmentation import LEAD_IN_S
from advisor.words.problems import Problem
from advisor.words.quantities import clock, stretch

Marker = Literal["hand", "switch", "text", "system id", "script"]

LONGEST_S = 100.0
"""Longest mark, s. Longest mark, s. With its lead-in a mark must fit into the two minutes of channels that a
stream keeps.
"""
MARK_NOTICES = frozenset({"mark_length", "marked_already", "mark_dropped", SCRIPT_NOTICE})
"""Codes of the notices on marks that cannot be used."""
FREE_S = 3.0
"""Length of the free response after the END of a script, s. The surfaces rest there, and the motion shows the
servos' lags. Three seconds are the least free response of an unmarked lateral input.
"""
EDGE_S = 2.0
"""Largest distance by which a mark may exceed the end of the log, s. A power cut loses the last second of a
recording."""


@dataclass(frozen=True, slots=True)
class Mark:
    """A stretch of flight marked as a manoeuvre."""

    start_s: float
    """Begin of the stretch, s since boot."""
    end_s: float
    """End of the stretch, s since boot."""
    boot: int | None = None
    """Number of the power-on, 0 for the first in the log. None for the first power-on that contains the
    stretch."""
    from_log_start: bool = False
    """Whether the times are relative to the log's first sample instead of the boot."""
    by: Marker = "hand"
    """Source of the mark: a hand, a switch, a text, SystemID or a script."""
    name: str = "A mark"
    """Beginning of a sentence about the mark."""
    flight: int = 0
    """Number of the campaign's log or link, 0 for the first."""
    announced: Announced | None = None
    """Input that a script announced for the stretch. None for a mark of another source."""
    free_s: float = 0.0
    """Longest free response after the stretch that belongs to the record, s."""

    @property
    def reach(self) -> tuple[float, float]:
        """Begin and end of the record, s since boot: the stretch with its lead-in and free response."""
        return self.start_s - LEAD_IN_S, self.end_s + self.free_s

    def until(self, last_s: float) -> "Mark":
        """Return the mark without the time after ``last_s``, s since boot."""
        end_s = min(self.end_s, last_s)
        return replace(self, end_s=end_s, free_s=min(self.free_s, max(last_s - end_s, 0.0)))

    def overlaps(self, start_s: float, end_s: float) -> bool:
        return self.start_s < end_s and start_s < self.end_s


@dataclass(frozen=True, slots=True)
class Switched:
    """Switch movement or text of the vehicle that begins or ends a mark."""

    order: int
    """Index of the message in the order of arrival."""
    at_s: float
    """Vehicle time of the message, s since boot."""
    by: Marker
    on: bool
    """Whether the message begins a mark. False if the message ends a mark."""
    announcement: Announcement | None = None
    """Text of a script. None for a message of another source."""


@dataclass(frozen=True, slots=True)
class Due:
    """Marks, spans and notices that have become final."""

    marks: tuple[Mark, ...] = ()
    """Complete marks in order of their ends, in seconds since boot."""
    spans: tuple[tuple[Span, int | None], ...] = ()
    """Spans of the segmenter that no mark replaced, after an open mark delayed them, each with its arrival
    order."""
    notices: tuple[Notice, ...] = ()
    """Notices about marks that cannot be used."""


class Marks:
    """Marks of one stream, and the segmenter's spans that they may replace.

    Parameters
    ----------
    aircraft
        Identity of the aircraft file, which a script must state. None: every script is taken.
    """

    def __init__(self, given: Sequence[Mark] = (), aircraft: ScriptIdentity | None = None) -> None:
        self._given = list(given)
        self._script = Announcements(aircraft)
        self._heard: list[tuple[float, float]] = []
        self.start_boot(0, 0.0)

    def start_boot(self, boot: int, earlier_s: float) -> None:
        """Begin another power-on, after ``earlier_s`` seconds of the log."""
        self._boot, self._earlier_s = boot, earlier_s
        self._first_s = np.nan
        self._switched: list[Switched] = []
        self._open: dict[Marker, float] = {}
        self._script.start_boot()
        self._script_order: int | None = None
        self._waiting: dict[Mark, Mark | None] = {}
        self._closed: list[Mark] = []
        self._held: list[tuple[Span, int | None]] = []
        self._notices: list[Notice] = []

    def start_clock(self, first_s: float) -> None:
        """Take the first clock reading of this power-on, ``first_s`` since boot."""
        self._first_s = first_s
        for mark in tuple(self._given):
            by_s = first_s - self._earlier_s if mark.from_log_start else 0.0
            start_s, end_s = mark.start_s + by_s, mark.end_s + by_s
            if mark.boot not in (None, self._boot) or start_s < first_s - EDGE_S or end_s <= first_s:
                continue
            here = replace(mark, start_s=max(start_s, first_s), end_s=end_s, from_log_start=False)
            refused = self._refused(here)
            if refused is not None:
                self._given.remove(mark)
                self._notices.append(refused)
            else:
                self._waiting[here] = mark

    def hear(self, switched: Iterable[Switched]) -> None:
        """Take switch movements or texts of one message type, in order of arrival."""
        new = sorted(switched, key=lambda switch: switch.order)
        if self._script_order is None:
            self._script_order = next((switch.order for switch in new if switch.by == "script"), None)
        self._switched = sorted([*self._switched, *new], key=lambda switch: switch.order)

    def script_passes_over(self, span: Span, up_to_order: int | None) -> bool:
        """Return whether a script in the autopilot announces its inputs, but not this movement.

        A text without a partner may belong to the movement.

        Parameters
        ----------
        up_to_order
            Arrival order of the newest message that counts. None: all messages so far.
        """
        first = self._script_order
        if first is None or (up_to_order is not None and first > up_to_order):
            return False
        return not any(span.record_from_s <= at_s <= span.end_s for at_s in self._script.alone_s)

    def begin_by_hand(self, at_s: float) -> None:
        """Begin a mark. A mark that is already open is dropped."""
        self._open["hand"] = at_s

    def end_by_hand(self, at_s: float) -> Mark | Notice:
        """End the open mark, or return a notice with the reason why that is impossible."""
        if "hand" not in self._open:
            return Notice("no_mark", "No mark is open: begin one first.")
        mark = Mark(self._open.pop("hand"), at_s, self._boot)
        refused = self._refused(mark)
        if refused is None:
            self._waiting[mark] = None
        return refused or mark

    @property
    def by_hand_since_s(self) -> float | None:
        """Begin of the open mark by hand, s since boot. None without an open mark."""
        return self._open.get("hand")

    @property
    def announced_now(self) -> Announced | None:
        """Input that a script has begun and not ended. None without one."""
        return self._script.open

    def since_s(self, now_s: float) -> float | None:
        """Return the begin of the mark that is open at ``now_s``, s since boot; None without an open mark."""
        begun = [m.start_s for m in self._waiting if m.start_s <= now_s <= m.end_s]
        return min([*begun, *self._begun_s], default=None)

    def advance(self, order: int) -> None:
        """Note that all messages before ``order`` have been processed."""
        while self._switched and self._switched[0].order <= order:
            switched = self._switched.pop(0)
            if switched.announcement is not None:
                self._announced(switched.announcement, switched.at_s)
            elif switched.on:
                self._open.setdefault(switched.by, switched.at_s)
            elif switched.by in self._open:
                self._close(switched.by, switched.at_s)

    def hides(self, span: Span, order: int | None) -> bool:
        """Return whether a mark replaces a span of the segmenter, or an open mark may still replace it.

        A mark replaces an input that it overlaps, but not an input whose free response it ends.
        """
        if self.holds(span):
            return True
        waits = any(since_s < span.end_s for since_s in self._begun_s)
        if waits:
            self._held.append((span, order))
        return waits

    def holds(self, span: Span) -> bool:
        """Return whether a closed mark overlaps the input of a span."""
        return any(m.overlaps(span.start_s, span.last_step_s) for m in (*self._waiting, *self._closed))

    def before(self, span: Span) -> Span:
        """Return the span of an input outside all marks, with a free response that ends where a mark
        begins."""
        begin_s = [m.start_s for m in (*self._waiting, *self._closed)]
        within = [at_s for at_s in begin_s if span.last_step_s <= at_s < span.end_s]
        return replace(span, end_s=min(within), closed_by="next input") if within else span

    def due(self, arrived_s: float) -> Due:
        """Return the final marks and spans when all channels have arrived up to ``arrived_s`` since boot."""
        self._notices += self._script.expire(arrived_s, LONGEST_S)
        ready = [m for m in self._waiting if m.reach[1] <= arrived_s]
        return self._due(ready) if ready or self._held or self._notices else Due()

    def finish(self, last_s: float) -> Due:
        """Return the final marks and spans at the end of the power-on at ``last_s``, s since boot. A switch
        that is still on ends its mark at ``last_s``.

        A mark by hand without an end is dropped.
        """
        self.advance(self._switched[-1].order if self._switched else 0)
        self._notices += self._script.finish()
        begun_s = self._open.pop("hand", None)
        if begun_s is not None:
            said = "is dropped: the vehicle's clock began anew before its end."
            self._notices.append(Notice("mark_dropped", f"The mark begun at {clock(begun_s)} {said}"))
        for by in tuple(self._open):
            self._close(by, last_s)
        self._heard.append((self._first_s, last_s))
        within = [m for m in self._waiting if m.start_s < last_s and m.end_s <= last_s + EDGE_S]
        return self._due(within, last_s)

    def _due(self, complete: Sequence[Mark], last_s: float = np.inf) -> Due:
        ready = sorted(complete, key=lambda m: (m.end_s, m.start_s))
        for mark in ready:
            given = self._waiting.pop(mark)
            if given is not None:
                self._given.remove(given)
        self._closed += ready
        held, self._held = self._held, []
        released = tuple((span, order) for span, order in held if not self.hides(span, order))
        notices, self._notices = tuple(self._notices), []
        begun_s = [*self._begun_s, *(m.start_s for m in (*self._waiting, *self._closed)), last_s]
        until_s = [min((at_s for at_s in begun_s if at_s >= m.end_s), default=np.inf) for m in ready]
        return Due(tuple(map(Mark.until, ready, [min(s, last_s) for s in until_s])), released, notices)

    def _close(self, by: Marker, at_s: float) -> None:
        self._take(Mark(self._open.pop(by), at_s, self._boot, by=by))

    def _announced(self, said: Announcement, at_s: float) -> None:
        """Take a text of a script."""
        for complete in self._script.take(said, at_s):
            if isinstance(complete, Notice):
                self._notices.append(complete)
            elif complete.end_s > complete.start_s:
                where = (complete.start_s, complete.end_s, self._boot)
                self._take(Mark(*where, by="script", announced=complete.announced, free_s=FREE_S))

    @property
    def _begun_s(self) -> list[float]:
        """Begins of all open marks, s since boot."""
        script_s = self._script.since_s
        return [*self._open.values(), *(() if script_s is None else (script_s,))]

    def _take(self, mark: Mark) -> None:
        refused = self._refused(mark)
        if refused is None:
            self._waiting[mark] = None
        else:
            self._notices.append(refused)

    def _refused(self, mark: Mark) -> Notice | None:
        """Return the reason why a closed mark cannot be used; None for a usable mark."""
        length_s = mark.end_s - mark.start_s
        where = f"The mark from {stretch(mark.start_s, mark.end_s)}"
        if not 0.0 < length_s <= LONGEST_S:
            most = f"is {length_s:.1f} s long: a mark lasts more than 0 and at most {LONGEST_S:.0f} s."
            return Notice("mark_length", f"{where} {most}")
        others = [m.start_s for m in (*self._closed, *self._waiting) if m.overlaps(mark.start_s, mark.end_s)]
        hand_s = self._open.get("hand", np.inf)
        if hand_s < mark.end_s:
            others.append(hand_s)
        if others:
            said = f"another mark begins at {clock(min(others))} and shares time with it."
            return Notice("marked_already", f"{where} is left out: {said}")
        return None

    def problems(self) -> list[Problem]:
        """Return a problem for each mark that lies in no power-on of the stream."""
        heard = " and ".join(stretch(a, b) for a, b in self._heard if np.isfinite(a))
        return [
            Problem(
                "mark_outside",
                f"{mark.name} lies outside of the log, which holds {heard or 'no vehicle time'}.",
                "Give a stretch within the log: seconds since power-on, or from its start with + (+12:+24).",
            )
            for mark in self._given
        ]
