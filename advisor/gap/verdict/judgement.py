"""What the evidence amounts to: the verdict and its causes, before any number of the gap is written down."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.flight.kinematics import KinematicCheck
from advisor.flight.messages import FloatArray
from advisor.gap.fitting.holdout import HeldOut, held_out
from advisor.gap.fitting.measure import whole_gap
from advisor.gap.fitting.problem import Problem
from advisor.gap.fitting.uncertainty import PLAIN, file_is_off
from advisor.gap.result import VISIBLE, Cause, Value, Verdict
from advisor.gap.search.merit import Judged
from advisor.gap.search.speed import airspeed_cause, speed_costs, speed_is_a_cause, speed_is_unasked
from advisor.gap.search.stage import added_in
from advisor.gap.search.ties import breaking
from advisor.gap.verdict.causes import alpha_bias_cause, alpha_lag_cause, causes_of, with_doubt
from advisor.gap.verdict.evidence import Evidence
from advisor.gap.verdict.kept_out import without_air

_ALONE = 0.95
"""Probability of what no fit judges (the air, an offset, the speed) where nothing else was found ..."""
_FIRST, _OTHERS = 0.9, 0.05
"""... of the first of several of them, and of all the others together ..."""
_KEPT, _BESIDE = 0.96, 0.03
"""... and beside what a fit has named: what that keeps of its own, and what they get. All these were held
against how often such answers were right on development flights (calibration, ``docs/gap-results.md``)."""
_REFUTED, _RIVAL = 0.05, 0.2
"""What an alternative keeps of its probability beside an answer that makes it needless, and beside a mere
companion of what was named."""
_BEHIND = 0.08
"""The same of everything behind what makes the larger part of the gap, an offset or wrong numbers."""
_MOUNTED_RAD = 0.02
"""Offset of α up to which what is named beside it comes first: that of an instrument's mounting."""
_MOSTLY = 0.98
"""Share of the gap that wrong numbers make, from which on they are the answer whatever is there besides: what
leaves the file right, and is imitated by other numbers, is imitated by nine tenths at most, but for the one
that they imitate exactly, if with it they are nearer to the file's."""
_BY_NAMES = 0.8
"""Share of the gap that names must explain beside the file's own derivatives, if these are to be right."""
_BY_FAR = 0.985
"""The same beside something without a name in the equations that they belong to."""
_EQUATIONS = frozenset({"force_equation", "moment_equation"})
_FAR_MORE = 3.0
"""Gap of wrong numbers beside the air's from which on it is not the air that they bend to."""
_HALF = 0.5
"""The same of all that was named where something without a name is there besides."""
_AIR_DOUBT = 0.25
"""Relative error of a gust's strength: its course is known to low order only."""
_WAVES_DOUBT = 0.5
"""The same of turbulence: waves longer than a record pass for its trim. Dryden's air reads 0.5 to 0.7 of its
strength where the scale length takes three seconds and more to fly through, 1.2 where it takes one."""
_AIR_DOUBT_S = 0.1
"""Of a gust's time: the distance between two knots of its course."""


@dataclass(frozen=True)
class Judgement:
    """Verdict and causes."""

    verdict: Verdict
    causes: tuple[Cause, ...]
    """Likeliest first, at most five."""
    apart: tuple[Cause, ...]
    """Those of them that no fit judges: the air, the offset, a late angle of attack, the air speed."""
    speed: Cause | None
    """The change of air speed, when ignoring it would cost, cause or not."""
    bias: Cause | None
    before: HeldOut
    """What the simulator left before anything was added to it."""
    wrong_numbers: bool
    """Whether the file's derivatives are off, by themselves or beside the causes."""


