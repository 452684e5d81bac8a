"""What the evidence amounts to: the verdict and its causes, before any number of the gap is written down."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.flight.kinematics import KinematicCheck
from advisor.gap.decision import Decision
from advisor.gap.fitting.holdout import HeldOut, held_out
from advisor.gap.fitting.measure import whole_gap
from advisor.gap.fitting.problem import Problem
from advisor.gap.result import Cause, Verdict
from advisor.gap.search.merit import Judged
from advisor.gap.search.speed import airspeed_cause, speed_costs, speed_is_a_cause, speed_is_unasked
from advisor.gap.search.stage import added_in
from advisor.gap.verdict.apart import air_cause, alpha_bias_cause
from advisor.gap.verdict.causes import causes_of, with_doubt
from advisor.gap.verdict.evidence import Evidence
from advisor.gap.verdict.ledger import decisions_of
from advisor.gap.verdict.wrong_numbers import WrongNumbers, wrong_numbers

_ALONE = 0.95
"""Probability of what no fit judges (the air, an offset, the speed) where nothing else was found ..."""
_FIRST, _OTHERS = 0.9, 0.05
"""... of the first of several of them, and of all the others together ..."""
_KEPT, _BESIDE = 0.96, 0.03
"""... and beside what a fit has named: what that keeps of its own, and what they get. All these were held
against how often such answers were right on development flights (calibration, page "Gap results")."""
_REFUTED, _RIVAL = 0.05, 0.2
"""What an alternative keeps of its probability beside an answer that makes it needless, and beside a mere
companion of what was named."""
_BEHIND = 0.08
"""What everything keeps behind what makes the larger part of the gap, an offset or wrong numbers."""
_MOUNTED_RAD = 0.02
"""Offset of α up to which what is named beside it comes first: that of an instrument's mounting."""
_MOSTLY = 0.98
"""Share of the gap that wrong numbers make, from which on they are the answer whatever is there besides: what
leaves the file right, and is imitated by other numbers, is imitated by nine tenths at most, but for the one
that they imitate exactly, if with it they are nearer to the file's."""
_HALF = 0.5
"""What all that was named keeps of its probability where something without a name is there besides."""


@dataclass(frozen=True)
class Judgement:
    """Verdict and causes."""

    verdict: Verdict
    causes: tuple[Cause, ...]
    """Likeliest first, at most five."""
    apart: tuple[Cause, ...]
    """Those of them that no fit judges: the air, the offset, the air speed."""
    speed: Cause | None
    """The change of air speed, when ignoring it would cost, cause or not."""
    bias: Cause | None
    before: HeldOut
    """What the simulator left before anything was added to it."""
    wrong_numbers: bool
    """Whether the file's derivatives are off, by themselves or beside the causes."""
    decisions: tuple[Decision, ...]
    """What was asked on the way; see ``ledger``."""


@dataclass(frozen=True)
class _Found:
    """What speaks for one verdict or another."""

    named: list[Judged]
    left: float
    """Gap of the last model."""
    removed: float
    """What the names take away, mean square over the floor's."""
    numbers: WrongNumbers
    bias: Cause | None
    speed: Cause | None
    """The change of air speed, when ignoring it would cost; a cause only if it stands in ``apart``."""
    speed_outweighs: bool
    apart: tuple[Cause, ...]
    unknown: bool
    """Something without a name is the answer."""

    @property
    def names(self) -> float:
        """What the names explain, none less than nothing."""
        return max(self.removed, 0.0)


def judgement(e: Evidence, kinematics: KinematicCheck) -> Judgement:
    """Weigh what was found."""
    found = _found(e, kinematics)
    causes = _ordered(e, found)
    verdict = _verdict(found, causes)
    before = e.file_model if e.file_model is not None else e.stages[0].held_out
    if e.constant_speed is not None and found.speed in found.apart:
        before = _at_constant_speed(e.problem, before, e.constant_speed, e.stages[-1].held_out)
    causes = _beside(verdict, causes, bool(found.named))
    return Judgement(
        verdict, causes, found.apart, found.speed, found.bias, before, found.numbers.are_wrong,
        decisions_of(e, found.numbers),
    )  # fmt: skip


def _found(e: Evidence, kinematics: KinematicCheck) -> _Found:
    """Everything that was found, and what of it is a cause."""
    problem, floor = e.problem, e.floor
    first, last = e.stages[0].held_out, e.stages[-1].held_out
    left, named = whole_gap(last.mean_square, floor), added_in(e.stages)
    removed = float(np.mean((first.mean_square - last.mean_square) / floor**2))
    # Noise that the air makes hides nothing from a simulator that knows the air's motion.
    still = floor if e.air is None else np.minimum(floor, np.sqrt(e.air.left))
    numbers = wrong_numbers(e, named, still)
    alone = not (named or numbers.are_wrong or e.leftover)
    seen_once = len(problem.flights) == 1
    bias = None if seen_once else alpha_bias_cause(kinematics, named, problem, left, alone)
    apart = tuple(c for c in (air_cause(e), bias) if c is not None)
    speed = None
    if all(judged.effect != "airspeed_variation" for judged in named):
        speed = airspeed_cause(problem, e.constant_speed, last, floor)
    outweighs = _speed_outweighs(e, max(numbers.gap, removed))
    told = (named or bias or numbers.are_wrong) and not outweighs
    judge_speed = speed_is_unasked if told else speed_is_a_cause
    if speed is not None and judge_speed(problem, e.constant_speed, last, still, e.air):
        apart = (speed, *apart)
    return _Found(named, left, removed, numbers, bias, speed, outweighs, apart, e.leftover is not None)


