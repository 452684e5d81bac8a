"""A name must explain most of the gap: what leaves much of it only resembles what is there, or is nothing."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.candidates.traits import OF_ANY_AIRFRAME
from advisor.gap.fitting.holdout import HeldOut, mean_squares
from advisor.gap.fitting.measure import gap_of, whole_gap
from advisor.gap.fitting.problem import Problem
from advisor.gap.fitting.uncertainty import PLAIN, file_is_off
from advisor.gap.result import VISIBLE
from advisor.gap.search.merit import LEAST_BELIEF
from advisor.gap.search.stage import Stage, added_in
from advisor.gap.unnamed.leftover import Leftover, placed

_MOST = 0.5
"""Share of the gap that right names may leave, in still air, or else ..."""
_SEEN = 0.2
"""... this gap: an effect that is not in the catalogue leaves more beside its likeness."""

_BESIDE_THE_AIR = 0.5
"""Share that right names take away at least of what the air does not explain."""
_OF_A_RIGHT_MODEL = 2.5
"""What each of its numbers adds to the squared innovations of manoeuvres kept out, together, in those of one
sample: they are fitted to two thirds, of a motion that bends a little (1 to 7 in 25 flights) ..."""
_AT_MOST = 0.3
"""... but that share of what is there without the names: the rest is something."""
_USE = 0.1
"""Share of the gap that names must take away."""
_OF_THE_NUMBERS = 0.01
"""Share of what fitted numbers take away without them below which names only polish wrong numbers."""
_BESIDE_IT = frozenset({"thrust_moment"})
_LITTLE, _NEAR_THE_NOISE = 0.012, 2.0
"""Beside what any airframe has, thrust that misses the centre of gravity; the RMS that they must change of
some channel's peak in some manoeuvre to be a cause, and the gap from which on they are one."""
_BENT_BY_INPUT = frozenset({"moment_equation", "force_equation", "air"})
"""Where that seems to be: what an instrument does is told by other signs."""
_BENDS = frozenset({"actuator_backlash", "actuator_deadband"})
_OF_A_BEND, _OF_THE_INPUT = 0.35, 0.85
"""Share of the gap that play or a dead band takes, or any other effect of the input, from which on what they
leave is the input's, too, by another law."""


def of_the_input(
    found: Leftover, stages: Sequence[Stage], file_model: HeldOut | None, floor: FloatArray
) -> Leftover:
    """What is left, in the input where an effect there takes most of the gap and leaves something.

    A servo that sticks until it breaks away, or is slow one way only, is told as play or as a lag: what these
    leave seems to be elsewhere. Arguments as ``is_of_no_use``.
    """
    first = stages[0].added
    if found.note or found.block not in _BENT_BY_INPUT or first is None or first.block != "input":
        return found
    plain = stages[0].held_out if file_model is None else file_model
    before, after = (whole_gap(held.mean_square, floor) for held in (plain, stages[1].held_out))
    if before - after < (_OF_A_BEND if first.effect in _BENDS else _OF_THE_INPUT) * before:
        return found
    others = (pair for pair in found.ranking if pair[0] != "input")
    return replace(found, block="input", ranking=(("input", 1.0), *others))


def remainder(
    problem: Problem, stages: Sequence[Stage], file_model: HeldOut | None, floor: FloatArray
) -> Leftover | None:
    """What is there, where the named effects leave too much of the gap on manoeuvres kept out.

    All of the gap is placed: the names took up a part that was not theirs. What was named for bringing the
    derivatives back to the file's is held against those. Arguments as ``is_of_no_use``.
    """
    believed = any(j.belief >= LEAST_BELIEF for j in added_in(stages))
    plain = file_model if believed and file_model is not None else stages[0].held_out
    before, after = (whole_gap(held.mean_square, floor) for held in (plain, stages[-1].held_out))
    if len(stages) < 2 or after < max(_SEEN, _MOST * before):
        return None
    return placed(problem, stages[0].fitted)


