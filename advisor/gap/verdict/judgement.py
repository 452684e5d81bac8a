"""The judgement of the evidence: the verdict and its causes, before the numbers of the gap."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.flight.instruments.kinematics import KinematicCheck
from advisor.gap.decision import Decision
from advisor.gap.evidence.found import Evidence
from advisor.gap.fitting.holdout import HeldOut, held_out
from advisor.gap.fitting.measure import whole_gap
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.result import Cause, GapVerdict
from advisor.gap.search.acceptance import JudgedAddition
from advisor.gap.search.speed import airspeed_cause, speed_costs, speed_is_a_cause, thrust_is_uncommanded
from advisor.gap.search.stage import added_in
from advisor.gap.verdict.causes import causes_of, with_model_errors
from advisor.gap.verdict.ledger import decisions_of
from advisor.gap.verdict.outside_fit import air_cause, alpha_bias_cause, beyond_file
from advisor.gap.verdict.wrong_derivatives import WrongDerivatives, wrong_derivatives

_MOSTLY = 0.98
"""Share of the gap from wrong derivatives above which they are the answer, whatever else is present. Other
derivatives imitate an effect by nine tenths at most, except for one that they imitate exactly."""


@dataclass(frozen=True)
class Judgement:
    """The verdict with its causes."""

    verdict: GapVerdict
    causes: tuple[Cause, ...]
    """Causes of the model, then alternatives to them; the probabilities are set later."""
    outside_fit: tuple[Cause, ...]
    """Causes that are judged outside the fits: moving air, offset of α, air speed."""
    speed: Cause | None
    """Variation of the air speed where ignoring it costs, whether or not it is a cause."""
    bias: Cause | None
    before: HeldOut
    """Residuals of the simulator as given."""
    wrong_derivatives: bool
    """Whether the file's derivatives are wrong, alone or in addition to other causes."""
    decisions: tuple[Decision, ...]
    """Statistics that were compared with limits; see ``ledger``."""


@dataclass(frozen=True)
class _Found:
    """Findings that speak for one verdict or another."""

    named: list[JudgedAddition]
    removed: float
    """Mean square that the named effects remove, relative to the floor's square."""
    derivatives: WrongDerivatives
    bias: Cause | None
    speed: Cause | None
    """Variation of the air speed where ignoring it costs; a cause only if it is in ``outside_fit``."""
    speed_outweighs: bool
    outside_fit: tuple[Cause, ...]
    unknown: bool
    """Whether an unexplained residual is the answer."""

    @property
    def names(self) -> float:
        """Mean square that the named effects explain, at least 0."""
        return max(self.removed, 0.0)


def judgement(e: Evidence, kinematics: KinematicCheck) -> Judgement:
    """Return the verdict and the causes that follow from the evidence."""
    found = _found(e, kinematics)
    causes = _ordered(e, found)
    verdict = _verdict(found, causes)
    before = e.file_model if e.file_model is not None else e.stages[0].held_out
    if e.constant_speed is not None and found.speed in found.outside_fit:
        before = _at_constant_speed(e.problem, before, e.constant_speed, e.stages[-1].held_out)
    return Judgement(
        verdict, causes, found.outside_fit, found.speed, found.bias, before,
        found.derivatives.are_wrong, decisions_of(e, found.derivatives),
    )  # fmt: skip


def _found(e: Evidence, kinematics: KinematicCheck) -> _Found:
    """Return all findings, and which of them are causes."""
    problem, floor = e.problem, e.floor
    first, last = e.stages[0].held_out, e.stages[-1].held_out
    final_gap, named = whole_gap(last.mean_square, floor), added_in(e.stages)
    removed = float(np.mean((first.mean_square - last.mean_square) / floor**2))
    # Moving air hides nothing from a simulator that knows its motion.
    still = floor if e.air is None else np.minimum(floor, np.sqrt(e.air.mean_square_beyond_air))
    derivatives = wrong_derivatives(e, named, still)
    alone = not (named or derivatives.are_wrong or e.unexplained)
    is_single = len(problem.flights) == 1
    bias = None if is_single else alpha_bias_cause(kinematics, named, problem, final_gap, alone)
    outside_fit = tuple(c for c in (air_cause(e), bias) if c is not None)
    speed = None
    if all(judged.effect != "airspeed_variation" for judged in named):
        speed = beyond_file(e, airspeed_cause(problem, e.constant_speed, last, floor))
    outweighs = _speed_outweighs(e, max(derivatives.gap, removed))
    is_explained = (named or bias or derivatives.are_wrong) and not outweighs
    judge_speed = thrust_is_uncommanded if is_explained else speed_is_a_cause
    if speed is not None and judge_speed(problem, e.constant_speed, last, still, e.air):
        outside_fit = (speed, *outside_fit)
    return _Found(named, removed, derivatives, bias, speed, outweighs, outside_fit, e.unexplained is not None)


def _ordered(e: Evidence, found: _Found) -> tuple[Cause, ...]:
    """Return fitted causes and those outside the fits, the largest part of the gap first."""
    channels = e.problem.channels
    fitted = [with_model_errors(c, e.problem) for c in causes_of(e.stages, e.floor, channels)]
    named = {c.effect for c in found.outside_fit}
    present = [c for c in fitted if c.present]
    others = [c for c in fitted if not c.present and c.effect not in named]
    causes = (*present, *found.outside_fit, *others)
    bias, speed = found.bias, found.speed
    derived = e.problem.flights.alpha_is_derived
    if bias is not None and not found.unknown and not derived and not found.named:
        offset = (bias.parameters["bias_rad"].value / e.floor[channels.index("alpha")]) ** 2
        if float(offset) / len(e.floor) > found.names:
            causes = _with_first(causes, bias)
    if speed is not None and speed in found.outside_fit and found.speed_outweighs:
        causes = _with_first(causes, speed)
    return causes


def _verdict(found: _Found, causes: Sequence[Cause]) -> GapVerdict:
    """Return the verdict: the larger part of the gap decides, because every aircraft is slightly
    nonlinear."""
    derivatives = found.derivatives
    mostly = not derivatives.are_imitated and derivatives.gap > _MOSTLY * (derivatives.gap + found.names)
    wrong = derivatives.are_wrong and derivatives.outweigh_the_air and (mostly or not found.named)
    if found.unknown:
        return "unknown"
    if wrong and not (found.bias or found.speed in found.outside_fit):
        return "parameters"
    return "effect" if any(c.present for c in causes) else "none"


def _at_constant_speed(problem: EffectProblem, before: HeldOut, constant: HeldOut, last: HeldOut) -> HeldOut:
    """Return the residuals of a simulator that knows neither the named effects nor the air speed: both
    errors."""
    errors = zip(before.residuals, constant.residuals, last.residuals, strict=True)
    return held_out(problem, [of_model + at_constant - of_last for of_model, at_constant, of_last in errors])


def _speed_outweighs(e: Evidence, others: float) -> bool:
    """Return whether an unmeasured air speed costs a simulator more than wrong derivatives or named effects
    do."""
    if e.problem.flights.speed_measured or e.constant_speed is None:
        return False
    return speed_costs(e.constant_speed, e.stages[-1].held_out, e.floor) > others


def _with_first(causes: tuple[Cause, ...], first: Cause) -> tuple[Cause, ...]:
    """Return the causes with the one that makes the larger part of the gap ahead of all others."""
    return tuple(sorted(causes, key=lambda c: c.effect != first.effect))
