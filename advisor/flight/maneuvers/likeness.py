"""Properties that the tests of a flight share: each begins from rest, and their sizes are similar."""

from collections.abc import Sequence

import numpy as np

from advisor.flight.maneuvers.loop import Loop
from advisor.flight.maneuvers.maneuver import Span
from advisor.flight.signals.record import Channel
from advisor.words.digits import distinct_texts

_BEFORE_S = 0.5
"""Length before an input over which the rate is averaged, s: the least rest of the control."""
_OF_TESTS = 0.25
"""Least amplitude of a test, over the median of the tests before it. 250 flown tests have at least 0.39.
Movements of the hands between tests, which no other criterion recognises, have up to 0.23."""
_STEADY = 0.5
"""Largest mean rate before a test, over half the range of the rate within. 260 flown tests of eleven aircraft
have at most 0.31. Movements of hands that counter a rotation have up to 1.5."""


def begun_in_motion(span: Span, rate: Channel, loop: Loop) -> str | None:
    """Return the reason why an input does not begin from steady flight; None if it does.

    A rotation that continues after the input is a turn, which is steady flight.
    """
    before = rate.cut(span.start_s - _BEFORE_S, span.start_s).y
    within = rate.cut(span.start_s, span.end_s).y
    if len(before) < 2 or len(within) < 2:
        return None
    after = rate.cut(span.end_s - _BEFORE_S, span.end_s).y
    turns = float(np.mean(before))
    stops = min(abs(turns), abs(turns - float(np.mean(after)))) if len(after) else abs(turns)
    share = stops / max(0.5 * float(np.ptp(within)), 1e-12)
    if share <= _STEADY:
        return None
    shown, most = distinct_texts(100.0 * share, 100.0 * _STEADY)
    begins = f"the {loop.rate_said} before the {loop.control} moved was {shown} % of that after"
    return f"{begins} (limit {most}), and a test begins from rest; not a test input"


def much_smaller(span: Span, tests: Sequence[Span], control: str) -> str | None:
    """Return the reason why an input is much smaller than the tests before; None if it is not.

    A 3-2-1-1 of any size is accepted, because hands fly no 3-2-1-1 by accident.
    """
    if "3-2-1-1" in span.kind:
        return None
    before = [_amplitude(test) for test in tests if test.steps]
    share = _amplitude(span) / max(float(np.median(before)), 1e-12) if before else 1.0
    if share >= _OF_TESTS:
        return None
    shown, least = distinct_texts(100.0 * share, 100.0 * _OF_TESTS)
    return f"a correction: the {control} moved by {shown} % of the tests before (at least {least})"


def _amplitude(span: Span) -> float:
    return max((abs(level) for _, level in span.steps), default=0.0)
