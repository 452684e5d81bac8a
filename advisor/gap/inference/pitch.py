"""Pitch flight for the diagnosis: fits with an effect, their evidence and their residuals."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from advisor.gap.fitting.fit import EffectFit, above_floor, fit
from advisor.gap.fitting.holdout import HeldOut, hold_out, mean_squares
from advisor.gap.fitting.prior import ERROR_IF_RIGHT, ERROR_IF_WRONG
from advisor.gap.fitting.problem import EffectProblem, counts
from advisor.gap.inference.evidence import FlightProblem, evidence_of, log_likelihood, temperature
from advisor.gap.inference.explanation import Explanation
from advisor.gap.inference.posterior import UNKNOWN, stated_as
from advisor.gap.inference.residual import Residual, residual_of
from advisor.gap.inference.sizes import natural_nats, natural_shares
from advisor.gap.inference.stage import AT_THE_FILE, LAWS, REFINED, SAME_OPTIMUM, Pairs, Stage, likeliest
from advisor.gap.kit.effect import Variant
from advisor.gap.result import Cause
from advisor.gap.search.screen import Screen, Screened
from advisor.process.arrays import FloatArray
from advisor.process.parts import Parts

_SYMMETRIC = float(np.log(2.0))
"""Log prior gain, nats, of a parameter that cannot be negative: its Gaussian prior has half the range."""


@dataclass(frozen=True, kw_only=True)
class PitchModel(Explanation):
    """One explanation of a pitch flight with its fit."""

    variant: Variant | None
    """Effect or law that the model adds; None for derivatives alone."""
    problem: FlightProblem
    """Flight, with the tolerance of the derivatives under which the model was fitted."""
    fitted: EffectFit
    held_out: HeldOut
    taken_out: tuple[Cause, ...] = ()
    """Effects of a user's simulator, with negative sizes, that aircraft and model lack."""

    @property
    def values(self) -> FloatArray:
        """Parameter values of the added effect, shape (numbers,); empty for derivatives alone."""
        return np.zeros(0) if self.variant is None else np.asarray(self.fitted.point.values[-1])

    def seen_in(self, flight: EffectProblem) -> "PitchModel":
        """Return the model fitted to other outputs of its flight, or the model itself if that is likelier."""
        problem = replace(self.problem, flights=flight.flights)
        made = fit(problem, self.fitted.point, self.fitted.noise)
        if made.cost >= self.fitted.cost:
            return self
        return replace(self, problem=problem, fitted=made, held_out=hold_out(problem, made))


