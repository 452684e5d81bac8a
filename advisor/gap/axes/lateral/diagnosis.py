"""Explanations of a lateral flight: no gap, wrong derivatives, side gusts, one effect, or two effects."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from statistics import fmean
from typing import Literal

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.alternative import Alternative, Weighed
from advisor.gap.axes.lateral.effects import block_of, side_effects, unseen
from advisor.gap.axes.lateral.evidence import Gain, information_of, posterior_of, share_of, squares_of
from advisor.gap.axes.lateral.fit import Fit, N
from advisor.gap.axes.lateral.flight import SideFlight, SideModel
from advisor.gap.axes.lateral.gusts import coloured_likelihood
from advisor.gap.axes.lateral.laws import side_laws
from advisor.gap.axes.lateral.models import Case, base_of, free_near
from advisor.gap.fitting.prior import ERROR_IF_RIGHT
from advisor.gap.inference.engine import Decided, decided, first_stage
from advisor.gap.inference.explanation import Row
from advisor.gap.inference.posterior import NONE, relabelled
from advisor.gap.inference.prior import FIELD, FieldPrior
from advisor.gap.result import Cause, Value, Where, ranked
from advisor.gap.search.air import NATURAL_GUST_ANGLE
from advisor.gap.verdict.causes import MOST_CAUSES
from advisor.gap.verdict.reasons import none_means_no_gap, weighed
from advisor.gap.verdict.statements import what
from advisor.gap.verdict.text import answers_of, place
from advisor.model.axes.lateral import LATERAL
from advisor.words.certainty import Answers

PEAKS = ("p", "r")
"""Outputs whose largest errors are reported."""
AIR = "side gusts"
SIDE_GUSTS = Alternative("air", "side_gusts", "air")
Kind = Literal["none", "parameters", "effect", "unknown"]


@dataclass(frozen=True, slots=True)
class SideCause:
    """One effect that explains the gap in roll and yaw."""

    of: str
    """Control or output at which the effect acts; ``air`` for side gusts."""
    named: str
    """Name of the effect as the report prints it."""
    cause: Cause
    """Effect under its name in the pitch axis, with sizes and probability."""
    sentence: str
    gain: Gain
    """Log likelihood gained on unseen manoeuvres over fitted derivatives alone, nats."""
    peaks: Mapping[str, float]
    """Largest errors of roll rate and yaw rate with the effect in the simulator, rad/s."""

    @property
    def name(self) -> str:
        """Name of the effect in documents."""
        return self.named.replace(" ", "_")

    @property
    def block(self) -> str:
        """Block of the simulator in which the effect acts."""
        return block_of(self.of)


@dataclass(frozen=True)
class SideDiagnosis(Weighed):
    """All explanations of a lateral flight with their evidence, and the likeliest effects."""

    causes: tuple[SideCause, ...]
    """Effects of the model in the order in which they were found, then alternatives, likeliest first."""
    peaks: Mapping[str, float]
    """Largest errors of roll rate and yaw rate with the simulator's derivatives, rad/s."""
    peaks_by_numbers: Mapping[str, float]
    """Largest errors of roll rate and yaw rate with the flight's derivatives and no effect, rad/s."""
    cannot_see: Mapping[str, str]
    """Reason why these records cannot show a cause, by the cause's name."""
    before: Mapping[str, float] = field(default_factory=dict)
    """Gap of the simulator in each output: mean square error over mean square noise, minus 1."""
    after: Mapping[str, float] = field(default_factory=dict)
    """Gap of the chosen model in each output; every manoeuvre is predicted from all others."""
    by_maneuver: tuple[tuple[float, float], ...] = ()
    """Mean gap over the outputs of each manoeuvre, for the simulator and for the chosen model. NaN with a
    single manoeuvre."""
    floor: Mapping[str, float] = field(default_factory=dict)
    """Noise of each output, SI."""
    waterfall: tuple[tuple[str, float], ...] = ()
    """Remaining gap after each effect: the mean square error over that of the whole model, minus 1."""
    fits: tuple[Fit, ...] = ()
    """Fit with the simulator's derivatives, then the fit of the chosen model."""

    @property
    def mean_gap(self) -> tuple[float, float] | None:
        """Mean gap over the outputs, for the simulator and for the chosen model; None without both."""
        return (fmean(self.before.values()), fmean(self.after.values())) if self.after else None

    @property
    def shrink_percent(self) -> float | None:
        """Share of the simulator's mean gap that the chosen model removes, per cent; None without a gap."""
        gap = self.mean_gap
        return 100.0 * (1.0 - gap[1] / gap[0]) if gap and gap[0] > 0.0 else None

    @property
    def verdict(self) -> Kind:
        """Kind of the likeliest alternative."""
        assert self.answer is not None
        return "effect" if self.answer.is_effect else self.answer.kind  # type: ignore[return-value]

    @property
    def answers(self) -> Answers:
        """Every answer as a sentence with its probability, the likeliest first."""
        return answers_of(self.evidence)

    @property
    def where(self) -> Where | None:
        """Block of the named effect or of the likeliest law without a name; None without both."""
        each = {a.block: one.probability for one in self.evidence if (a := one.alternative).kind == "unknown"}
        without = sum(each.values())
        shares = {block: p / without for block, p in each.items() if without > 0.0}
        if self.verdict == "effect" and self.causes:
            first = {self.causes[0].block: 1.0}
            shares = first | shares | first
        if not shares:
            return None
        ranking = ranked(shares)
        return Where(ranking[0][0], shares[ranking[0][0]], ranking)

    @property
    def sentence(self) -> str:
        """Sentence about all effects of the model, or about the block of a law without a name."""
        if self.verdict == "unknown" and self.where is not None:
            return f"Something acts {place(self.where.block)} that no known effect explains."
        return ". ".join(one.sentence for one in self.causes if one.cause.present)


