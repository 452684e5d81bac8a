"""The input within a marked stretch: its kind and its steps, in the finder's form."""

from advisor.flight.maneuvers.maneuver import Span
from advisor.flight.maneuvers.marks import Mark
from advisor.flight.maneuvers.movement import (
    SMALLEST_RAD,
    Movement,
    describe,
    is_still,
    median,
    without_spikes,
)
from advisor.flight.maneuvers.segmentation import LEAD_IN_S
from advisor.flight.signals.record import Channel

SWEPT = "marked by SystemID"
"""Reason of the end of a stretch in which the autopilot itself moved a control, for any of its axes."""
MARKED = {
    "hand": "marked by hand",
    "switch": "marked by a switch",
    "text": "marked by a text of the vehicle",
    "system id": SWEPT,
}
"""Kind of marker to the reason of the end of a marked stretch."""
_RESTING_S = 0.5
"""Time before the end of a mark that counts as rest, s."""
_BEFORE_S = 0.3
"""Time before a mark that gives the level before the input, s."""


def marked_span(mark: Mark, elevator: Channel | None) -> Span:
    """Return the span of a marked stretch.

    Parameters
    ----------
    mark
        Marked stretch, in seconds since boot.
    elevator
        Elevator from one lead-in before the mark to its end, rad. None where not received.

    Returns
    -------
    Span
        Span whose record begins up to one lead-in before the mark. A still elevator has no step, so that
        such a mark lacks an input and not a free response.
    """
    if elevator is None:
        return Span(mark.start_s, mark.start_s, mark.end_s, mark.end_s, "other", (), MARKED[mark.by])
    record_from_s = min(max(mark.start_s - LEAD_IN_S, float(elevator.t[0])), mark.start_s)
    found = _input(mark, elevator)
    if found is None:
        return Span(record_from_s, mark.start_s, mark.start_s, mark.end_s, "other", (), MARKED[mark.by])
    return Span(
        record_from_s,
        found.start_s,
        min(found.last_step_s, mark.end_s),
        mark.end_s,
        found.kind,
        found.steps,
        MARKED[mark.by],
    )


def _input(mark: Mark, elevator: Channel) -> Movement | None:
    """Return the movement of the elevator within the mark; None for a still elevator."""
    within = elevator.cut(mark.start_s, mark.end_s)
    if len(within) < 3:
        return None
    before = elevator.cut(mark.start_s - _BEFORE_S, mark.start_s).y
    level = median(before) if len(before) else float(within.y[0])
    rest = within.cut(float(within.t[-1]) - _RESTING_S, float(within.t[-1])).y
    moved = float(abs(without_spikes(within.y) - level).max())
    found = describe(within.t, within.y, level, rest if is_still(rest, moved) else None)
    return found if found is not None and found.amplitude >= SMALLEST_RAD else None