@dataclass(frozen=True)
class PitchFlight:
    """A flight in pitch, with its fit without effects."""

    problem: FlightProblem
    plain: EffectFit
    table: Sequence[Variant]
    laws: Sequence[Variant]
    """Laws outside the catalogue, with a prior on each parameter."""
    looked: dict[int, list[Screened]] = field(default_factory=dict)
    """Quick fits of a second effect, by the identity of the fit with the first effect."""
    parts: Parts = field(default_factory=Parts)
    is_optimum: bool = False
    """Whether the search of the plain model ended at ``plain``; a second search may end elsewhere."""
    mirror: "Callable[[PitchFlight, PitchModel, float], PitchModel | None]" = lambda *_: None
    """Function that returns a user's simulator without effects that the aircraft lacks, from the flight, the
    plain model and the temperature."""

    @property
    def tried(self) -> tuple[int, int]:
        """Number of candidate effects, and number of distinct names among the laws."""
        return len({v.effect for v in self.table}), len({v.effect for v in self.laws})

    @property
    def is_stated(self) -> bool:
        """Whether the aircraft file states all derivatives."""
        return self.problem.is_stated

    def explained(self, base: PitchModel | None, most: int) -> tuple[float, list[PitchModel]]:
        """Return the temperature of the likelihood, and a model with each likely effect or law in
        addition."""
        problem, begin = (self.problem, self.plain) if base is None else (base.problem, base.fitted)
        table = self._beside(base)
        loose = problem.within(ERROR_IF_WRONG)
        plain = begin if self.is_optimum and begin is self.plain else fit(loose, begin.point, begin.noise, 4)
        screen = Screen(loose, plain)
        quick = screen.quick_fits(table) if base is None else self._looks(base)
        chosen = [*likeliest(quick, most), *likeliest(screen.quick_fits(self.laws), LAWS)]
        if problem.is_stated:
            near = problem.within(ERROR_IF_RIGHT)
            tight = Screen(near, fit(near, plain.point, plain.noise, iterations=4))
            # A wrong hill of the derivatives hides an effect even where its quick fit is among the likeliest.
            chosen += likeliest(tight.quick_fits(table), AT_THE_FILE)
        far = min([plain.cost, *(q.cost for q in chosen)]) + 2.0 * REFINED * temperature(problem, plain)
        part, kept = "pitch, effect {}".format, self.parts.kept
        full = partial(fit, loose, iterations=8, beaten_by=far)
        tried = [(q, kept(part(q.name), partial(full, q.point, q.noise))) for q in chosen]
        ended = [(q.variant, made) for q, made in tried if made is not None and np.isfinite(made.cost)]
        # The last of one variant is the least cost of its searches.
        fits = list({id(v): (v, made) for v, made in sorted(ended, key=lambda end: -end[1].cost)}.values())
        without = _without_the_effect(loose, plain, [made for _, made in fits])
        if base is None and without.cost < plain.cost - 2.0 * SAME_OPTIMUM * temperature(problem, plain):
            # The plain model had ended in a local minimum, and so had all that began there.
            return replace(self, plain=without, looked={}, is_optimum=True).explained(base, most)
        heat = temperature(problem, min((plain, *(made for _, made in fits)), key=lambda made: made.cost))
        model = partial(self.model_of, loose, plain=plain, heat=heat)
        models = [kept(part(v.effect), partial(model, v, made)) for v, made in fits]
        first = model(None, plain)
        search = partial(self.mirror, self, first, heat)
        mirrored = kept("effects of the simulator", search) if base is None else None
        return heat, [first, *filter(None, (*models, mirrored))]

    def at_the_files(self, model: PitchModel, plain: PitchModel, heat: float) -> PitchModel | None:
        """Return an explanation refitted about the file's derivatives; None without such a fit."""
        near = model.problem.within(ERROR_IF_RIGHT)
        made = fit(near, model.fitted.point, model.fitted.noise, iterations=5)
        if not np.isfinite(made.cost):
            return None
        right = self.model_of(near, model.variant, made, plain.fitted, heat)
        return replace(right, alternative=model.alternative, taken_out=model.taken_out, chance=model.chance)

    def apart(self, model: PitchModel, other: PitchModel) -> float:
        """Return the largest difference between two models' outputs, as a share of the outputs' peaks."""
        return change_of(self.problem, model.fitted, other.fitted)

    def residual(self, model: PitchModel, heat: float) -> Residual:
        """Return the disturbance that explains the residual of a model best."""
        return residual_of(model.problem, model.fitted, heat)

    def natural_nats(self, lead: PitchModel, pair: PitchModel) -> float:
        """Return the log prior gain of the lead's size in a pair, if that size is natural to every
        aircraft."""
        variant, point = lead.variant, pair.fitted.point
        assert variant is not None
        sizes = np.asarray(point.values[point.index_of(variant.effect)])
        return natural_nats(sizes, np.array(variant.prior_std), natural_shares(variant))

    @property
    def maneuvers(self) -> int:
        """Number of manoeuvres."""
        return len(self.problem.flights)

    def in_moving_air(self, stage: Stage[PitchModel]) -> None:
        """Return None: moving air is compared with the answer afterwards."""

    def pairs(self, stage: Stage[PitchModel], leads: Sequence[PitchModel]) -> Pairs:
        """Yield the price of each pair of a lead and another effect, and both names."""
        yield from ((quick.cost, lead.name, quick.name) for lead in leads for quick in self._looks(lead))

    def _looks(self, lead: PitchModel) -> list[Screened]:
        """Return a one-step fit of each effect in addition to that of a model, computed once."""
        if id(lead.fitted) not in self.looked:
            screen = Screen(lead.problem, lead.fitted, steps=1)
            self.looked[id(lead.fitted)] = screen.quick_fits(self._beside(lead))
        return self.looked[id(lead.fitted)]

    def _beside(self, base: PitchModel | None) -> list[Variant]:
        """Return the effects that may act in addition to that of a model."""
        return [variant for variant in self.table if base is None or variant.effect != base.name]

    def model_of(
        self, problem: FlightProblem, variant: Variant | None, made: EffectFit, plain: EffectFit, heat: float
    ) -> PitchModel:
        """Return a model with its evidence, which a loss on held-out manoeuvres may reduce."""
        held, evidence = hold_out(problem, made), evidence_of(problem, made, heat)
        model = partial(
            PitchModel, variant=variant, problem=problem, fitted=made, held_out=held,
            likelihood=log_likelihood(problem, made) / heat, change=change_of(problem, plain, made),
        )  # fmt: skip
        if variant is None:
            return model(alternative=None, evidence=evidence, natural=evidence)
        unseen = 0.0 if variant.needs else _lost_unseen(problem, plain, made, held) / heat
        extra = _extra(variant, len(problem.flights)) + unseen
        is_law = any(variant.effect == law.effect for law in self.laws)
        return model(
            alternative=replace(UNKNOWN, block=variant.block) if is_law else stated_as(variant.effect),
            name=variant.effect, numbers=variant.names, evidence=evidence.more(extra), unseen=unseen,
            natural=evidence_of(problem, made, heat, natural_shares(variant)).more(extra),
        )  # fmt: skip


