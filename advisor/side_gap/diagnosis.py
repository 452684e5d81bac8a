"""Explanations of a lateral flight: no gap, wrong numbers, side gusts, one effect, or two at once."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from advisor.gap.alternative import Alternative
from advisor.gap.fitting.prior import ERROR_IF_WRONG
from advisor.gap.inference.posterior import NONE, PARAMETERS
from advisor.gap.inference.prior import FIELD, FieldPrior
from advisor.gap.result import Cause, Value, Where
from advisor.gap.verdict.statements import what
from advisor.gap.verdict.text import in_words, place
from advisor.side_gap.disturbance import SENSORS
from advisor.side_gap.effects import SideEffect, side_effects, unseen
from advisor.side_gap.evidence import Gain, information_of, posterior_of, share_of
from advisor.side_gap.fit import Fit, N
from advisor.side_gap.models import Case, base_of, plain_fit, refitted, simulated
from advisor.side_gap.stage import LIKELY, Stage, Tried, stage_of
from advisor.words.certainty import Answers

PEAKS = ("p", "r")
"""Outputs whose largest errors are reported."""
AIR = "side gusts"
_BLOCKS = {**{output: block for block, output in SENSORS.items()}, "throttle": "rolling_moment"}
"""Output, or the throttle, to its block; a control and the air are blocks themselves."""
Kind = Literal["none", "parameters", "effect", "unknown"]


@dataclass(frozen=True, slots=True)
class SideCause:
    """One effect as the explanation of the gap."""

    of: str
    """Control or output; ``air`` for side gusts."""
    named: str
    """Name of the effect as people write it."""
    cause: Cause
    """Effect by its name of the pitch axis, with sizes and probability."""
    sentence: str
    gain: Gain
    """Log likelihood gained on unseen manoeuvres over fitted derivatives alone, nats."""
    peaks: Mapping[str, float]
    """Largest error of roll and yaw rate with the effect, rad/s."""

    @property
    def name(self) -> str:
        """Name of the effect in documents."""
        return self.named.replace(" ", "_")

    @property
    def block(self) -> str:
        """Block of the simulator in which the effect acts."""
        return next(
            (block for block, output in SENSORS.items() if output == self.of), _BLOCKS.get(self.of, self.of)
        )


@dataclass(frozen=True, slots=True)
class SideDiagnosis:
    """Probability of every explanation, and the likeliest effects."""

    none: float
    parameters: float
    effects: Mapping[str, float]
    """Name of every effect that was tried to the probability that it is the main cause."""
    unknown: Mapping[str, float]
    """Probability of a law that no effect describes, by block."""
    causes: tuple[SideCause, ...]
    """Effects of the model in the order in which they were found, then alternatives, likeliest first."""
    peaks: Mapping[str, float]
    """Largest error of roll and yaw rate with the simulator's derivatives, rad/s."""
    peaks_by_numbers: Mapping[str, float]
    """Largest error with the flight's derivatives and no effect, rad/s."""
    cannot_see: Mapping[str, str]
    """Causes that these records cannot show, with the reason."""
    waterfall: tuple[tuple[str, float], ...] = ()
    """Name of each effect of the model, and the gap that remains with it: the mean square over that of the
    whole model, minus 1."""

    @property
    def verdict(self) -> Kind:
        """Kind of the likeliest single explanation; the blocks of the unknown count together."""
        return max(self._kinds, key=lambda kind: self._kinds[kind])

    @property
    def probability(self) -> float:
        """Probability of the verdict."""
        return self._kinds[self.verdict]

    @property
    def _kinds(self) -> Mapping[Kind, float]:
        likeliest = max(self.effects.values(), default=0.0)
        unknown = sum(self.unknown.values())
        return {"none": self.none, "parameters": self.parameters, "effect": likeliest, "unknown": unknown}

    @property
    def where(self) -> Where | None:
        """Block of the named effect, or else the likeliest one of a law without a name; None without both."""
        without = sum(self.unknown.values())
        ranked = {block: p / without for block, p in self.unknown.items()} if without > 0.0 else {}
        if self.verdict == "effect" and self.causes:
            block = self.causes[0].block
            ranked = {block: 1.0, **{other: p for other, p in ranked.items() if other != block}}
        if not ranked:
            return None
        first = max(ranked, key=lambda block: ranked[block])
        ranking = sorted(((b, p / ranked[first]) for b, p in ranked.items()), key=lambda one: -one[1])
        return Where(first, ranked[first], tuple(ranking))

    @property
    def answers(self) -> Answers:
        """Every answer in words with its probability, the likeliest first."""
        found = [(in_words(NONE), self.none), (in_words(PARAMETERS), self.parameters)]
        found += [(name.replace("_", " "), p) for name, p in self.effects.items()]
        if self.unknown:
            block = max(self.unknown, key=lambda one: self.unknown[one])
            found.append((in_words(Alternative("unknown", "unknown", block)), sum(self.unknown.values())))
        return sorted(found, key=lambda answer: -answer[1])

    @property
    def sentence(self) -> str:
        """Statements about all effects of the model, or about the place of a law without a name."""
        if self.verdict == "unknown" and self.where is not None:
            return f"Something acts {place(self.where.block)} that no known effect explains."
        return ". ".join(one.sentence for one in self.causes if one.cause.present)


