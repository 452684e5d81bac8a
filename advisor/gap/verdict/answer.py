"""Answer of a diagnosis, made from the posterior. Sizes, derivatives and sentences are those of the answer's
own model."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.instruments.kinematics import KinematicCheck
from advisor.gap.alternative import Alternative
from advisor.gap.candidates.known import PROPELLER, variants_for
from advisor.gap.decision import CERTAIN, Decision, differs_from_zero
from advisor.gap.effects import EFFECTS
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.holdout import sole_informative_maneuver
from advisor.gap.fitting.measure import file_model_of, whole_gap
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.fitting.uncertainty import covariance_of
from advisor.gap.foresight.foresee import unseen_effects
from advisor.gap.inference.diagnose import Inference
from advisor.gap.inference.findings import Added, Circumstances, Findings, Model, Unexplained
from advisor.gap.inference.laws import sentence_of_law
from advisor.gap.inference.pitch import PitchModel
from advisor.gap.inference.posterior import NONE, PARAMETERS, Posterior, stated_as
from advisor.gap.records.floor import tolerance_of
from advisor.gap.result import Cause, Diagnosis, Gap, GapVerdict, Where, ranked
from advisor.gap.search.air import SoughtAir
from advisor.gap.simulator.layout import DERIVATIVES
from advisor.gap.uncatalogued.weight_check import airspeed_excess, airspeed_scale_of
from advisor.gap.verdict.causes import causes_of
from advisor.gap.verdict.holdout_numbers import (
    as_measured,
    as_read,
    at_constant_speed,
    on_holdout,
    over_maneuvers,
    with_offset,
    without_air,
)
from advisor.gap.verdict.missing_law import lacking, law_in
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
from advisor.gap.verdict.reasons import capped, weighed
from advisor.gap.verdict.statements import in_simulator
from advisor.gap.verdict.text import answers_of, sentence_of
from advisor.process.arrays import FloatArray
from advisor.words.certainty import as_sure


def answer_of(
    inference: Inference,
    aircraft: Aircraft,
    kinematics: KinematicCheck,
    holdout: int | None,
    circumstances: Circumstances,
    most: int | None = None,
    seen: EffectProblem | None = None,
) -> tuple[Diagnosis, Findings]:
    """Return the diagnosis that follows from the posterior, and the findings behind it.

    Parameters
    ----------
    most
        Number of the answer's first effects in the improved simulator; None for all effects.
    seen
        Flight to which the answer's model is refitted if that is likelier; None for no other flight.
    """
    problem, floor = inference.problem, inference.floor
    plain = inference.chosen[0]
    file_model = file_model_of(problem, plain.fitted)
    given = file_model or plain.held_out
    gaps = (whole_gap(held.mean_square, floor) for held in (given, plain.held_out))
    posterior = capped(inference.posteriors[0], *gaps)
    answer = posterior.answer
    named = _named(inference, answer)[:most]
    if seen is not None:
        *before, own = inference.chosen[: len(named) + 1]
        inference = replace(inference, chosen=(*before, own.seen_in(seen)))
        named = inference.chosen[1:]
    explanation = posterior.explanation_of(answer)
    law = explanation if answer.kind == "unknown" else None
    last = named[-1].fitted if named else plain.fitted
    e = Findings(
        problem, _models(inference, named), _unexplained(posterior, answer, law),
        inference.sought_air.found if answer.kind == "air" else None,
        floor, file_model, at_constant_speed(problem, last), airspeed_scale_of(problem, last),
        circumstances, explanation.problem if explanation.taken_out and answer.kind == "effect" else None,
    )  # fmt: skip
    return _diagnosed(inference, posterior, e, aircraft, kinematics, holdout, named), e


def _named(inference: Inference, answer: Alternative) -> tuple[PitchModel, ...]:
    """Return the models of the answer's effects, in the order of addition."""
    if answer.kind != "effect" or len(inference.chosen) < 2 or inference.chosen[1].name != answer.name:
        return ()
    return inference.chosen[1:]