def _without_the_effect(problem: FlightProblem, plain: EffectFit, fits: Sequence[EffectFit]) -> EffectFit:
    """Return the plain model from a search that starts at the optimum of the likeliest model with
    an effect.
    """
    best = min(fits, key=lambda made: made.cost, default=plain)
    if best.cost >= plain.cost - 2.0 * SAME_OPTIMUM:
        return plain
    start = replace(best.point.keeping(range(len(plain.point.effects))), sides=plain.point.sides)
    made = fit(problem, start, best.noise, iterations=8)
    return made if np.isfinite(made.cost) and made.cost < plain.cost else plain


def change_of(problem: EffectProblem, fit: EffectFit, other: EffectFit) -> float:
    """Return the largest difference between two models' outputs, as a share of each identifying channel's
    peak."""
    squares = mean_squares(problem, [a - b for a, b in zip(fit.residuals, other.residuals, strict=True)])
    share = np.sqrt(np.mean(squares, axis=0)) / problem.flights.peaks
    return float(np.max(share[problem.flights.telling]))


def _extra(variant: Variant, maneuvers: int) -> float:
    """Return the log prior, nats, of choices beyond a Gaussian about zero: a sign, sides, a time."""
    low, high = variant.bounds[0]
    extra = _SYMMETRIC if low >= 0.0 or high <= 0.0 else 0.0
    if variant.sides is not None:
        extra -= 0.5 * maneuvers * float(np.log(len(variant.sides[1])))
    if "at_s" in variant.fixed:
        extra -= float(np.log(max(maneuvers - 1, 1)))
    return extra


def _lost_unseen(problem: FlightProblem, plain: EffectFit, made: EffectFit, held: HeldOut) -> float:
    """Return how much less an effect gains on held-out manoeuvres than in the fit, nats, at most 0.

    Each model predicts under the prior of its own fit. No error counts as less than the least noise.
    """
    before = hold_out(problem.within(ERROR_IF_WRONG), plain)
    was, now = (above_floor(problem, np.sqrt(h.innovation_square)) for h in (before, held))
    return min(0.0, float(counts(problem) @ np.log(was / now * made.noise / plain.noise)))