def diagnose_side(case: Case, prior: FieldPrior = FIELD) -> SideDiagnosis | None:
    """Return the probabilities of all explanations; None where no plain fit exists.

    If one effect is the likeliest explanation, a second effect is sought in addition to the first.

    Parameters
    ----------
    prior : shares of the answers before the flight.
    """
    first = case.fit(case.begin, case.natural)
    plain = first and case.fit(first.point, first.free, share=share_of(first))
    as_given = plain and case.fit(
        plain.point._replace(theta=case.theta), free_near(case, plain), ERROR_IF_RIGHT * 1e-3
    )
    if plain is None or as_given is None:
        return None
    table = list(side_effects(case.flown))
    flight = SideFlight(case, plain, table, list(side_laws(case, plain)))
    found = decided(flight, first_stage(flight), prior, lambda rows: [_named_air(row) for row in rows])
    found = _tied_to_the_gap(case, found, as_given)
    told, last = weighed(found.posteriors[0]), found.chosen[-1].fit
    before, each_before = _gap(last, _sums(last, as_given.residual**2))
    unseen_by = _held_out(case, found.chosen[-1], found.heat)
    after, each_after = _gap(last, unseen_by) if len(case.flown) > 1 else ({}, [np.nan])
    return SideDiagnosis(
        evidence=told.evidence, failed=found.failed, why=told.why, answer=told.answer, rival=told.rival,
        decisions=told.decisions, causes=tuple(_causes(case, found, as_given))[:MOST_CAUSES],
        peaks=peaks_of(as_given), peaks_by_numbers=peaks_of(plain), cannot_see=unseen(case.flown),
        before=before, after=after, by_maneuver=tuple(zip(each_before, each_after, strict=True)),
        floor={name: float(last.noise[LATERAL.outputs.index(name)]) for name in before},
        waterfall=_waterfall(found.chosen[1:]), fits=(as_given, last),
    )  # fmt: skip


def _held_out(case: Case, model: SideModel, heat: float) -> FloatArray:
    """Return the sums of squared errors (m, outputs) of a model on manoeuvres held out one by one."""
    known = case.prior_of(model.tolerance, model.fit.free)
    return squares_of(model.fit, information_of(model.fit, heat**-0.5), known).held_out


def _tied_to_the_gap(case: Case, found: Decided[SideModel], as_given: Fit) -> Decided[SideModel]:
    """Return the posterior in which "none" means that nothing is above the noise.

    A single manoeuvre shows no gap, because none is held out.
    """
    if len(case.flown) == 1:
        return found
    plain, last = found.chosen[0], found.chosen[-1].fit
    squares = _sums(last, as_given.residual**2), _held_out(case, plain, found.heat)
    gap, left = (fmean(_gap(last, one)[0].values()) for one in squares)
    first = none_means_no_gap(found.posteriors[0], gap, left if case.stated else gap)
    named = found.chosen if any(one.alternative == first.answer for one in found.chosen) else (plain,)
    return replace(found, posteriors=(first, *found.posteriors[1:]), chosen=named)


def _sums(fit: Fit, values: FloatArray) -> FloatArray:
    """Return the sums (m, outputs) of values (N,) over each manoeuvre and output."""
    sums = np.zeros((fit.assembly.maneuvers, len(fit.noise)))
    np.add.at(sums, (fit.assembly.owner, fit.assembly.channel), values)
    return sums