def judgement(e: Evidence, kinematics: KinematicCheck) -> Judgement:
    """Weigh what was found."""
    problem, stages, floor = e.problem, e.stages, e.floor
    first, last = stages[0].held_out, stages[-1].held_out
    left = whole_gap(last.mean_square, floor)
    named = added_in(stages)
    late = alpha_lag_cause(kinematics, problem, named, left)
    speed = None
    if all(judged.effect != "airspeed_variation" for judged in named):
        speed = airspeed_cause(problem, e.constant_speed, last, floor)
    # Noise that the air makes hides nothing from a simulator that knows the air's motion.
    still = floor if e.air is None else np.minimum(floor, np.sqrt(e.air.left))
    numbers = _wrong_numbers(e, named, still)
    alone = not (named or late or numbers.are_wrong or e.leftover)
    bias = alpha_bias_cause(kinematics, named, problem, left, alone)
    removed = float(np.mean((first.mean_square - last.mean_square) / floor**2))
    names = max(removed, 0.0)
    # What bends a little in an equation whose numbers are far off is told beside them.
    little = e.leftover is not None and e.leftover.block in _EQUATIONS
    little = little and numbers.gap > _BY_FAR * (numbers.gap + names + left)
    only_numbers = numbers.are_wrong and not numbers.are_imitated and e.air is None and little
    unknown = e.leftover is not None and late is None and not only_numbers
    apart = tuple(c for c in (_air_cause(e), bias, late) if c is not None)
    outweighs = _speed_outweighs(e, max(numbers.gap, removed))
    told = (named or bias or late or numbers.are_wrong) and not outweighs
    judge_speed = speed_is_unasked if told else speed_is_a_cause
    if speed is not None and judge_speed(problem, e.constant_speed, last, still, e.air):
        apart = (speed, *apart)
    unexplained = e.leftover.share if e.leftover is not None else 0.0
    causes = tuple(
        with_doubt(cause, problem) for cause in causes_of(stages, floor, unexplained, problem.channels)
    )
    causes = _merge(causes, apart)
    if bias is not None and not unknown and not problem.flights.alpha_is_derived and _is_plain(bias, named):
        offset = (bias.parameters["bias_rad"].value / floor[problem.channels.index("alpha")]) ** 2
        if float(offset) / len(floor) > names:
            causes = _put_first(causes, bias)
    if speed is not None and speed in apart and outweighs:
        causes = _put_first(causes, speed)
    verdict: Verdict = "none"
    # An aircraft may bend a little besides: what makes the gap is the answer.
    mostly = not numbers.are_imitated and numbers.gap > _MOSTLY * (numbers.gap + names)
    wrong = numbers.are_wrong and numbers.outweigh_the_air and (mostly or not named)
    if unknown:
        verdict = "unknown"
    elif wrong and not (bias or late or speed in apart):
        verdict = "parameters"
    elif any(c.present for c in causes):
        verdict = "effect"
    if unknown:
        causes = tuple(replace(c, probability=_HALF * c.probability) for c in causes)
    if verdict in ("none", "parameters"):
        keeps = _BEHIND if named else _REFUTED
        causes = tuple(replace(c, probability=keeps * c.probability) for c in causes)
        causes = tuple(sorted(causes, key=lambda c: -c.probability))
    before = e.file_model if e.file_model is not None else first
    if e.constant_speed is not None and speed in apart:
        before = _at_constant_speed(problem, before, e.constant_speed, last)
    return Judgement(verdict, causes, apart, speed, bias, before, numbers.are_wrong)


def _is_plain(bias: Cause, named: Sequence[Judged]) -> bool:
    """Whether an offset is more than a mounting leaves, or nothing that the stick shows was named."""
    return not named or abs(bias.parameters["bias_rad"].value) > _MOUNTED_RAD


@dataclass(frozen=True)
class _Numbers:
    """What the file's derivatives do to the gap."""

    gap: float
    """What they leave beyond fitted ones, mean square over the floor's."""
    are_wrong: bool
    are_imitated: bool
    """What was named leaves the file right: that other numbers explain the gap, too, is a likeness."""
    outweigh_the_air: bool
    """Moving air comes with the day, wrong numbers stay; but the larger part of the gap is the answer."""


def _wrong_numbers(e: Evidence, named: Sequence[Judged], still: FloatArray) -> _Numbers:
    """``still`` is the floor without what the air does, shape (channels,)."""
    gap, beside_air = _beyond_fitted_numbers(e, e.floor), _beyond_fitted_numbers(e, still)
    of_the_air = whole_gap(e.stages[0].held_out.mean_square, still) if e.air is not None else 0.0
    # Fitted numbers bend to the air's motion, and take up a part of it.
    plainly = gap > PLAIN and beside_air > _FAR_MORE * of_the_air
    are_wrong = gap > VISIBLE and file_is_off(e.problem, e.stages[-1].fitted, plainly)
    told_by_file = any(judged.variant.twin is not None and judged.belief > 0.0 for judged in named)
    return _Numbers(gap, are_wrong, told_by_file or _need_no_numbers(e), beside_air > of_the_air)


def _beyond_fitted_numbers(e: Evidence, floor: FloatArray) -> float:
    """What the file's own derivatives leave beyond fitted ones, mean square over the floor's."""
    if e.file_model is None:
        return 0.0
    return float(np.mean((e.file_model.mean_square - e.stages[0].held_out.mean_square) / floor**2))


def _need_no_numbers(e: Evidence) -> bool:
    """Whether what was named explains the gap with the file's own derivatives, too.

    One name that does so is likelier than six wrong numbers that happen to imitate it.
    """
    if e.file_model is None or e.file_and_names is None:
        return False
    was, named, left = (
        whole_gap(h.mean_square, e.floor) for h in (e.file_model, e.file_and_names, e.stages[-1].held_out)
    )
    return was - named > _BY_NAMES * (was - left)


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


def _air_cause(e: Evidence) -> Cause | None:
    if e.air is None:
        return None
    reference = e.problem.flights.reference_m_s
    gust, stays = e.air.gust, without_air(e.stages[-1].held_out, e.air).mean_square
    left = whole_gap(stays, np.minimum(e.floor, np.sqrt(e.air.left)))
    peak, spread = e.air.gust_angle * reference, e.air.angle_std * reference
    parameters = {"sigma_w_m_s": Value(spread, _WAVES_DOUBT * spread)}
    if gust:
        parameters = {
            "amplitude_m_s": Value(peak, _AIR_DOUBT * abs(peak)),
            "at_s": Value(e.air.gust_at_s, _AIR_DOUBT_S),
        }
    name, other = ("gust", "turbulence") if gust else ("turbulence", "gust")
    return Cause(
        name, "air", 0.0, parameters, (other,), breaking(name, other), left, True,
    )  # fmt: skip
