"""Explanations of a flight along an axis: no gap, wrong derivatives, moving air, one effect, or two."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice
from typing import NamedTuple

import numpy as np

from advisor.gap.alternative import Alternative, AlternativeEvidence, Weighed
from advisor.gap.axis.effects import axis_effects, block_of, unseen
from advisor.gap.axis.evidence import colour_share, information_of, posterior_at, squares_of
from advisor.gap.axis.fit import Fit
from advisor.gap.axis.flight import AxisFlight, AxisModel
from advisor.gap.axis.gusts import coloured_likelihood
from advisor.gap.axis.laws import axis_laws, curves_of, lacking
from advisor.gap.axis.measure import measured, sums
from advisor.gap.axis.models import Case, base_of
from advisor.gap.axis.setting import moved_to
from advisor.gap.fitting.prior import ERROR_IF_RIGHT, ERROR_IF_WRONG
from advisor.gap.inference.engine import Decided, decided, first_stage
from advisor.gap.inference.explanation import Row
from advisor.gap.inference.offset import OFFSET, cause_of_offset, with_offset
from advisor.gap.inference.posterior import NONE, PARAMETERS, relabelled
from advisor.gap.inference.prior import FIELD, FieldPrior
from advisor.gap.result import Cause, Diagnosis, GapVerdict, Trace, Value, Where, ranked
from advisor.gap.search.air import NATURAL_GUST_ANGLE
from advisor.gap.verdict.causes import MOST_CAUSES, parameters_of
from advisor.gap.verdict.missing_law import law_in
from advisor.gap.verdict.reasons import capped, weighed
from advisor.gap.verdict.statements import what
from advisor.gap.verdict.text import place
from advisor.model.axis import Axis
from advisor.process.arrays import FloatArray


def diagnose_axis(case: Case, prior: FieldPrior = FIELD) -> Diagnosis | None:
    """Return the probabilities of all explanations; None if no plain fit exists.

    If one effect is the likeliest explanation, a second effect is sought in addition to the first.

    Parameters
    ----------
    prior : shares of the answers before the flight.
    """
    first = _first(case)
    plain = first and case.fit(first.point, first.free, share=colour_share(first))
    if plain is None:
        return None
    with_name = (curve for curve in case.axis.curves if curve.has_name)
    table = [*axis_effects(case.flown), *curves_of(case, plain, with_name)]
    flight = AxisFlight(case, plain, table, list(axis_laws(case, plain)))

    def beyond(rows: list[Row[AxisModel]]) -> list[Row[AxisModel]]:
        rows = [_named_air(case.axis, row) for row in rows]
        if case.kinematics is None:
            return rows
        computed = case.flown.problem.is_computed
        return with_offset(rows, case.kinematics.offset, computed, prior, flight.tried[0])

    decision = decided(flight, first_stage(flight), prior, beyond)
    decision = _capped(case, decision)
    weights, whole = weighed(decision.posteriors[0]), decision.chosen[-1]
    last, left = whole.fit, _held_out(case, whole, decision.heat)
    as_given = _as_given(case, decision.chosen)
    gap, shrink = measured(last, case.numbers, sums(last, as_given.residual**2), left)
    share = colour_share(last)
    # The whole model leaves less colour than the model before it.
    final = _Told.of(case, whole, share, case.fit(last.point, last.free, whole.tolerance, share))
    n = len(case.theta)
    values = map(Value, final.mean[:n].tolist(), final.std[:n].tolist())
    waterfall = _waterfall(case, decision)
    remains = dict(waterfall)
    causes = tuple(
        replace(cause, gap_after=remains.get(cause.name, np.nan))
        for cause in islice(_causes(case, decision, final, as_given), MOST_CAUSES)
    )
    verdict = verdict_of(weights)
    where = where_of(case.axis, weights.evidence, causes if verdict == "effect" else ())
    unnamed = where.block if verdict == "unknown" else ""
    return Diagnosis(
        **(vars(weights) | {"failed": decision.failed}), axis=case.axis.key, verdict=verdict,
        sentence=_sentence(verdict, where, causes), gap=gap, where=where, causes=causes,
        kinematics=case.kinematics,
        shrink=shrink if weights.answer == PARAMETERS or len(decision.chosen) > 1 else None,
        waterfall=waterfall, cannot_see=tuple(unseen(case.flown)),
        peaks={"simulator": peaks_of(as_given), "fitted_derivatives": peaks_of(plain)},
        model=dict(zip(case.axis.names.reported, values, strict=True)),
        missing_law=law_in(unnamed, lacking(case, plain, unnamed), decision.heat),
        maneuvers=tuple(case.numbers), traces=tuple(_traces(case.numbers, as_given, last)),
    )  # fmt: skip


def verdict_of(weights: Weighed) -> GapVerdict:
    """Return the kind of the likeliest alternative; moving air is an effect."""
    assert weights.answer is not None
    return "effect" if weights.answer.is_effect else weights.answer.kind  # type: ignore[return-value]


def where_of(axis: Axis, evidence: Sequence[AlternativeEvidence], causes: Sequence[Cause]) -> Where:
    """Return the block of the first cause, or of the likeliest law without a name; an empty block without
    both.

    Parameters
    ----------
    causes
        Effects of the answer, the first of them decisive; empty for an answer without an effect.
    """
    each = {a.block: e.probability for e in evidence if (a := e.alternative).kind == "unknown"}
    without = sum(each.values())
    shares = {block: p / without for block, p in each.items() if without > 0.0}
    if causes:
        first = {block_of(axis, causes[0].of): 1.0}
        shares = first | shares | first
    if not shares:
        return Where()
    ranking = ranked(shares)
    return Where(ranking[0][0], shares[ranking[0][0]], ranking)


def _sentence(verdict: GapVerdict, where: Where, causes: Sequence[Cause]) -> str:
    """Return the sentence about all effects of the model, or about the block of a law without a name."""
    if verdict == "unknown":
        return f"Something acts {place(where.block)} that no known effect explains."
    return ". ".join(cause.sentence for cause in causes if cause.present)


def _traces(numbers: Sequence[int], as_given: Fit, last: Fit) -> Iterator[Trace]:
    """Yield the curves of every output and manoeuvre: measured, of the simulator and of the final model."""
    laid = as_given.assembly
    for number, named in zip(numbers, laid.rows, strict=True):
        for name, rows in named.items():
            curves = (values[rows] for values in (laid.z, as_given.fitted, last.fitted))
            yield Trace(number, name, laid.t[rows], *curves)


def _first(case: Case) -> Fit | None:
    """Return the likelier of two fits without effects: from the flight's derivatives and from the file's.

    An effect that distorts the derivatives of the flight leads the first search into a local minimum.
    """
    prior = case.prior_of(ERROR_IF_WRONG, case.natural)
    starts = (case.begin, case.begin._replace(theta=case.theta))
    fits = [fit for fit in (case.fit(at, case.natural) for at in starts) if fit is not None]
    return max(fits, key=prior.height, default=None)


def _as_given(case: Case, chosen: Sequence[AxisModel]) -> Fit:
    """Return the simulator as given, with the natural numbers of telemetry that the last model finds.

    Fitted to the simulator's derivatives, a nuisance parameter would take on the effect that the simulator
    lacks.
    """
    last = chosen[-1].fit
    setting = last.point.setting
    for effect in (model.effect for model in chosen if model.effect is not None):
        setting = moved_to(setting, effect.places, base_of(case, effect))
    point = last.point._replace(theta=case.theta, setting=setting)
    return case.fit(point, (), ERROR_IF_RIGHT * 1e-3) or last


def _held_out(case: Case, model: AxisModel, heat: float) -> FloatArray:
    """Return the sums of squared errors (m, outputs) of a model on manoeuvres held out one by one.

    A manoeuvre that alone moves a control is not held out, because no other manoeuvre shows the control's
    derivatives. Its sums are NaN.
    """
    prior = case.prior_of(model.tolerance, model.fit.free)
    squares = squares_of(model.fit, information_of(model.fit, heat**-0.5), prior).held_out
    squares[~case.flown.foretold] = np.nan
    return squares


def _capped(case: Case, decided: Decided[AxisModel]) -> Decided[AxisModel]:
    """Return the posterior in which "no gap" is unlikely in the presence of a visible gap.

    Without a manoeuvre that can be held out, the posterior is unchanged.
    """
    plain, last, as_given = decided.chosen[0], decided.chosen[-1].fit, _as_given(case, decided.chosen)
    gap, _ = measured(
        last, case.numbers, sums(last, as_given.residual**2), _held_out(case, plain, decided.heat)
    )
    if np.isnan(gap.after):
        return decided
    first = capped(decided.posteriors[0], gap.before, gap.after if case.stated else gap.before)
    named = decided.chosen if any(model.alternative == first.answer for model in decided.chosen) else (plain,)
    return replace(decided, posteriors=(first, *decided.posteriors[1:]), chosen=named)


def air_of(axis: Axis) -> Alternative:
    """Return moving air as an answer."""
    return Alternative("air", axis.gust[1], "air")


def _named_air(axis: Axis, row: Row[AxisModel]) -> Row[AxisModel]:
    """Return the row with gusts as its answer, if the gusts alone exceed natural gusts."""
    gusts = row.explanation.gusts
    blown = row.alternative == NONE and gusts is not None and gusts.angle > NATURAL_GUST_ANGLE
    return relabelled(row, air_of(axis)) if blown else row


class _Told(NamedTuple):
    """Posterior of the derivatives and effect parameters of a model."""

    fit: Fit
    mean: FloatArray
    """Shape (s + k,)."""
    std: FloatArray
    """Shape (s + k,)."""

    @classmethod
    def of(cls, case: Case, model: AxisModel, share: float, fit: Fit | None = None) -> "_Told":
        """Return the posterior of a model at its fit, or at another ``fit``."""
        fit = fit or model.fit
        return cls(fit, *posterior_at(fit, case.prior_of(model.tolerance, fit.free), share))


def _causes(case: Case, decided: Decided[AxisModel], final: _Told, as_given: Fit) -> Iterator[Cause]:
    """Yield the effects of the model, then the alternatives to the first effect."""
    posterior, together, added = decided.posteriors[0], 1.0, decided.chosen[1:]
    for stage, model in zip(decided.posteriors, added, strict=False):
        assert model.alternative is not None
        together *= stage.of(model.alternative)
        yield _cause(case, model, final, together, present=True)
    taken = {model.alternative for model in added}
    others = {a: p for a, p in posterior.by_alternative.items() if a.is_effect and a not in taken}
    for alternative, probability in others.items():
        other = posterior.explanation_of(alternative)
        if alternative == OFFSET and case.kinematics is not None:
            yield cause_of_offset(case.kinematics, probability, np.nan, posterior.answer == OFFSET)
            continue
        if alternative == air_of(case.axis):
            yield _air(case, other, probability, posterior.answer == air_of(case.axis), as_given)
            continue
        yield _cause(case, other, _Told.of(case, other, decided.heat**-0.5), probability, present=False)


def _cause(case: Case, tried: AxisModel, final: _Told, probability: float, present: bool) -> Cause:
    """Return an effect as a cause, with its sizes from a posterior that includes the effect."""
    effect = tried.effect
    assert effect is not None
    variant, places = effect.variant, [f.place for f in final.fit.free]
    n = len(case.theta)
    at = [n + places.index(place) for place in effect.places]
    parameters = parameters_of(variant, final.mean[at] - base_of(case, effect), final.std[at])
    cause = Cause(
        variant.effect, variant.block, probability, parameters, (), "", np.nan, present,
        effect.of, effect.named, gain=tried.gain, peaks=peaks_of(final.fit),
    )  # fmt: skip
    return replace(cause, sentence=effect.said(what(cause)))


def _air(case: Case, model: AxisModel, probability: float, is_found: bool, as_given: Fit) -> Cause:
    """Return gusts as a cause of the gap."""
    assert model.gusts is not None
    speed = float(np.mean([np.mean(record.airspeed.y) for record in case.flown.problem.records]))
    size = Value(model.gusts.angle * speed, model.gusts.angle_std * speed)
    said = f"The air was not still: {case.axis.gust[0]} of about {size.value:.2g} m/s"
    gain = Value(model.gusts.likelihood - coloured_likelihood(model.fit), 0.0)
    return Cause(
        "turbulence", "air", probability, {case.axis.gust[2]: size}, (), "", np.nan, is_found,
        "air", case.axis.gust[0], said, gain, peaks_of(as_given),
    )  # fmt: skip


def _waterfall(case: Case, decided: Decided[AxisModel]) -> tuple[tuple[str, float], ...]:
    """Return the gap that remains after the addition of each effect, if a manoeuvre can be held out."""
    each = [(m.name, _held_out(case, m, decided.heat)) for m in decided.chosen[1:]]
    left = ((name, measured(decided.chosen[-1].fit, case.numbers, m, m)[0].after) for name, m in each)
    return tuple((name, gap) for name, gap in left if np.isfinite(gap))


def peaks_of(fit: Fit) -> Mapping[str, float]:
    """Return the largest errors of the angular rates in a fit, rad/s."""
    axis = fit.assembly.axis
    rates = [state for state in axis.letters.values() if state != axis.hidden]
    return {
        name: max(float(np.max(np.abs(fit.residual[rows[name]]))) for rows in fit.assembly.rows)
        for name in rates
    }
