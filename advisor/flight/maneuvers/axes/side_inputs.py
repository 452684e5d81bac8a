"""Inputs of aileron and rudder: combination of movements, name, and length of the free response."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from advisor.flight.maneuvers.excitation import ROLL, YAW, Loop
from advisor.flight.maneuvers.maneuver import InputKind, Span
from advisor.flight.maneuvers.markers import RESTING_S
from advisor.flight.signals.record import Channel

TOGETHER_S = 1.5
"""Longest rest between two movements that form one input, s. After so short a rest the Dutch roll
has not been free for one period. The first movement would have no response of its own.
"""
BESIDE = 0.25
"""Least amplitude of a part of an input, over the largest movement's amplitude. Hands that hold the wings
level during a rudder doublet of 3 to 6 deg move the aileron by at most 0.4 deg."""
_NEXT = 0.5
"""Least amplitude of a movement that ends the free response, over the input's amplitude. The model includes
every movement of both controls, so that a smaller movement does no harm.
"""
_MEANWHILE = 0.5
"""Least common time of two movements that form one input, over the longer movement's time. Hands that hold
the wings level move for a part of an elevator test. A multisine moves all surfaces for the whole time."""
TAIL_S = (3.0, 12.0)
"""Least and greatest length of the free response, s. Three periods of a slow Dutch roll last 12 s."""
PERIODS = 3.0
"""Length of the free response in periods of the Dutch roll. With a damping of 0.08 a fifth of the amplitude
remains by then."""
_SEEN = 0.1
"""Least amplitude of a half period of the yaw rate, over the largest, for an oscillation."""
_BANKING_S = 0.75
"""Least unit of a 1-2-1 that is flown from bank to bank, s. A recorded 1-2-1 has 0.55 s, and inputs from bank
to bank have 0.88 s (autopilot) and 1.2 s (jet)."""
_LONGER = (1.5, 3.5)
"""Duration of the middle step of a 1-2-1, over the mean of the other two."""


@dataclass(frozen=True, slots=True)
class SideMovement:
    """A movement of aileron or rudder."""

    loop: Loop
    span: Span

    @property
    def amplitude(self) -> float:
        """Largest level of the movement, rad from trim."""
        return max((abs(level) for _, level in self.span.steps), default=0.0)

    def rests_by(self, at_s: float) -> bool:
        """Return whether the control has been at rest at trim long enough at a time, s."""
        return self.span.last_step_s + RESTING_S <= at_s


@dataclass(frozen=True, slots=True)
class SideInput:
    """Movements of aileron and rudder that form one lateral manoeuvre."""

    movements: tuple[SideMovement, ...]
    """At least one movement, the largest first."""

    @property
    def main(self) -> SideMovement:
        return self.movements[0]

    @property
    def last_step_s(self) -> float:
        """Onset of the last step of all movements, s."""
        return max(movement.span.last_step_s for movement in self.movements)

    @property
    def start_s(self) -> float:
        """Onset of the first step of all movements, s."""
        return min(movement.span.start_s for movement in self.movements)


@dataclass(frozen=True, slots=True)
class SideStretch:
    """A stretch whose extent the elevator or a mark gives, with an input of aileron and rudder."""

    order: int | None
    """Index of the newest message at which the stretch was complete. None at the end of the messages."""
    span: Span
    side_input: SideInput
    boot: int
    swept: bool = False
    """Whether the autopilot's SystemID moved the controls, so that each visible effect decides."""


def with_elevator(elevator: SideMovement, sides: Sequence[SideMovement]) -> tuple[SideMovement, ...]:
    """Return the movements of aileron and rudder that form one input with a movement of the elevator.

    Each has a part of the amplitude, and both move for at least half of the longer movement's time.
    """
    group = part_of_input([elevator, *sides])
    if elevator not in group:
        return ()
    return tuple(m for m in group if m is not elevator and _is_meanwhile(m.span, elevator.span))


