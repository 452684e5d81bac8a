"""Inputs of aileron and rudder: which movements belong together, their name, and the length of their tail."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from advisor.flight.maneuvers.loop import ROLL, YAW, Loop
from advisor.flight.maneuvers.maneuver import InputKind, Span
from advisor.flight.signals.record import Channel

TOGETHER_S = 1.5
"""Longest rest between two movements that count as one input, s. No Dutch roll is free for a period by then,
so that the first movement alone would have no response of its own."""
BESIDE = 0.25
"""Least amplitude of a movement next to another one, over the larger amplitude, for a part of the input.
Hands that hold the wings level next to a rudder doublet of 3 to 6 deg move the aileron by at most 0.4 deg."""
_NEXT = 0.5
"""Least amplitude of a movement that ends the free response, over that of the input. The model knows every
movement of both controls, so that a smaller one does no harm."""
TAIL_S = (3.0, 12.0)
"""Least and greatest length of the free response, s. Three periods of a slow Dutch roll take 12 s."""
PERIODS = 3.0
"""Length of the free response in periods of the Dutch roll. A damping of 0.08 leaves a fifth by then."""
_SEEN = 0.1
"""Least size of a half period of the yaw rate, over the largest, that counts as an oscillation."""
_BANKING_S = 0.75
"""Least unit of a 1-2-1 that is flown from bank to bank, s. A 1-2-1 on record has 0.55 s, those from bank to
bank have 0.88 s (autopilot) and 1.2 s (jet)."""
_LONGER = (1.5, 3.5)
"""Duration of the middle step of a 1-2-1 over the mean of its neighbours."""


@dataclass(frozen=True, slots=True)
class SideMovement:
    """A movement of aileron or rudder."""

    loop: Loop
    span: Span

    @property
    def amplitude(self) -> float:
        """Largest level, rad from trim."""
        return max((abs(level) for _, level in self.span.steps), default=0.0)


@dataclass(frozen=True, slots=True)
class SideInput:
    """Movements that make one lateral manoeuvre."""

    movements: tuple[SideMovement, ...]
    """At least one movement; the largest comes first."""

    @property
    def main(self) -> SideMovement:
        """Largest movement."""
        return self.movements[0]

    @property
    def last_step_s(self) -> float:
        """Onset of the last step of all movements, s."""
        return max(one.span.last_step_s for one in self.movements)

    @property
    def start_s(self) -> float:
        """Onset of the first step of all movements, s."""
        return min(one.span.start_s for one in self.movements)


def first_input(pending: Sequence[SideMovement]) -> tuple[SideInput, list[SideMovement]]:
    """Return the first input of the movements, and the movements that remain.

    Parameters
    ----------
    pending
        At least one movement, in the order of their onset. Small movements next to a larger one are dropped.
    """
    first, *others = pending
    group = [first]
    for one in others:
        if one.span.start_s <= max(member.span.last_step_s for member in group) + TOGETHER_S:
            group.append(one)
    return SideInput(part_of_input(group)), [one for one in others if one not in group]


def part_of_input(group: Sequence[SideMovement]) -> tuple[SideMovement, ...]:
    """Return the movements that are part of an input, the largest first; small ones next to it are none."""
    largest = max((one.amplitude for one in group), default=0.0)
    return tuple(
        sorted((m for m in group if 0.0 < m.amplitude >= BESIDE * largest), key=lambda m: -m.amplitude)
    )


def input_span(
    found: SideInput, following: Sequence[SideMovement], newest_s: float, yaw_rate: Channel | None
) -> Span:
    """Return the span of an input with its free response.

    Parameters
    ----------
    following
        Later movements; the first one of some size ends the free response.
    newest_s
        Vehicle time of the newest sample, s.
    yaw_rate
        Yaw rate over the input and the time after. None where not received.
    """
    main, last_s = found.main.span, found.last_step_s
    end_s, closed_by = min(last_s + TAIL_S[1], newest_s), "quiet"
    hard = [one.span for one in found.movements if one.span.closed_by in ("gap", "mode change", "end of log")]
    if hard:
        end_s, closed_by = min(span.end_s for span in hard), hard[0].closed_by
    for one in following:
        if one.amplitude >= _NEXT * found.main.amplitude and last_s < one.span.start_s < end_s:
            end_s, closed_by = one.span.start_s, "next input"
            break
    free_s = _free_s(yaw_rate, last_s, end_s)
    if last_s + free_s < end_s:
        end_s, closed_by = last_s + free_s, "quiet"
    return replace(
        main,
        record_from_s=min(one.span.record_from_s for one in found.movements),
        start_s=found.start_s,
        last_step_s=last_s,
        end_s=max(end_s, last_s),
        closed_by=closed_by if main.closed_by != "no rest" else "no rest",
    )


def _free_s(yaw_rate: Channel | None, from_s: float, to_s: float) -> float:
    """Return the length of the free response: three periods of the Dutch roll, or as far as one is seen."""
    tail = None if yaw_rate is None else yaw_rate.cut(from_s, to_s)
    if tail is None or len(tail) < 8:
        return TAIL_S[0]
    swing = tail.y - np.mean(tail.y)
    turns = np.flatnonzero(np.diff(np.signbit(swing)))
    if len(turns) < 2:
        return TAIL_S[0]
    peaks = [float(np.max(np.abs(swing[a : b + 1]))) for a, b in pairwise(turns)]
    clear = [k for k, peak in enumerate(peaks) if peak >= _SEEN * float(np.max(np.abs(swing)))]
    if not clear:
        return TAIL_S[0]
    at = tail.t[turns]
    half_s = float(np.median([at[k + 1] - at[k] for k in clear]))
    return float(np.clip(2.0 * PERIODS * half_s, *TAIL_S))


def named(found: SideInput) -> InputKind:
    """Return the pilots' name of an input."""
    span = found.main.span
    if len(found.movements) > 1 and len({one.loop for one in found.movements}) > 1:
        return "other"
    stepped = "3-2-1-1" if span.kind in ("3-2-1-1", "reverse 3-2-1-1") else span.kind
    if found.main.loop == YAW:
        names: dict[str, InputKind] = {
            "doublet": "rudder doublet", "3-2-1-1": "rudder 3-2-1-1", "pulse": "dutch roll release",
        }  # fmt: skip
        return names.get(stepped, "other")
    if found.main.loop == ROLL and stepped in ("doublet", "3-2-1-1"):
        return "aileron doublet" if stepped == "doublet" else "aileron 3-2-1-1"
    if not _is_one_two_one(span):
        return "other"
    unit_s = 0.25 * (span.steps[-1][0] - span.steps[0][0])
    return "bank to bank" if unit_s >= _BANKING_S else "aileron 1-2-1"


def _is_one_two_one(span: Span) -> bool:
    lasting = [b - a for (a, _), (b, _) in pairwise(span.steps)]
    levels = [level for _, level in span.steps[:-1]]
    if (
        len(levels) != 3
        or np.sign(levels[0]) == np.sign(levels[1])
        or np.sign(levels[1]) == np.sign(levels[2])
    ):
        return False
    return _LONGER[0] <= 2.0 * lasting[1] / max(lasting[0] + lasting[2], 1e-9) <= _LONGER[1]