def _models(inference: Inference, named: Sequence[PitchModel]) -> tuple[Model, ...]:
    """Return the plain model and the model of each named effect, each with the following effect."""
    explanations = [inference.chosen[0], *named]
    models = [
        Model(m.fitted, m.held_out, None if following is None else _added(following), m.problem.flights)
        for m, following in zip(explanations, [*explanations[1:], None], strict=True)
    ]
    return as_measured(inference.problem, models)


def _added(model: PitchModel) -> Added:
    """Return the effect of an explanation, with the manoeuvre that alone determines it, if any."""
    assert model.variant is not None
    place = model.fitted.point.place(model.fitted.point.index_of(model.name)).start
    return Added(model.name, sole_informative_maneuver(model.fitted, place) if model.variant.needs else None)


def _unexplained(
    posterior: Posterior[PitchModel], answer: Alternative, law: PitchModel | None
) -> Unexplained | None:
    """Return the block and the share of a law without a name; None for another answer."""
    if answer.kind != "unknown":
        return None
    blocks = {a.block: p for a, p in posterior.by_alternative.items() if a.kind == "unknown"}
    total = sum(blocks.values())
    note = ""
    if law is not None and law.variant is not None and law.name not in EFFECTS:
        note = sentence_of_law(law.name, law.values)
    return Unexplained(answer.block, blocks[answer.block] / total, ranked(blocks), note=note)


def _diagnosed(
    inference: Inference,
    posterior: Posterior[PitchModel],
    e: Findings,
    aircraft: Aircraft,
    kinematics: KinematicCheck,
    holdout: int | None,
    named: Sequence[PitchModel],
) -> Diagnosis:
    e, kept = on_holdout(e, holdout)
    problem, answer = e.problem, posterior.answer
    verdict: GapVerdict = "effect" if answer.is_effect else answer.kind  # type: ignore[assignment]
    before, last = e.file_model or e.models[0].held_out, e.last.held_out
    bias = stated_as("alpha_bias") == answer
    if bias:
        before = with_offset(problem, before, kinematics.offset.rad)
        problem = as_read(problem, kinematics.offset.rad)
    before = over_maneuvers(problem, before, kept)
    with_air = last.mean_square
    if e.air is not None:
        # Moving air counts as a cause here, so the floor is the instruments' noise alone.
        least = np.maximum(e.air.instruments, tolerance_of(problem.flights))
        last, e = without_air(last, e.air), replace(e, floor=np.minimum(e.floor, least))
    gap = gap_numbers(problem, e.floor, before, last)
    gap = replace(gap, by_air=whole_gap(with_air, e.floor) - gap.after)
    causes = causes_of(inference, posterior, e, kinematics, gap, named)
    wrong = posterior.of(PARAMETERS) > posterior.of(NONE)
    shrink = shrink_of(e, kept, gap, before, last, wrong) if verdict in ("effect", "parameters") else None
    fitted = e.last.fitted
    own = (named[-1] if named else inference.chosen[0]).problem
    cov = covariance_of(own, fitted, inference.heat)
    present = [c for c in causes if c.present]
    effects = _improvements(fitted, np.sqrt(np.maximum(np.diag(cov), 0.0)), causes)
    nuisances = effects.keys() - {c.effect for c in present} if shrink is not None else ()
    where = _where(posterior, e, gap, cov, present)
    outside = [c for c in present if c.block == "air" or c.effect == "alpha_bias"]
    basis = weighed(posterior)
    sentence = sentence_of(verdict, gap, where, causes, shrink, in_simulator(aircraft))
    unnamed = where.block if verdict == "unknown" else ""
    return Diagnosis(
        verdict=verdict,
        sentence=as_sure(sentence, answers_of(basis.evidence)),
        gap=gap, where=where, causes=causes, shrink=shrink,
        waterfall=waterfall_of(e.models, e.floor, outside, gap.before),
        cannot_see=unseen_effects(
            problem, fitted, variants_for(problem.flights), e.floor, {c.effect for c in present}
        ),
        kinematics=kinematics, model=model_of(problem, fitted, cov),
        reference_airspeed_m_s=problem.flights.reference_m_s if speed_is_known(problem, aircraft) else None,
        airspeed_excess=airspeed_excess(fitted), effects=effects,
        share_irreducible=irreducible(with_air, e.floor, gap),
        decisions=(*basis.decisions, *_of_the_air(inference.sought_air)),
        yardsticks=fidelity_of(problem, before, last), traces=traces_of(problem, before, last),
        derivatives=compared_derivatives(problem, fitted, cov),
        missing_law=law_in(unnamed, lacking(problem, fitted, unnamed), inference.heat),
        notes=notes_of(e, aircraft, holdout, verdict, nuisances),
        maneuvers=tuple(f.number for f in problem.flights.flights),
        evidence=basis.evidence, failed=inference.failed, why=basis.why, rival=basis.rival, answer=answer,
    )  # fmt: skip