def _gap(fit: Fit, squares: FloatArray) -> tuple[Mapping[str, float], list[float]]:
    """Return the gap of each output, and the mean gap of each manoeuvre, from sums of squared errors.

    ``squares`` has shape (m, outputs).
    """
    counts = _sums(fit, np.ones(len(fit.residual)))
    with np.errstate(divide="ignore", invalid="ignore"):  # an output without a sample has no gap
        each = np.maximum(0.0, squares / counts / fit.noise**2 - 1.0)
        whole = np.maximum(0.0, squares.sum(axis=0) / counts.sum(axis=0) / fit.noise**2 - 1.0)
    measured = np.flatnonzero(counts.sum(axis=0))
    return {LATERAL.outputs[k]: float(whole[k]) for k in measured}, np.nanmean(each, axis=1).tolist()


def _named_air(row: Row[SideModel]) -> Row[SideModel]:
    """Return the row with side gusts as its answer, if the gusts alone exceed natural side gusts."""
    gusts = row.explanation.gusts
    blown = row.alternative == NONE and gusts is not None and gusts.angle > NATURAL_GUST_ANGLE
    return relabelled(row, SIDE_GUSTS) if blown else row


def _causes(case: Case, found: Decided[SideModel], as_given: Fit) -> Iterator[SideCause]:
    """Yield the effects of the model, then the alternatives to the first effect."""
    posterior, together = found.posteriors[0], 1.0
    added = found.chosen[1:]
    if added:
        last = added[-1].fit
        # The whole model leaves less colour than the model in which its last effect was sought.
        share = share_of(last)
        fit = case.fit(last.point, last.free, added[-1].tolerance, share) or last
        for stage, one in zip(found.posteriors, added, strict=False):
            assert one.alternative is not None
            together *= stage.of(one.alternative)
            yield _cause(case, one, fit, added[-1].tolerance, together, share, present=True)
    share = found.heat**-0.5
    taken = {one.alternative for one in added}
    for alternative, probability in posterior.by_alternative.items():
        if not alternative.is_effect or alternative in taken:
            continue
        other = posterior.explanation_of(alternative)
        if alternative == SIDE_GUSTS:
            yield _air(case, other, probability, posterior.answer == SIDE_GUSTS, as_given)
            continue
        yield _cause(case, other, other.fit, other.tolerance, probability, share, present=False)


def _cause(
    case: Case, tried: SideModel, fit: Fit, tolerance: float, probability: float, share: float, present: bool
) -> SideCause:
    """Return an effect as a cause, with its sizes from a fit that includes the effect."""
    effect = tried.effect
    assert effect is not None
    mean, covariance = posterior_of(fit, information_of(fit, share), case.prior_of(tolerance, fit.free))
    places = [one.place for one in fit.free]
    at = [N + places.index(place) for place in effect.places]
    sizes = mean[at] - base_of(case, effect)
    std = np.sqrt(np.diag(covariance)[at])
    parameters = {
        name: Value(float(size), float(error))
        for name, size, error in zip(effect.variant.names, sizes, std, strict=True)
    }
    if effect.variant.inverted:
        name = effect.variant.names[0]
        inverse, error = max(parameters[name].value, effect.variant.smallest), parameters[name].std
        parameters[name] = Value(1.0 / inverse, error / inverse**2)
    cause = Cause(
        effect.variant.effect, effect.variant.block, probability, parameters, (), "", float(np.nan), present
    )
    return SideCause(effect.of, effect.named, cause, effect.said(what(cause)), tried.gain, peaks_of(fit))


def _air(case: Case, one: SideModel, probability: float, is_found: bool, as_given: Fit) -> SideCause:
    """Return side gusts as a cause of the gap."""
    assert one.gusts is not None
    speed = float(np.mean([np.mean(record.airspeed.y) for record in case.flown.problem.records]))
    size = Value(one.gusts.angle * speed, one.gusts.angle_std * speed)
    cause = Cause("turbulence", "air", probability, {"sigma_v_m_s": size}, (), "", float(np.nan), is_found)
    said = f"The air was not still: side gusts of about {size.value:.2g} m/s"
    gain = Gain(one.gusts.likelihood - coloured_likelihood(one.fit), 0.0)
    return SideCause("air", AIR, cause, said, gain, peaks_of(as_given))


def _waterfall(added: Sequence[SideModel]) -> tuple[tuple[str, float], ...]:
    """Return the gap that remains after the addition of each effect to the model."""
    if not added:
        return ()
    told = np.unique(added[-1].fit.assembly.channel)
    last = added[-1].fit.noise[told]
    return tuple((one.name, float(np.mean((one.fit.noise[told] / last) ** 2)) - 1.0) for one in added)


def peaks_of(fit: Fit) -> Mapping[str, float]:
    """Return the largest errors of roll rate and yaw rate in a fit, rad/s."""
    return {
        name: max(float(np.max(np.abs(fit.residual[rows[name]]))) for rows in fit.assembly.rows)
        for name in PEAKS
    }