def diagnose_side(case: Case, prior: FieldPrior = FIELD, listed: int = 5) -> SideDiagnosis | None:
    """Return the probabilities of all explanations; None where no plain fit exists.

    Where one effect is the likeliest explanation, a second one is sought in the model with the first.

    Parameters
    ----------
    prior : shares of the answers before the flight.
    listed : number of causes that are returned.
    """
    first = plain_fit(case)
    share = 1.0 if first is None else share_of(first)
    plain = None if first is None else refitted(case, first, ERROR_IF_WRONG, share)
    as_given = None if plain is None else simulated(case, plain)
    if plain is None or as_given is None:
        return None
    table = list(side_effects(case.flown))
    stage = stage_of(case, plain, share, table, prior)
    effects = dict(stage.probability)
    if stage.air > 0.0:
        effects[AIR.replace(" ", "_")] = stage.air
    stages = [stage, *_second(case, stage, table, prior)]
    return SideDiagnosis(
        stage.none,
        stage.parameters,
        effects,
        stage.unknown,
        tuple(_causes(case, stages, as_given))[:listed],
        peaks_of(as_given),
        peaks_of(plain),
        unseen(case.flown),
        _waterfall(stages),
    )


def _second(case: Case, stage: Stage, table: Sequence[SideEffect], prior: FieldPrior) -> Iterator[Stage]:
    """Yield the stage after the one effect that was found, where its model can be fitted again."""
    found = stage.found
    if found is None:
        return
    share = share_of(found.fit)
    # With the effect, another lateness of commands and outputs changes the outputs by something else.
    anew = replace(found.fit, free=tuple(one._replace(column=None) for one in found.fit.free))
    plain = refitted(case, anew, ERROR_IF_WRONG, share)
    if plain is not None:
        others = [e for e in table if not set(e.places) & set(found.effect.places)]
        yield stage_of(case, plain, share, others, prior)


def _causes(case: Case, stages: Sequence[Stage], as_given: Fit) -> Iterator[SideCause]:
    """Yield the effects of the model, then the alternatives to the first of them."""
    stage, together = stages[0], 1.0
    fit, tolerance, share = stage.plain, ERROR_IF_WRONG, stage.share
    added: list[tuple[Tried, float]] = []
    for one in stages:
        if one.found is not None:
            together *= one.probability[one.found.effect.name]
            added.append((one.found, together))
            fit, tolerance, share = one.found.fit, one.found.tolerance, one.share
    if added:
        # The whole model leaves less colour than the model in which its last effect was sought.
        share = share_of(fit)
        fit = refitted(case, fit, tolerance, share) or fit
    for tried, probability in added:
        yield _cause(case, tried, fit, tolerance, probability, share, present=True)
    alternatives: list[tuple[float, Tried | None]]
    alternatives = [(stage.probability[t.effect.name], t) for t in stage.ranked if t is not stage.found]
    if stage.air > 0.0:
        alternatives.append((stage.air, None))
    for probability, other in sorted(alternatives, key=lambda pair: -pair[0]):
        if other is None:
            yield _air(case, stage, as_given)
            continue
        again = other.fit
        if probability > LIKELY:
            again = refitted(case, other.fit, other.tolerance, stage.share) or other.fit
        yield _cause(case, other, again, other.tolerance, probability, stage.share, present=False)


def _cause(
    case: Case, tried: Tried, fit: Fit, tolerance: float, probability: float, share: float, present: bool
) -> SideCause:
    """Return an effect with its sizes in a fit that has the effect."""
    effect = tried.effect
    mean, covariance = posterior_of(fit, information_of(fit, share), case.known(tolerance, fit.free))
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


def _air(case: Case, stage: Stage, as_given: Fit) -> SideCause:
    """Return side gusts as a cause."""
    is_found = stage.air > max(stage.none, stage.parameters, *stage.probability.values())
    speed = float(np.mean([np.mean(record.airspeed.y) for record in case.flown.problem.records]))
    size = Value(stage.gusts.angle * speed, stage.gusts.angle_std * speed)
    cause = Cause("turbulence", "air", stage.air, {"sigma_v_m_s": size}, (), "", float(np.nan), is_found)
    said = f"The air was not still: side gusts of about {size.value:.2g} m/s"
    return SideCause("air", AIR, cause, said, Gain(stage.air_gain, 0.0), peaks_of(as_given))


def _waterfall(stages: Sequence[Stage]) -> tuple[tuple[str, float], ...]:
    """Return the gap that remains with each effect of the model."""
    added = [stage.found for stage in stages if stage.found is not None]
    if not added:
        return ()
    told = np.unique(added[-1].fit.assembly.channel)
    last = added[-1].fit.noise[told]
    return tuple((one.effect.name, float(np.mean((one.fit.noise[told] / last) ** 2)) - 1.0) for one in added)


def peaks_of(fit: Fit) -> Mapping[str, float]:
    """Return the largest error of roll and yaw rate, rad/s."""
    return {
        name: max(float(np.max(np.abs(fit.residual[rows[name]]))) for rows in fit.assembly.rows)
        for name in PEAKS
    }