def removed_beyond_air(stages: Sequence[Stage]) -> float | None:
    """Share of what the air does not explain that the named effects take away, on manoeuvres kept out.

    Measured in the innovations, which are freed of the air, beyond what a right model leaves there for its
    numbers being those of the other manoeuvres. None where that is everything.
    """
    last = stages[-1]
    noise, samples = last.fitted.noise**2, sum(map(len, last.fitted.innovations))
    was, now = (float(np.mean(s.held_out.innovation_square / noise)) - 1.0 for s in (stages[0], last))
    right = min(_OF_A_RIGHT_MODEL * len(last.fitted.point.shared) / samples, _AT_MOST * was)
    return 1.0 - max(now - right, 0.0) / (was - right) if was > 1e-9 else None


def only_resemble(stages: Sequence[Stage]) -> bool:
    """Whether names in moving air leave most of what it does not explain: its shape, or something else.

    What brings derivatives back to the aircraft file's need not take away anything.
    """
    named = added_in(stages)
    if not named or max(judged.belief for judged in named) >= LEAST_BELIEF:
        return False
    removed = removed_beyond_air(stages)
    return removed is not None and removed < _BESIDE_THE_AIR


def is_all_named(stages: Sequence[Stage], floor: FloatArray) -> bool:
    """Whether named effects leave nothing above the noise: then what stays is their own shape."""
    return len(stages) > 1 and whole_gap(stages[-1].held_out.mean_square, floor) < VISIBLE


def is_of_no_use(
    problem: Problem, stages: Sequence[Stage], file_model: HeldOut | None, floor: FloatArray
) -> bool:
    """Whether the named effects leave the gap as it was: likelier for the noise's filter, and no cause.

    ``file_model`` is what the aircraft file's own derivatives leave, if it has them. Fitted ones may take up
    what an effect does; that it does without them is of use, too. Only what tells a cause by itself counts.
    """
    telling = problem.flights.telling
    before = stages[0].held_out if file_model is None else file_model
    was, now = (
        float(np.mean(gap_of(held.mean_square, floor)[telling])) for held in (before, stages[-1].held_out)
    )
    return len(stages) > 1 and now > (1.0 - _USE) * was


def bends_as_any(
    problem: Problem, stages: Sequence[Stage], file_model: HeldOut | None, floor: FloatArray
) -> bool:
    """Whether what was named first is a bend, and all names are next to nothing to simulator and file.

    Linear equations hardly describe a motion better, and any aircraft bends by as much; but for what brings
    derivatives back to the file's. Arguments as for ``is_of_no_use``.
    """
    named = added_in(stages)
    bends = {j.effect for j in named} & OF_ANY_AIRFRAME
    if not bends or named[0].effect not in OF_ANY_AIRFRAME | _BESIDE_IT:
        return False
    plain, last = stages[0].held_out, stages[-1].held_out
    if any(j.belief >= LEAST_BELIEF for j in named) or whole_gap(plain.mean_square, floor) > _NEAR_THE_NOISE:
        return False
    for before in (plain, plain if file_model is None else file_model):
        lefts = zip(before.left, last.left, strict=True)
        changes = np.sqrt(mean_squares(problem, [a - b for a, b in lefts]))
        if np.any(changes >= _LITTLE * problem.flights.peaks):
            return False
    return True


def only_numbers(
    problem: Problem, stages: Sequence[Stage], file_model: HeldOut | None, floor: FloatArray
) -> bool:
    """Whether the file's derivatives are wrong with the names, too, and right ones need no name to speak of.

    Arguments as ``is_of_no_use``.
    """
    if len(stages) < 2 or file_model is None:
        return False
    was, plain, named = (
        whole_gap(held.mean_square, floor) for held in (file_model, stages[0].held_out, stages[-1].held_out)
    )
    more, beside = was - plain, plain - named
    if beside > min(VISIBLE, _OF_THE_NUMBERS * more):
        return False
    return file_is_off(problem, stages[-1].fitted, plainly=more > PLAIN)