def _of_the_air(sought: SoughtAir) -> Iterator[Decision]:
    if sought.found is not None:
        name = "gust" if sought.found.gust else "turbulence"
        yield Decision(name, "likelihood", sought.found.gain, CERTAIN, "nats")


def _where(
    posterior: Posterior[PitchModel], e: Findings, gap: Gap, cov: FloatArray, present: Sequence[Cause]
) -> Where:
    """Return the block of the answer; a block's score is the probability of all causes in it."""
    if posterior.answer == PARAMETERS:
        return _of_the_derivatives(e.problem, e.last.fitted, cov, gap)
    if e.unexplained is not None:
        return Where(e.unexplained.block, e.unexplained.share, e.unexplained.ranking)
    scores: dict[str, float] = {}
    for a, p in posterior.by_alternative.items():
        if a.block:
            scores[a.block] = scores.get(a.block, 0.0) + p
    ranking = ranked(scores)
    block = present[0].block if present else (ranking[0][0] if ranking else "force_equation")
    removed = 1.0 - gap.after / max(gap.before, 1e-12)
    return Where(block, float(np.clip(removed, 0.0, 1.0)) if present else 0.0, ranking)


def speed_is_known(problem: EffectProblem, aircraft: Aircraft) -> bool:
    """Return whether the air speed of the derivatives was measured, stated in the file, or derived from the
    motion."""
    return problem.flights.speed_measured or aircraft.stated_airspeed_m_s is not None


def _improvements(
    fitted: EffectFit, std: FloatArray, causes: tuple[Cause, ...]
) -> dict[str, dict[str, float]]:
    """Return the improved simulator's effects: the named ones, and significant propeller terms."""
    effects = {c.effect: {k: v.value for k, v in c.parameters.items()} for c in causes if c.present}
    point = fitted.point
    if PROPELLER in point.effects:
        k = point.effects.index(PROPELLER)
        if any(map(differs_from_zero, point.values[k], std[point.place(k)])):
            thrust = effects.setdefault("thrust_moment", {})
            thrust.update(zip(PROPELLER.names, map(float, point.values[k]), strict=True))
    return effects


def _of_the_derivatives(problem: EffectProblem, fitted: EffectFit, cov: FloatArray, gap: Gap) -> Where:
    """Return the equation whose file derivatives deviate most, relative to their uncertainty."""
    assert problem.prior_derivatives is not None
    off = fitted.point.derivatives - problem.prior_derivatives
    scores = {}
    for block, letter in (("force_equation", "Z"), ("moment_equation", "M")):
        its = [k for k, name in enumerate(DERIVATIVES) if name.startswith(letter)]
        scores[block] = float(off[its] @ np.linalg.pinv(cov[np.ix_(its, its)], hermitian=True) @ off[its])
    removed = 1.0 - gap.after / max(gap.before, 1e-12)
    return Where(ranked(scores)[0][0], float(np.clip(removed, 0.0, 1.0)), ranked(scores))
