"""From the evidence to the diagnosis: verdict, causes, numbers and sentence."""

from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.instruments.kinematics import KinematicCheck
from advisor.flight.signals.messages import FloatArray
from advisor.gap.candidates.catalogue import variants_for
from advisor.gap.candidates.known import AIR
from advisor.gap.candidates.nuisances import PROPELLER
from advisor.gap.decision import LEAST_SIGMA
from advisor.gap.evidence.found import Evidence
from advisor.gap.evidence.measured import measured
from advisor.gap.evidence.rows import rows_of, stated_as
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.measure import whole_gap
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.fitting.uncertainty import covariance, effective_samples
from advisor.gap.foresight.foresee import unseen_effects
from advisor.gap.judge.posterior import posterior
from advisor.gap.judge.prior import FIELD, FieldPrior
from advisor.gap.records.floor import tolerance_of
from advisor.gap.result import Cause, Diagnosis, Gap, GapVerdict, Where
from advisor.gap.search.air import SoughtAir
from advisor.gap.simulator.layout import DERIVATIVES
from advisor.gap.verdict.as_judged import answered, as_judged
from advisor.gap.verdict.causes import block_ranking
from advisor.gap.verdict.holdout_numbers import as_read, on_holdout, over_maneuvers, with_offset, without_air
from advisor.gap.verdict.judgement import judgement
from advisor.gap.verdict.notes import notes_of
from advisor.gap.verdict.numbers import (
    compared_derivatives,
    fidelity_of,
    gap_numbers,
    irreducible,
    model_of,
    shrink_of,
    traces_of,
    waterfall_of,
)
from advisor.gap.verdict.outside_fit import air_cause
from advisor.gap.verdict.statements import in_simulator
from advisor.gap.verdict.text import sentence_of, sentence_of_one_maneuver


def answer(
    e: Evidence,
    aircraft: Aircraft,
    kinematics: KinematicCheck,
    holdout: int | None,
    prior: FieldPrior = FIELD,
) -> Diagnosis:
    """Return the diagnosis that follows from the evidence, at a field prior of the answers."""
    examined = e
    e, kept = on_holdout(e, holdout)
    problem, stages = e.problem, e.stages
    judged = judgement(e, kinematics)
    verdict, causes = judged.verdict, judged.causes
    before, last = judged.before, stages[-1].held_out
    if judged.bias is not None:
        offset_rad = judged.bias.parameters["bias_rad"].value
        before = with_offset(problem, before, offset_rad)
        problem = as_read(problem, offset_rad)
    before = over_maneuvers(problem, before, kept)
    with_air = last.mean_square
    if e.air is not None:
        # Moving air counts as a cause here, so the floor is the instruments' noise alone.
        least = np.maximum(e.air.instruments, tolerance_of(problem.flights))
        last, e = without_air(last, e.air), replace(e, floor=np.minimum(e.floor, least))
    gap = gap_numbers(problem, e.floor, before, last)
    gap = replace(gap, by_air=whole_gap(with_air, e.floor) - gap.after)
    shrink = None
    if verdict in ("effect", "parameters"):
        shrink = shrink_of(e, kept, gap, before, last, judged.wrong_derivatives)
    fitted = stages[-1].fitted
    known = covariance(problem, fitted, effective_samples(problem, fitted.innovations))
    where = (
        of_the_derivatives(problem, fitted, known, gap)
        if verdict == "parameters"
        else _where(e, verdict, causes)
    )
    waterfall = waterfall_of(stages, e.floor, judged.outside_fit, judged.speed, gap.before)
    present = {c.effect for c in causes if c.present}
    effects = improvements(fitted, np.sqrt(np.maximum(np.diag(known), 0.0)), causes)
    nuisances = effects.keys() - present if shrink is not None else ()
    is_single = len(problem.flights) == 1 and verdict == "unknown"
    sentence = sentence_of(verdict, gap, where, causes, shrink, in_simulator(aircraft))
    diagnosis = Diagnosis(
        verdict=verdict,
        sentence=sentence_of_one_maneuver(where) if is_single else sentence,
        gap=gap, where=where,
        causes=causes, shrink=shrink, waterfall=waterfall,
        cannot_see=unseen_effects(problem, fitted, variants_for(problem.flights), e.floor, present),
        kinematics=kinematics, model=model_of(problem, fitted, known),
        reference_airspeed_m_s=problem.flights.reference_m_s if speed_is_known(problem, aircraft) else None,
        effects=effects, share_irreducible=irreducible(with_air, e.floor, gap), decisions=judged.decisions,
        yardsticks=fidelity_of(problem, before, last), traces=traces_of(problem, before, last),
        derivatives=compared_derivatives(problem, fitted, known),
        notes=notes_of(e, aircraft, holdout, verdict, nuisances),
        maneuvers=tuple(f.number for f in problem.flights.flights),
    )  # fmt: skip
    if len(problem.flights) == 1:
        # A single manoeuvre proves no cause, and the judge was fitted on none.
        return diagnosis
    if not examined.known.keys().isdisjoint(AIR) and air_cause(examined) is None:
        examined = replace(examined, sought_air=SoughtAir())
    found = measured(examined, kinematics)
    sets = [stated_as(*names) for names in found.sets]
    return as_judged(diagnosis, posterior(rows_of(found, answered(diagnosis, sets)), prior))