def _is_meanwhile(span: Span, other: Span) -> bool:
    common_s = min(span.last_step_s, other.last_step_s) - max(span.start_s, other.start_s)
    longer_s = max(span.last_step_s - span.start_s, other.last_step_s - other.start_s)
    return common_s >= _MEANWHILE * longer_s > 0.0


def at_once(span: Span, side_input: SideInput) -> Span:
    """Return the extent of all controls that move at once, with the steps of one control's movement."""
    return replace(span, start_s=side_input.start_s, last_step_s=side_input.last_step_s)


def first_input(pending: Sequence[SideMovement]) -> tuple[SideInput, list[SideMovement]]:
    """Return the first input among the movements, and the remaining movements.

    Parameters
    ----------
    pending
        At least one movement, in order of onset. Small movements during a larger one are dropped.
    """
    first, *others = pending
    group = [first]
    for movement in others:
        if movement.span.start_s <= max(member.span.last_step_s for member in group) + TOGETHER_S:
            group.append(movement)
    return SideInput(part_of_input(group)), [m for m in others if m not in group]


def part_of_input(group: Sequence[SideMovement]) -> tuple[SideMovement, ...]:
    """Return the movements that form an input, the largest first, without small ones."""
    largest = max((m.amplitude for m in group), default=0.0)
    return tuple(
        sorted((m for m in group if 0.0 < m.amplitude >= BESIDE * largest), key=lambda m: -m.amplitude)
    )


def input_span(
    side_input: SideInput, following: Sequence[SideMovement], newest_s: float, yaw_rate: Channel | None
) -> Span:
    """Return the extent of an input with its free response.

    Parameters
    ----------
    following
        Later movements; the first one that is large enough ends the free response.
    newest_s
        Vehicle time of the newest sample, s.
    yaw_rate
        Yaw rate during and after the input. None if not received.
    """
    main, last_s = side_input.main.span, side_input.last_step_s
    end_s, closed_by = min(last_s + TAIL_S[1], newest_s), "quiet"
    hard = [m.span for m in side_input.movements if m.span.closed_by in ("gap", "mode change", "end of log")]
    if hard:
        end_s, closed_by = min(span.end_s for span in hard), hard[0].closed_by
    for later in following:
        if later.amplitude >= _NEXT * side_input.main.amplitude and last_s < later.span.start_s < end_s:
            end_s, closed_by = later.span.start_s, "next input"
            break
    free_s = _free_s(yaw_rate, last_s, end_s)
    if last_s + free_s < end_s:
        end_s, closed_by = last_s + free_s, "quiet"
    return replace(
        main,
        record_from_s=min(m.span.record_from_s for m in side_input.movements),
        start_s=side_input.start_s,
        last_step_s=last_s,
        end_s=max(end_s, last_s),
        closed_by=closed_by if main.closed_by != "no rest" else "no rest",
    )


def _free_s(yaw_rate: Channel | None, from_s: float, to_s: float) -> float:
    """Return the length of the free response, s: three periods of the Dutch roll, or as far as visible."""
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


def named(side_input: SideInput) -> InputKind:
    """Return the name of an input that pilots use."""
    span = side_input.main.span
    if len(side_input.movements) > 1 and len({m.loop for m in side_input.movements}) > 1:
        return "multisine" if all(m.span.kind == "multisine" for m in side_input.movements) else "other"
    stepped = "3-2-1-1" if span.kind in ("3-2-1-1", "reverse 3-2-1-1") else span.kind
    if side_input.main.loop == YAW:
        names: dict[str, InputKind] = {
            "doublet": "rudder doublet", "3-2-1-1": "rudder 3-2-1-1", "pulse": "dutch roll release",
        }  # fmt: skip
        return names.get(stepped, "other")
    if side_input.main.loop == ROLL and stepped in ("doublet", "3-2-1-1"):
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
