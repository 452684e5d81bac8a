"""The gap in the user's own simulator: the effects are added, and it flies the manoeuvres again."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.diagnose import DiagnosisEvidence
from advisor.gap.fitting.holdout import HeldOut, held_out, points_without
from advisor.gap.fitting.measure import own_refitted, whole_gap
from advisor.gap.fitting.problem import EffectProblem, SearchPoint
from advisor.gap.records.flights import Measured
from advisor.gap.result import InSimulator
from advisor.gap.simulator.layout import DERIVATIVES, INDEX, OUTPUTS
from advisor.gap.verdict.holdout_numbers import kept_and_folds, over_maneuvers, with_offset
from advisor.simulators.flying import AsGiven, Flying, added, beyond, without_servo
from advisor.simulators.inputs import at_reference
from advisor.simulators.qualification import qualified
from advisor.simulators.surrogate import Surrogate
from advisor.words.problems import UnusableInputError

DERIVATIVES_OF_IT, SERVO_OF_IT = "derivatives", "its own servo"
EQUATIONS = ("force_equation", "moment_equation")
"""Blocks whose effects are added inside a simulator, as increments."""


@dataclass(frozen=True)
class CarriedPart:
    """The part of a model that the simulator can take."""

    point: SearchPoint
    on_paper: tuple[str, ...]


def in_simulator(
    examined: DiagnosisEvidence,
    flying: Flying,
    surrogate: Surrogate,
    as_flown: Mapping[int, AsGiven],
    holdout: int | None,
) -> InSimulator:
    """Measure the gap in the simulator as given, and with the effects added to it.

    Parameters
    ----------
    examined
        Diagnosis of the manoeuvres, with the simulator's difference to its surrogate subtracted.
    flying
        The simulator with the manoeuvres.
    surrogate
        Linear surrogate of the simulator.
    as_flown
        Manoeuvre number to the manoeuvre as flown by the simulator.
    holdout
        Argument of ``advisor.gap.diagnose.diagnose``.
    """
    diagnosis, e = examined.diagnosis, examined.evidence
    problem, last = e.problem, e.stages[-1]
    kept, folds = kept_and_folds(problem, holdout)
    floor = np.array([diagnosis.gap.floor[c] for c in problem.channels])
    as_given = np.array([surrogate.derivatives[name] for name in DERIVATIVES])
    first = e.stages[0].fitted
    before = own_refitted(problem, replace(first.point, derivatives=as_given), first.noise)
    if "alpha_bias" in diagnosis.effects:
        before = with_offset(problem, before, diagnosis.effects["alpha_bias"]["bias_rad"])
    before = over_maneuvers(problem, before, kept)
    was = whole_gap(before.mean_square, floor)
    measured = replace(flying, flights=problem.flights)
    given = [as_flown[f.number] for f in problem.flights.flights]
    original = _with(problem, [one.beyond for one in given], 1.0)
    name = flying.simulator.description
    if diagnosis.shrink is None:
        table = qualified(original, before, None, kept)
        return InSimulator(name, was, None, None, (), table)
    parts = [_carried(p, problem, surrogate, flying) for p in points_without(problem, last.fitted, folds)]
    began = [at_reference(one.flight, problem.flights.reference_m_s) for one in given]
    found = _found(problem, [part.point for part in parts])
    increments = added(began, found, as_given) if flying.simulator.takes_increments else None
    try:
        replays = measured.replays(without_servo(found, surrogate), problem.held, increments)
    except UnusableInputError as error:
        # The diagnosis stands, even if the simulator does not fly with the effects.
        table = qualified(original, before, None, kept)
        return InSimulator(name, was, None, None, parts[0].on_paper, table, str(error.problem))
    grids = beyond(measured, replays, found, problem.held)
    now_problem = _with(original, grids, -1.0)
    residuals: list[FloatArray] = [np.empty(0)] * len(problem.flights)
    for fold in folds:
        refitted = own_refitted(now_problem, parts[fold[0]].point, last.fitted.noise) if fold else None
        for i in fold:
            assert refitted is not None
            residuals[i] = refitted.residuals[i]
    after = over_maneuvers(problem, held_out(problem, residuals), kept)
    after = _without_the_air(examined, after)
    now = whole_gap(after.mean_square, floor)
    percent = 100.0 * (1.0 - now / was) if was > 1e-9 else 0.0
    return InSimulator(name, was, now, percent, parts[0].on_paper, qualified(original, before, after, kept))


def _carried(point: SearchPoint, problem: EffectProblem, surrogate: Surrogate, flying: Flying) -> CarriedPart:
    """Return a model without the parts that the simulator cannot take, and the names of those parts."""
    on_paper: list[str] = []
    if not flying.simulator.takes_increments:
        derivatives = np.array([surrogate.derivatives[name] for name in DERIVATIVES])
        outside = [v.effect for v in point.effects if v.block in EQUATIONS and not v.is_nuisance]
        inside = [v.effect for v in point.effects if v.effect not in outside]
        point = replace(point.with_only(inside), derivatives=derivatives)
        on_paper += [*outside, DERIVATIVES_OF_IT]
    base = np.atleast_2d(problem.base)[0]
    values = list(point.values)
    for k, effect in enumerate(point.effects):
        for name, own in (("lag_s", surrogate.lag_s), ("delay_s", surrogate.delay_s)):
            if effect.block == "input" and name in effect.names:
                at = effect.names.index(name)
                least = own - float(base[INDEX[name]])
                if values[k][at] < least:
                    values[k] = np.where(np.arange(len(values[k])) == at, least, values[k])
                    on_paper.append(SERVO_OF_IT)
    return CarriedPart(replace(point, values=tuple(values)), tuple(dict.fromkeys(on_paper)))


def _found(problem: EffectProblem, points: Sequence[SearchPoint]) -> FloatArray:
    """Return each manoeuvre's model with the effects, without initial states, shape (manoeuvres, entries)."""
    still = np.zeros_like(points[0].own)
    rows = [problem.driving(replace(_named(point), own=still))[i] for i, point in enumerate(points)]
    return np.array(rows)


def _named(point: SearchPoint) -> SearchPoint:
    """Return the model without nuisance parameters, which belong to the flight instead of the simulator."""
    keep = [k for k, effect in enumerate(point.effects) if not effect.is_nuisance]
    return replace(
        point,
        effects=tuple(point.effects[k] for k in keep),
        values=tuple(point.values[k] for k in keep),
    )


def _with(problem: EffectProblem, grids: Sequence[FloatArray], sign: float) -> EffectProblem:
    """Return the problem with series on the grid, times ``sign``, added to the measurements."""
    flights = []
    for flight, grid in zip(problem.flights.flights, grids, strict=True):
        t = np.arange(grid.shape[1]) * flight.h
        outputs = {
            name: Measured(out.t, out.y + sign * np.interp(out.t, t, grid[OUTPUTS.index(name)]))
            for name, out in flight.outputs.items()
        }
        flights.append(replace(flight, outputs=outputs))
    return replace(problem, flights=replace(problem.flights, flights=tuple(flights)))


def _without_the_air(examined: DiagnosisEvidence, after: HeldOut) -> HeldOut:
    """Return the errors without the share that the air's likeliest course removes from the model's."""
    air, last = examined.evidence.air, examined.evidence.stages[-1].held_out
    if air is None:
        return after
    share = np.minimum(air.mean_square_beyond_air / last.mean_square, 1.0)
    return replace(after, mean_square=after.mean_square * share, by_maneuver=after.by_maneuver * share)
