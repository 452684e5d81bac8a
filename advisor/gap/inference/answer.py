"""The answer: a reader of the posterior. Sizes, numbers and sentences are those of the answer's own model."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.instruments.kinematics import KinematicCheck
from advisor.gap.alternative import Alternative, AlternativeEvidence, Column, Contribution
from advisor.gap.candidates.catalogue import variants_for
from advisor.gap.decision import CERTAIN, Decision
from advisor.gap.effects import EFFECTS
from advisor.gap.evidence.found import Evidence
from advisor.gap.fitting.holdout import HeldOut
from advisor.gap.fitting.measure import file_model_of, whole_gap
from advisor.gap.fitting.uncertainty import effective_samples
from advisor.gap.foresight.foresee import unseen_effects
from advisor.gap.inference.diagnose import Inference
from advisor.gap.inference.evidence import covariance_of
from advisor.gap.inference.explanation import Explanation, Row
from advisor.gap.inference.laws import sentence_of_law
from advisor.gap.inference.posterior import (
    NONE,
    PARAMETERS,
    Posterior,
    posterior_of,
    relabelled,
    stated_as,
)
from advisor.gap.records.floor import tolerance_of
from advisor.gap.result import Cause, Diagnosis, Gap, GapVerdict, Value, Where
from advisor.gap.search.indistinguishable import way_to_distinguish
from advisor.gap.search.score import addition
from advisor.gap.search.speed import at_constant_speed
from advisor.gap.search.stage import Stage as ModelStage
from advisor.gap.uncatalogued.airspeed_scale import airspeed_scale_of
from advisor.gap.uncatalogued.unexplained import Unexplained
from advisor.gap.uncatalogued.weight_check import WeightReading
from advisor.gap.verdict.answer import _improvements, _of_the_derivatives, _speed_is_known
from advisor.gap.verdict.causes import parameters_of, with_model_errors
from advisor.gap.verdict.holdout_numbers import as_read, on_holdout, over_maneuvers, with_offset, without_air
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
from advisor.gap.verdict.outside_fit import moving_air_of
from advisor.gap.verdict.statements import in_simulator
from advisor.gap.verdict.text import in_words, sentence_of

DECIDED = 0.6
"""Contract: least probability of an answer that is decided."""
MOST_CAUSES = 5
"""Words: most causes that are stated."""
_GAP_AT_5_PERCENT = 2.0
"""Contract: gap on held-out manoeuvres at which "no gap" has a probability of 5 % at most."""
_CREDIBLE = 0.05
"""Words: least probability of an effect that is listed as not told from the answer."""
_WORDS = {
    "prior": "how often each is right, before the flight is looked at",
    "fit": "fit to the manoeuvres",
    "numbers": "price of its numbers, and agreement with the aircraft file",
    "unseen": "loss on manoeuvres kept out of the fit",
    "model_error": "allowance for the error of every simulator",
    "residual": "residual that is left",
    "offset": "offset of the angle of attack by the flight path",
    "gap": "visible gap of the simulator as given",
    "rest": "other ways in which each may be true",
}
"""Words: parts of the log odds."""


def answer_of(
    found: Inference,
    aircraft: Aircraft,
    kinematics: KinematicCheck,
    holdout: int | None,
    known: Mapping[str, Mapping[str, float]],
    left_aside: tuple[str, ...],
    weight: WeightReading | None,
) -> tuple[Diagnosis, Evidence]:
    """Return the diagnosis that follows from the posterior, and the evidence that it is made from."""
    problem, floor = found.problem, found.floor
    plain = found.chosen[0]
    file_model = file_model_of(problem, plain.fitted)
    posterior = _none_means_no_gap(found.posteriors[0], file_model, floor, plain.held_out)
    answer = posterior.answer
    named = _named(found, answer)
    stages = _stages(found, named)
    air = found.sought_air.found if answer.kind == "air" else None
    law = posterior.explanation_of(answer) if answer.kind == "unknown" else None
    last = named[-1].fitted if named else plain.fitted
    e = Evidence(
        problem, stages, _unexplained(posterior, answer, law), air, floor, file_model, None,
        at_constant_speed(problem, last), airspeed_scale_of(problem, last),
        weight=weight, sought_air=found.sought_air, known=known, left_aside=left_aside,
    )  # fmt: skip
    return _diagnosed(found, posterior, e, aircraft, kinematics, holdout, named), e


def _none_means_no_gap(
    posterior: Posterior, file_model: HeldOut | None, floor: np.ndarray, plain: HeldOut
) -> Posterior:
    """Return the posterior in which "none" means that nothing is above the floor.

    A visible gap moves the probability of "none" to wrong numbers, as far as fitted derivatives remove the
    gap. The rest goes to the likeliest block of the unknown.
    """
    if file_model is None:
        return posterior
    gap, left = (whole_gap(held.mean_square, floor) for held in (file_model, plain))
    stays = 0.05 ** ((gap / _GAP_AT_5_PERCENT) ** 2)
    by_numbers = float(np.clip(1.0 - left / max(gap, 1e-12), 0.0, 1.0))
    blocks = [row.alternative for row in posterior.rows if row.alternative.kind == "unknown"]
    rows: list[Row] = []
    for row in posterior.rows:
        if row.alternative != NONE:
            rows.append(row)
            continue
        parts = [(NONE, stays), (PARAMETERS, (1.0 - stays) * by_numbers)]
        parts += [(blocks[0], (1.0 - stays) * (1.0 - by_numbers))] if blocks else []
        rows += [
            relabelled(replace(row, terms={**row.terms, "gap": float(np.log(part))}), name)
            for name, part in parts
            if part > 1e-300
        ]
    return posterior_of(rows)


def _named(found: Inference, answer: Alternative) -> tuple[Explanation, ...]:
    """Return the models of the effects that the answer names, one after another."""
    if answer.kind != "effect" or len(found.chosen) < 2 or found.chosen[1].name != answer.name:
        return ()
    return found.chosen[1:]


def _stages(found: Inference, named: Sequence[Explanation]) -> list[ModelStage]:
    """Return the plain model and the model of each named effect, each with the effect that is added next."""
    problem, plain = found.problem, found.chosen[0]
    models = [plain, *named]
    stages = []
    for before, after in zip(models, [*models[1:], None], strict=True):
        added = None
        if after is not None:
            effective = effective_samples(problem, after.fitted.innovations)
            added = addition(problem, before.fitted, before.held_out, after.fitted, after.name, effective)
        stages.append(ModelStage(before.fitted, before.held_out, (), added))
    return stages


def _unexplained(posterior: Posterior, answer: Alternative, law: Explanation | None) -> Unexplained | None:
    """Return the residual without a name, where that is the answer."""
    if answer.kind != "unknown":
        return None
    blocks = {a.block: p for a, p in posterior.by_alternative.items() if a.kind == "unknown"}
    total = sum(blocks.values())
    ranking = tuple((block, round(p / max(blocks.values()), 4)) for block, p in blocks.items())
    note = ""
    if law is not None and law.variant is not None and law.name not in EFFECTS:
        note = sentence_of_law(law.name, law.values)
    return Unexplained(answer.block, blocks[answer.block] / total, ranking, note=note)


def _diagnosed(
    found: Inference,
    posterior: Posterior,
    e: Evidence,
    aircraft: Aircraft,
    kinematics: KinematicCheck,
    holdout: int | None,
    named: Sequence[Explanation],
) -> Diagnosis:
    e, kept = on_holdout(e, holdout)
    problem, stages, answer = e.problem, e.stages, posterior.answer
    verdict: GapVerdict = "effect" if answer.is_effect else answer.kind  # type: ignore[assignment]
    before, last = e.file_model or stages[0].held_out, stages[-1].held_out
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
    causes = _causes(found, posterior, e, kinematics, gap, named)
    wrong = posterior.of(PARAMETERS) > posterior.of(NONE)
    shrink = shrink_of(e, kept, gap, before, last, wrong) if verdict in ("effect", "parameters") else None
    fitted = stages[-1].fitted
    own = (named[-1] if named else found.chosen[0]).problem
    known = covariance_of(own, fitted, found.heat)
    present = [c for c in causes if c.present]
    effects = _improvements(fitted, np.sqrt(np.maximum(np.diag(known), 0.0)), causes)
    nuisances = effects.keys() - {c.effect for c in present} if shrink is not None else ()
    where = _where(problem, posterior, e, gap, fitted, known, answer, present)
    outside = [c for c in present if c.block == "air" or c.effect == "alpha_bias"]
    doubt = _doubt(posterior)
    sentence = sentence_of(verdict, gap, where, causes, shrink, in_simulator(aircraft))
    rival = _rival(posterior)
    return Diagnosis(
        verdict=verdict,
        sentence=f"{doubt} {sentence}" if doubt else sentence,
        gap=gap, where=where, causes=causes, shrink=shrink,
        waterfall=waterfall_of(stages, e.floor, outside, None, gap.before),
        cannot_see=unseen_effects(
            problem, fitted, variants_for(problem.flights), e.floor, {c.effect for c in present}
        ),
        kinematics=kinematics, model=model_of(problem, fitted, known),
        reference_airspeed_m_s=problem.flights.reference_m_s if _speed_is_known(problem, aircraft) else None,
        effects=effects, share_irreducible=irreducible(with_air, e.floor, gap),
        decisions=tuple(_decisions(found, posterior, rival)),
        yardsticks=fidelity_of(problem, before, last), traces=traces_of(problem, before, last),
        derivatives=compared_derivatives(problem, fitted, known),
        notes=notes_of(e, aircraft, holdout, verdict, nuisances),
        maneuvers=tuple(f.number for f in problem.flights.flights),
        probabilities=posterior.probabilities,
        evidence=tuple(_evidence(posterior)),
        why=tuple(_why(posterior, rival)),
        rival=rival.label,
        doubt=doubt,
    )  # fmt: skip


def _causes(
    found: Inference,
    posterior: Posterior,
    e: Evidence,
    kinematics: KinematicCheck,
    gap: Gap,
    named: Sequence[Explanation],
) -> tuple[Cause, ...]:
    """Return the named causes in the order of the model, then the alternatives to the first, likeliest
    first."""
    answer = posterior.answer
    present: list[Cause] = []
    together = 1.0
    for stage, one in zip(found.posteriors, named, strict=False):
        told = posterior if stage is found.posteriors[0] else stage
        together *= told.of(stated_as(one.name))
        present.append(_cause(found, e, one, named[-1], told, together, True))
    if answer.kind == "air" and (air := moving_air_of(e)) is not None:
        present.append(replace(air, probability=posterior.of(answer)))
    if answer.name == "alpha_bias":
        present.append(_offset(kinematics, posterior, gap, True))
    taken = {c.effect for c in present}
    left = 1.0 - sum(c.probability for c in present)
    others: list[Cause] = []
    for alternative, p in posterior.by_alternative.items():
        if not alternative.is_effect or alternative.name in taken or len(others) + len(taken) >= MOST_CAUSES:
            continue
        one = posterior.explanation_of(alternative)
        p, left = min(p, left), left - min(p, left)
        if one.name == alternative.name:
            others.append(_cause(found, e, one, one, posterior, p, False))
        elif alternative.name == "alpha_bias":
            others.append(_offset(kinematics, posterior, gap, False))
    return (*present, *others)


def _cause(
    found: Inference,
    e: Evidence,
    one: Explanation,
    model: Explanation,
    posterior: Posterior,
    probability: float,
    present: bool,
) -> Cause:
    """Return an effect with its sizes in a model, whose posterior gives their errors."""
    point = model.fitted.point
    k = point.index_of(one.name)
    std = np.sqrt(np.maximum(np.diag(covariance_of(model.problem, model.fitted, found.heat)), 0.0))
    sizes = parameters_of(point.effects[k], np.asarray(point.values[k]), std[point.place(k)])
    alike, way = _not_told_from(one.name, posterior, e.problem.channels)
    gap_after = whole_gap(one.held_out.mean_square, e.floor)
    block = EFFECTS[one.name].block
    cause = Cause(one.name, block, probability, sizes, alike, way, gap_after, present)
    return with_model_errors(cause, found.problem)


def _offset(kinematics: KinematicCheck, posterior: Posterior, gap: Gap, present: bool) -> Cause:
    offset = kinematics.offset
    return Cause(
        "alpha_bias", "alpha_sensor", posterior.of(stated_as("alpha_bias")),
        {"bias_rad": Value(offset.rad, offset.std_rad)},
        ("an offset of the attitude's zero", "steady up- or downwash"),
        "level the attitude reference on the ground; fly in still air", gap.after, present,
    )  # fmt: skip


def _not_told_from(name: str, posterior: Posterior, channels: Sequence[str]) -> tuple[tuple[str, ...], str]:
    """Return the effects that the evidence does not exclude, and what would distinguish them."""
    names = [
        a.name
        for a, p in posterior.by_alternative.items()
        if a.is_effect and a.name != name and p >= _CREDIBLE
    ]
    ways = [way for other in names if (way := way_to_distinguish(name, other))]
    effect = EFFECTS[name]
    alike = [] if effect.imitated_by is None else [effect.imitated_by]
    if effect.imitated_without is not None and effect.imitated_without[0] not in channels:
        alike.append(effect.imitated_without[1:])
    for looks, way in alike:
        names.append(looks)
        ways.append(way)
    if names and not ways:
        ways.append("fly more manoeuvres, with another time unit and another amplitude")
    return tuple(names), "; ".join(dict.fromkeys(ways))


def _where(
    problem: object, posterior: Posterior, e: Evidence, gap: Gap, fitted: object, known: np.ndarray,
    answer: Alternative, present: Sequence[Cause],
) -> Where:  # fmt: skip
    """Return the block of the answer; blocks score by the probability of all that is in them."""
    if answer == PARAMETERS:
        return _of_the_derivatives(e.problem, fitted, known, gap)  # type: ignore[arg-type]
    if e.unexplained is not None:
        return Where(answer.block, e.unexplained.share, e.unexplained.ranking)
    scores: dict[str, float] = {}
    for a, p in posterior.by_alternative.items():
        if a.block:
            scores[a.block] = scores.get(a.block, 0.0) + p
    best = max([*scores.values(), 1e-12])
    ranking = tuple((b, round(s / best, 4)) for b, s in sorted(scores.items(), key=lambda i: -i[1]))
    block = present[0].block if present else (ranking[0][0] if ranking else "force_equation")
    removed = 1.0 - gap.after / max(gap.before, 1e-12)
    return Where(block, float(np.clip(removed, 0.0, 1.0)) if present else 0.0, ranking)


def _rival(posterior: Posterior) -> Alternative:
    """Return the likeliest alternative with another name than the answer."""
    name = posterior.answer.name
    return next(a for a in posterior.by_alternative if a.name != name)


def _together(posterior: Posterior, alternative: Alternative) -> float:
    """Return the probability of an alternative; all blocks of the unknown count together."""
    return sum(p for a, p in posterior.by_alternative.items() if a.name == alternative.name)


def _doubt(posterior: Posterior) -> str:
    """Return the sentence on the two likeliest answers; empty where one is decided."""
    answer, rival = posterior.answer, _rival(posterior)
    p, q = (100.0 * _together(posterior, one) for one in (answer, rival))
    if p >= 100.0 * DECIDED:
        return ""
    return f"Not decided between {in_words(answer)} ({p:.0f} %) and {in_words(rival)} ({q:.0f} %)."


def _evidence(posterior: Posterior) -> Iterator[AlternativeEvidence]:
    """Yield every alternative with the parts of its likeliest row."""
    for alternative, p in posterior.by_alternative.items():
        row = _best_row(posterior, alternative)
        columns = tuple(Column(n, value, "nats", _WORDS[n]) for n, value in row.terms.items())
        yield AlternativeEvidence(alternative, columns, p)


def _why(posterior: Posterior, rival: Alternative) -> Iterator[Contribution]:
    """Yield the parts of the log odds of the answer against its rival, the largest first; they add up."""
    mine, other = (_best_row(posterior, a) for a in (posterior.answer, rival))
    names = dict.fromkeys([*mine.terms, *other.terms])
    parts = {name: mine.terms.get(name, 0.0) - other.terms.get(name, 0.0) for name in names}
    parts["rest"] = _log_odds(posterior, rival) - sum(parts.values())
    for name, nats in sorted(parts.items(), key=lambda item: -abs(item[1])):
        yield Contribution(name, nats, _WORDS[name])


def _log_odds(posterior: Posterior, rival: Alternative) -> float:
    """Return the log odds of the answer against a rival, nats; all blocks of the unknown count together."""
    mine, other = (
        np.logaddexp.reduce([r.weight for r in posterior.rows if r.alternative.name == a.name])
        for a in (posterior.answer, rival)
    )
    return float(mine - other)


def _best_row(posterior: Posterior, alternative: Alternative) -> Row:
    return max((r for r in posterior.rows if r.alternative == alternative), key=lambda row: row.weight)


def _decisions(found: Inference, posterior: Posterior, rival: Alternative) -> Iterator[Decision]:
    """Yield every statistic that is compared with a limit on the way to the verdict."""
    label, odds = posterior.answer.name, _log_odds(posterior, rival)
    yield Decision(label, "odds", odds, 0.0, f"log odds against {in_words(rival)}, nats")
    yield Decision(label, "decided", _together(posterior, posterior.answer), DECIDED, "probability")
    if found.sought_air.found is not None:
        air = found.sought_air.found
        yield Decision("gust" if air.gust else "turbulence", "likelihood", air.gain, CERTAIN, "nats")
