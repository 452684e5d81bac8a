"""Markers of manoeuvres in flight, by a switch, texts or a script, and the input within a marked stretch."""

from collections.abc import Iterator

import numpy as np

from advisor.aircraft.aircraft import Markers
from advisor.flight.maneuvers.announced import read_announcement
from advisor.flight.maneuvers.maneuver import Span
from advisor.flight.maneuvers.marks import Mark, Marker, Switched
from advisor.flight.maneuvers.movement import (
    RETURNED,
    SMALLEST_RAD,
    Movement,
    describe,
    is_still,
    median,
    without_spikes,
)
from advisor.flight.maneuvers.segmentation import LEAD_IN_S
from advisor.flight.signals.messages import Columns, WholeTexts
from advisor.flight.signals.record import Channel
from advisor.process.arrays import FloatArray

HEARD = ("RC_CHANNELS", "STATUSTEXT")
"""Messages that may contain a mark."""
SYSTEM_ID_BEGINS, SYSTEM_ID_ENDS = b"SystemID Starting", b"SystemID stopped"
"""Texts that ArduPlane sends when its system identification begins and ends (``AP_SystemID``)."""
_NO_PULSE_US = (0, 65535)
"""Values of RC_CHANNELS for a channel that the receiver does not have (MAVLink common.xml)."""


class MarkerWatch:
    """Detection of the beginnings and ends of marks by a switch or by texts."""

    def __init__(self, markers: Markers) -> None:
        self._markers = markers
        self._texts: list[tuple[Marker, bytes, bytes]] = [("system id", SYSTEM_ID_BEGINS, SYSTEM_ID_ENDS)]
        if markers.text is not None:
            begins, ends = markers.text
            self._texts.append(("text", begins.encode(), ends.encode()))
        self._is_on = False
        self._whole = WholeTexts()

    def start_boot(self) -> None:
        """Begin another power-on. The switch is taken as off until its first message."""
        self._is_on = False

    def heard(self, columns: Columns, t: FloatArray) -> Iterator[Switched]:
        """Yield the beginnings and ends of marks in messages of one type.

        Parameters
        ----------
        columns
            Messages of a type in ``HEARD``, in order of arrival.
        t
            Shape (n,), vehicle time of each message, s since boot. A time is NaN if unknown.
        """
        if columns.name == "STATUSTEXT":
            yield from self._texts_heard(columns, t)
        elif self._markers.rc is not None:
            yield from self._switch_heard(columns, t, f"chan{self._markers.rc}_raw")

    def _switch_heard(self, columns: Columns, t: FloatArray, field: str) -> Iterator[Switched]:
        pulses = columns.fields[field]
        pulsed = np.isfinite(t) & ~np.isin(pulses, _NO_PULSE_US)
        for i in np.flatnonzero(pulsed):
            on = bool(pulses[i] > self._markers.above_us)
            if on != self._is_on:
                self._is_on = on
                yield Switched(int(columns.order[i]), float(t[i]), "switch", on)

    def _texts_heard(self, columns: Columns, t: FloatArray) -> Iterator[Switched]:
        for heard in self._whole.heard(columns, t):
            raw = heard.text
            if not np.isfinite(heard.at_s):
                continue
            if (announcement := read_announcement(raw)) is not None:
                on = announcement.word == "begin"
                yield Switched(heard.order, heard.at_s, "script", on, announcement)
            for by, begins, ends in self._texts:
                # The end comes first, because the text that begins a mark may have the other text as its
                # beginning.
                said = [on for on, text in ((False, ends), (True, begins)) if raw.startswith(text)]
                if said:
                    yield Switched(heard.order, heard.at_s, by, said[0])


SWEPT = "marked by SystemID"
"""Reason of the end of a stretch in which the autopilot itself moved a control."""
MARKED = {
    "hand": "marked by hand",
    "switch": "marked by a switch",
    "text": "marked by a text of the vehicle",
    "system id": SWEPT,
    "script": "marked by a script",
}
"""Reason of the end of a marked stretch, by the kind of marker."""
RESTING_S = 0.5
"""Length before the end of a mark that is taken as rest, s."""
_BEFORE_S = 0.3
"""Length before a mark that gives the level before the input, s."""


def marked_span(mark: Mark, elevator: Channel | None) -> Span:
    """Return the extent of the manoeuvre in a marked stretch, with its free response.

    Parameters
    ----------
    elevator
        Elevator from one lead-in before the mark to the end of the record, rad. None if the channel was not
        received.

    Returns
    -------
    Span
        Span whose record begins up to one lead-in before the mark. A constant elevator has no step, so its
        mark has no input.
    """
    end_s, by = mark.reach[1], MARKED[mark.by]
    if elevator is None:
        return Span(mark.start_s, mark.start_s, mark.end_s, end_s, "other", (), by)
    record_from_s = min(max(mark.start_s - LEAD_IN_S, float(elevator.t[0])), mark.start_s)
    movement = _input(mark, elevator)
    if movement is None:
        return Span(record_from_s, mark.start_s, mark.start_s, end_s, "other", (), by)
    last_step_s = min(movement.last_step_s, mark.end_s)
    if mark.end_s - last_step_s >= mark.free_s:
        # A script that rests before its END gives the control back there: the free response is within.
        end_s = mark.end_s
    return Span(record_from_s, movement.start_s, last_step_s, end_s, movement.kind, movement.steps, by)


def _input(mark: Mark, elevator: Channel) -> Movement | None:
    """Return the movement of the elevator within the mark; None for a constant elevator."""
    within = elevator.cut(mark.start_s, mark.end_s)
    if len(within) < 3:
        return None
    before = elevator.cut(mark.start_s - _BEFORE_S, mark.start_s).y
    level = median(before) if len(before) else float(within.y[0])
    moved, rest = _moved(within, level), _last(within)
    # A script holds its own trim at the end, whatever the loop held before.
    has_returned = is_still(rest, moved) and (
        mark.by == "script" or abs(median(rest) - level) <= RETURNED * moved
    )
    if not has_returned and not is_still(within.y, moved):
        # The return to trim may follow the mark. After a return within the mark, and after a mark in which
        # the control was held, an autopilot's loop follows.
        within = elevator.cut(mark.start_s, min(mark.end_s + 2.0 * RESTING_S, mark.reach[1]))
        moved, rest = _moved(within, level), _last(within)
    movement = describe(within.t, within.y, level, rest if is_still(rest, moved) else None)
    return movement if movement is not None and movement.amplitude >= SMALLEST_RAD else None


def _moved(within: Channel, level_rad: float) -> float:
    """Return the largest deviation from a level without single spikes, rad."""
    return float(abs(without_spikes(within.y) - level_rad).max())


def _last(within: Channel) -> FloatArray:
    """Return the values of the last rest, rad."""
    return within.cut(float(within.t[-1]) - RESTING_S, float(within.t[-1])).y
