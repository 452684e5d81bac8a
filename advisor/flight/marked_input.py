"""The input within a marked stretch: its kind and its steps, as far as it has a known shape."""

from typing import NamedTuple

import numpy as np

from advisor.flight.input_shape import SMALLEST_RAD
from advisor.flight.maneuver import InputKind, Span
from advisor.flight.marks import Mark
from advisor.flight.record import Channel
from advisor.flight.segmentation import LEAD_IN_S, Segmenter
from advisor.flight.shape import BAND, Shape
from advisor.flight.stretch import RESTING_S

MARKED = {"hand": "marked by hand", "switch": "marked by a switch", "text": "marked by a text of the vehicle"}
"""Why the span of a marked stretch ended, by who or what marked it."""


class _Input(NamedTuple):
    kind: InputKind
    start_s: float
    last_step_s: float
    steps: tuple[tuple[float, float], ...]


def marked_span(mark: Mark, elevator: Channel | None) -> Span:
    """The span of a marked stretch.

    Parameters
    ----------
    mark
        The stretch, in seconds since boot.
    elevator
        The elevator from one lead-in before the mark until its end, rad; None where it was not heard.

    Returns
    -------
    Span
        Its record begins up to one lead-in before the mark, where the elevator was heard by then.
    """
    if elevator is None:
        return Span(mark.start_s, mark.start_s, mark.end_s, mark.end_s, "other", (), MARKED[mark.by])
    found = _recognised(mark, elevator) or _unnamed(mark, elevator)
    record_from_s = min(max(mark.start_s - LEAD_IN_S, float(elevator.t[0])), mark.start_s)
    return Span(
        record_from_s, found.start_s, found.last_step_s, mark.end_s, found.kind, found.steps, MARKED[mark.by]
    )


def _recognised(mark: Mark, elevator: Channel) -> _Input | None:
    """The input of the stretch as the finder knows it, where it is the only one."""
    finder = Segmenter()
    found: list[Span | Shape] = []
    for t, u in zip(elevator.t.tolist(), elevator.y.tolist(), strict=True):
        if (span := finder.push(t, u)) is not None:
            found.append(span)
    last = finder.recognised or finder.finish()
    if last is not None:
        found.append(last)
    if len(found) != 1 or found[0].start_s < mark.start_s - LEAD_IN_S:
        return None
    return _Input(found[0].kind, found[0].start_s, found[0].last_step_s, found[0].steps)


def _unnamed(mark: Mark, elevator: Channel) -> _Input:
    """From the beginning of the mark to where the elevator leaves for the level of its end.

    An elevator that keeps still leaves at once: what such a mark lacks is an input, not a free response.
    """
    within = elevator.cut(mark.start_s, mark.end_s)
    if len(within) < 2:
        return _Input("other", mark.start_s, mark.end_s, ())
    level = float(np.median(within.cut(within.t[-1] - RESTING_S, within.t[-1]).y))
    away = np.abs(within.y - level)
    if np.max(away) < SMALLEST_RAD:
        return _Input("other", mark.start_s, mark.start_s, ())
    last = np.flatnonzero(away > BAND * np.max(away))[-1]
    return _Input("other", mark.start_s, float(within.t[last]), ())