def _ordered(e: Evidence, found: _Found) -> tuple[Cause, ...]:
    """Causes of the fits and those judged apart, what makes the larger part of the gap first."""
    channels = e.problem.channels
    unexplained = e.leftover.share if e.leftover is not None else 0.0
    fitted = causes_of(e.stages, e.floor, unexplained, channels)
    causes = _merge(tuple(with_doubt(cause, e.problem) for cause in fitted), found.apart)
    bias, speed = found.bias, found.speed
    derived = e.problem.flights.alpha_is_derived
    if bias is not None and not found.unknown and not derived and _is_plain(bias, found.named):
        offset = (bias.parameters["bias_rad"].value / e.floor[channels.index("alpha")]) ** 2
        if float(offset) / len(e.floor) > found.names:
            causes = _put_first(causes, bias)
    if speed is not None and speed in found.apart and found.speed_outweighs:
        causes = _put_first(causes, speed)
    return causes


def _verdict(found: _Found, causes: Sequence[Cause]) -> Verdict:
    """What makes the gap is the answer: an aircraft may bend a little besides."""
    numbers = found.numbers
    mostly = not numbers.are_imitated and numbers.gap > _MOSTLY * (numbers.gap + found.names)
    wrong = numbers.are_wrong and numbers.outweigh_the_air and (mostly or not found.named)
    if found.unknown:
        return "unknown"
    if wrong and not (found.bias or found.speed in found.apart):
        return "parameters"
    return "effect" if any(c.present for c in causes) else "none"


def _beside(verdict: Verdict, causes: tuple[Cause, ...], named: bool) -> tuple[Cause, ...]:
    """The causes with the probability that the verdict leaves them."""
    if verdict == "effect":
        return causes
    keeps = _HALF if verdict == "unknown" else _BEHIND if named else _REFUTED
    kept = tuple(replace(c, probability=keeps * c.probability) for c in causes)
    return kept if verdict == "unknown" else tuple(sorted(kept, key=lambda c: -c.probability))


def _is_plain(bias: Cause, named: Sequence[Judged]) -> bool:
    """Whether an offset is more than a mounting leaves, or nothing that the stick shows was named."""
    return not named or abs(bias.parameters["bias_rad"].value) > _MOUNTED_RAD


def _at_constant_speed(problem: Problem, before: HeldOut, constant: HeldOut, last: HeldOut) -> HeldOut:
    """What a simulator leaves that knows neither the named effects nor the air speed: both errors."""
    errors = zip(before.left, constant.left, last.left, strict=True)
    return held_out(problem, [plain + still - left for plain, still, left in errors])


def _speed_outweighs(e: Evidence, others: float) -> bool:
    """Whether speeds that nothing measured cost a simulator more than wrong numbers or named effects do."""
    if e.problem.flights.speed_measured or e.constant_speed is None:
        return False
    return speed_costs(e.constant_speed, e.stages[-1].held_out, e.floor) > others


def _merge(causes: tuple[Cause, ...], extra: Sequence[Cause]) -> tuple[Cause, ...]:
    """Causes judged apart from the fits (air, constant offset, speed) beside those judged by it."""
    present, other = [c for c in causes if c.present], [c for c in causes if not c.present]
    if extra and not present:
        # The first is the larger one; where there is only one, it has no rival.
        rest = len(extra) - 1
        shares = [_ALONE] if not rest else [_FIRST, *[_OTHERS / rest] * rest]
        other = [replace(c, probability=_REFUTED * c.probability) for c in other]
        named = (replace(c, probability=p) for c, p in zip(extra, shares, strict=True))
        return (*named, *other)[:5]
    if extra:
        present = [replace(c, probability=_KEPT * c.probability) for c in present]
        extra = [replace(c, probability=_BESIDE / len(extra)) for c in extra]
        other = [replace(c, probability=_RIVAL * c.probability) for c in other]
    return (*present, *extra, *other)[:5]


def _put_first(causes: tuple[Cause, ...], first: Cause) -> tuple[Cause, ...]:
    """What makes the larger part of the gap ahead of everything else."""
    rest = tuple(replace(c, probability=_BEHIND * c.probability) for c in causes if c.effect != first.effect)
    return (replace(first, probability=_FIRST), *rest)[:5]