def speed_is_known(problem: EffectProblem, aircraft: Aircraft) -> bool:
    """Return whether the air speed of the derivatives was measured, stated in the file, or derived from the
    motion."""
    return problem.flights.speed_measured or aircraft.stated_airspeed_m_s is not None


def improvements(
    fitted: EffectFit, std: FloatArray, causes: tuple[Cause, ...]
) -> dict[str, dict[str, float]]:
    """Return the effects of the improved simulator: the named ones, and the propeller's terms where
    significant."""
    effects = {c.effect: {k: v.value for k, v in c.parameters.items()} for c in causes if c.present}
    point = fitted.point
    if PROPELLER in point.effects:
        k = point.effects.index(PROPELLER)
        if np.any(np.abs(point.values[k]) > LEAST_SIGMA * std[point.place(k)]):
            thrust = effects.setdefault("thrust_moment", {})
            thrust.update(zip(PROPELLER.names, map(float, point.values[k]), strict=True))
    return effects


def _where(e: Evidence, verdict: GapVerdict, causes: tuple[Cause, ...]) -> Where:
    if verdict == "unknown" and e.unexplained is not None:
        return Where(e.unexplained.block, e.unexplained.share, e.unexplained.ranking)
    ranking = block_ranking(e.stages[0], causes)
    total = max(whole_gap(e.stages[0].held_out.mean_square, e.floor), 1e-12)
    remaining = whole_gap(e.stages[-1].held_out.mean_square, e.floor)
    block = next((c.block for c in causes if c.present), ranking[0][0] if ranking else "force_equation")
    return Where(block, float(np.clip(1.0 - remaining / total, 0.0, 1.0)) if causes else 0.0, ranking)


def of_the_derivatives(problem: EffectProblem, fitted: EffectFit, known: FloatArray, gap: Gap) -> Where:
    """Return the equation whose derivatives in the aircraft file are further off, relative to their
    uncertainty."""
    assert problem.prior_derivatives is not None
    off = fitted.point.derivatives - problem.prior_derivatives
    scores = {}
    for block, letter in (("force_equation", "Z"), ("moment_equation", "M")):
        its = [k for k, name in enumerate(DERIVATIVES) if name.startswith(letter)]
        scores[block] = float(off[its] @ np.linalg.pinv(known[np.ix_(its, its)], hermitian=True) @ off[its])
    best = max(*scores.values(), 1e-12)
    ranking = sorted(((b, round(s / best, 4)) for b, s in scores.items()), key=lambda item: -item[1])
    removed = 1.0 - gap.after / max(gap.before, 1e-12)
    return Where(ranking[0][0], float(np.clip(removed, 0.0, 1.0)), tuple(ranking))
