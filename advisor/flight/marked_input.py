"""The input within a marked stretch: its kind and its steps, as the finder describes them."""

from advisor.flight.maneuver import Span
from advisor.flight.marks import Mark
from advisor.flight.movement import Movement, describe
from advisor.flight.record import Channel
from advisor.flight.rest import SMALLEST_RAD, is_still, median, without_spikes
from advisor.flight.segmentation import LEAD_IN_S

MARKED = {"hand": "marked by hand", "switch": "marked by a switch", "text": "marked by a text of the vehicle"}
"""Why the span of a marked stretch ended, by who or what marked it."""
_RESTING_S = 0.5
"""The end of a mark counts as rest over this time, s."""
_BEFORE_S = 0.3
"""The level before the input is that of so much before the mark, s."""


def marked_span(mark: Mark, elevator: Channel | None) -> Span:
    """Return the span of a marked stretch.

    Parameters
    ----------
    mark
        The stretch, in seconds since boot.
    elevator
        The elevator from one lead-in before the mark until its end, rad; None where it was not heard.

    Returns
    -------
    Span
        Its record begins up to one lead-in before the mark, where the elevator was heard by then. An elevator
        that keeps still has no step: what such a mark lacks is an input, not a free response.
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
    """What the elevator does within the mark; None where it keeps still."""
    within = elevator.cut(mark.start_s, mark.end_s)
    if len(within) < 3:
        return None
    before = elevator.cut(mark.start_s - _BEFORE_S, mark.start_s).y
    level = median(before) if len(before) else float(within.y[0])
    rest = within.cut(float(within.t[-1]) - _RESTING_S, float(within.t[-1])).y
    moved = float(abs(without_spikes(within.y) - level).max())
    found = describe(within.t, within.y, level, rest if is_still(rest, moved) else None)
    return found if found is not None and found.amplitude >= SMALLEST_RAD else None
