"""Roll and yaw flight for the diagnosis: fits with an effect, their evidence and their residuals."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from advisor.gap.alternative import Alternative
from advisor.gap.axis.effects import AxisEffect, block_of
from advisor.gap.axis.evidence import colour_share, gained, information_of, squares_of, step_of, within_bounds
from advisor.gap.axis.fit import Fit, Known, moved_by
from advisor.gap.axis.gusts import Gusts, coloured_likelihood, gusts_of
from advisor.gap.axis.laws import along
from advisor.gap.axis.measure import sums
from advisor.gap.axis.models import Case, base_of, free_near, free_with
from advisor.gap.axis.residual import residual_of
from advisor.gap.axis.setting import moved_to
from advisor.gap.axis.starts import Start, Starts
from advisor.gap.fitting.prior import ERROR_IF_RIGHT, ERROR_IF_WRONG
from advisor.gap.inference.explanation import Evidence, Explanation
from advisor.gap.inference.marginal import marginal
from advisor.gap.inference.posterior import UNKNOWN
from advisor.gap.inference.residual import Residual
from advisor.gap.inference.sizes import natural_nats, natural_shares
from advisor.gap.inference.stage import (
    AT_THE_FILE,
    LAWS,
    SAME_OPTIMUM,
    Pairs,
    Stage,
    likeliest,
    within_model_error,
)
from advisor.gap.result import Value
from advisor.oem.axis.parameter import Parameter
from advisor.process.arrays import FloatArray
from advisor.process.parts import Parts

_TOLERANCES = (ERROR_IF_RIGHT, ERROR_IF_WRONG)
LIKELY = 0.01
"""Probability above which an effect is also fitted with gusts, and above which its sizes are stated."""
SEARCHES = 4
"""Numerical: largest number of searches for the plain model, each from the likeliest effect's derivatives."""
_STEPS = 2
"""Numerical: number of further fits of a nonlinear term, each along the motion of the fit before. It is also
the number of Gauss-Newton steps from the optimum in white noise to that in gusts."""


@dataclass(frozen=True, kw_only=True)
class AxisModel(Explanation):
    """One explanation of a flight with its fit."""

    effect: AxisEffect | None
    """Effect that the model adds to the derivatives; None for derivatives alone."""
    fit: Fit
    beyond: float
    """Correction of the log evidence for choices of sign and for loss on held-out manoeuvres, nats."""
    gain: Value
    """Gain on held-out manoeuvres over fitted derivatives alone, nats."""
    starts: Starts | None = None
    """Linear starts of all further effects; None except in the plain model."""
    gusts: Gusts | None = None
    """Gusts of the model; None in still air."""

    @property
    def tolerance(self) -> float:
        """Likelier of the two relative errors of the file's derivatives."""
        return ERROR_IF_RIGHT if self.evidence.right > self.evidence.wrong else ERROR_IF_WRONG


@dataclass(frozen=True)
class AxisFlight:
    """A flight along an axis, with its fit without effects."""

    case: Case
    plain: Fit
    table: Sequence[AxisEffect]
    laws: Sequence[AxisEffect] = ()
    """Laws of a surface or of a curve that have no name in the catalogue."""
    parts: Parts = field(default_factory=Parts)

    @property
    def tried(self) -> tuple[int, int]:
        """Number of candidate effects, and number of distinct names among the laws."""
        return len(self.table), len({law.name for law in self.laws})

    @property
    def is_stated(self) -> bool:
        """Whether the aircraft file states any derivative of the axis."""
        return bool(self.case.stated)

    def explained(self, base: AxisModel | None, most: int) -> tuple[float, list[AxisModel]]:
        """Return the temperature of the likelihood, and a model with each likely effect in addition."""
        begin = self.plain
        if base is not None:
            # With an effect, another lateness of commands and outputs changes the outputs by something else.
            free = (s if s.adds else replace(s, column=None) for s in base.fit.free)
            begin = replace(base.fit, free=tuple(free))
        # At two temperatures each of two optima may be the likelier: one serves all searches.
        share = colour_share(begin)
        plain = self.case.fit(begin.point, begin.free, share=share) or begin
        for _ in range(SEARCHES):
            everyone = self._each_about(plain, share, base, most)
            again = self._searched_again(everyone, share) if base is None else None
            if again is None:
                break
            # The plain model had ended in a local minimum, and so had all models that began there.
            plain = again
        else:
            self.parts.ended(
                f"{self.case.axis.name}, search of the derivatives alone", f"no end after {SEARCHES} searches"
            )
        plain = everyone[0].fit
        # What the likeliest model still lacks is an error of every model.
        share = colour_share(max(everyone, key=lambda s: s.likelihood).fit, lacking=True)
        weighed = (replace(self._model(s.effect, s.fit, plain, share), starts=s.starts) for s in everyone)
        return share**-2, list(weighed)

    def _each_about(self, plain: Fit, share: float, base: AxisModel | None, most: int) -> list[AxisModel]:
        """Return the plain model, and the models with each likely effect that begin there."""
        table = _beside(base, self.table)
        starts = Starts(self.case, plain, table, share=share)
        of_laws = Starts(self.case, plain, _beside(base, self.laws), share=share).of_each
        chosen = [(s, plain, ERROR_IF_WRONG) for s in likeliest(starts.of_each, most)]
        chosen += [(s, plain, ERROR_IF_WRONG) for s in likeliest(of_laws, LAWS)]
        near = self._at_the_file(plain, share, base) if self.is_stated else None
        if near is not None:
            others = [effect for effect in table if effect.name not in {s.name for s, *_ in chosen}]
            tight = Starts(self.case, near, others, ERROR_IF_RIGHT, share).of_each
            chosen += [(s, near, ERROR_IF_RIGHT) for s in likeliest(tight, AT_THE_FILE)]
        models = (self._added(s, at, tolerance, plain, share) for s, at, tolerance in chosen)
        return [replace(self._model(None, plain, plain, share), starts=starts), *filter(None, models)]

    def _at_the_file(self, plain: Fit, share: float, base: AxisModel | None) -> Fit | None:
        """Return the fit about the file's derivatives, which a wrong effect in the flight does not
        distort."""
        if base is not None:
            return self.case.fit(plain.point, free_near(self.case, plain), ERROR_IF_RIGHT, share)
        start = self.case.begin._replace(theta=self.case.theta)
        return self.case.fit(start, self.case.natural, ERROR_IF_RIGHT, share)

    def _searched_again(self, everyone: Sequence[AxisModel], share: float) -> Fit | None:
        """Return the plain model from a search that starts at the likeliest effect's derivatives; None if it
        is no better optimum.
        """
        plain, *added = everyone
        best = max(added, key=lambda m: m.likelihood, default=None)
        if best is None or best.effect is None:
            return None
        setting = moved_to(best.fit.point.setting, best.effect.places, base_of(self.case, best.effect))
        fit = self.case.fit(best.fit.point._replace(setting=setting), self.case.natural, share=share)
        prior = self.case.prior_of(ERROR_IF_WRONG, self.case.natural, share)
        better = fit is not None and prior.height(fit) > prior.height(plain.fit) + SAME_OPTIMUM
        return fit if better else None

    def _added(self, start: Start, at: Fit, tolerance: float, plain: Fit, share: float) -> AxisModel | None:
        """Return the model with an effect; None if the model diverges or a fault ends the fit."""

        def work() -> AxisModel | None:
            effect = start.effect
            fit = self.case.fit(start.point, free_with(self.case, effect, at), tolerance, share)
            for _ in range(_STEPS if effect.columns is not None and self.case.axis.curves else 0):
                if fit is not None:
                    effect = along(self.case, effect, fit)
                    fit = self.case.fit(fit.point, free_with(self.case, effect, at), tolerance, share)
            return None if fit is None else self._model(effect, fit, plain, share)

        return self.parts.kept(f"{self.case.axis.name}, effect {start.name}", work)

    def at_the_files(self, model: AxisModel, plain: AxisModel, heat: float) -> AxisModel | None:
        """Return an explanation refitted about the file's derivatives; None without such a fit.

        If the file's derivatives are likelier already, the first fit suffices for the quadratic expansion.
        """
        share, near = heat**-0.5, model.evidence.right > model.evidence.wrong
        free = model.fit.free if model.effect is not None else free_near(self.case, model.fit)
        made = None if near else self.case.fit(model.fit.point, free, ERROR_IF_RIGHT, share)
        if made is None:
            return None
        return replace(self._model(model.effect, made, plain.fit, share), starts=model.starts)

    def apart(self, model: AxisModel, other: AxisModel) -> float:
        """Return the largest difference between two models' outputs, as a share of the outputs' peaks."""
        return change_of(model.fit, other.fit)

    def residual(self, model: AxisModel, heat: float) -> Residual:
        """Return the disturbance that explains the residual of a model best."""
        return residual_of(model.fit, self.case.flown, heat**-0.5)

    def pairs(self, stage: Stage[AxisModel], leads: Sequence[AxisModel]) -> Pairs:
        """Yield the price of each pair of effects and both names, if the second effect may be a cause as
        well.

        The second effect's likelihood gain must exceed the cost of its prior probability.
        """
        looked = stage.plain.starts
        assert looked is not None
        starts = {s.name: s for s in sorted(looked.of_each, key=lambda s: -s.price)}
        for lead in leads:
            for other in (starts[e.name] for e in _beside(lead, self.table) if e.name in starts):
                price = looked.together(starts[lead.name], other)
                if price < starts[lead.name].price - 2.0 * np.log(len(self.table)):
                    yield price, lead.name, other.name

    def natural_nats(self, lead: AxisModel, pair: AxisModel) -> float:
        """Return the log prior gain of the lead's size in a pair, if that size is natural to every
        aircraft."""
        effect = lead.effect
        assert effect is not None
        sizes = [pair.fit.point.setting[place][0] for place in effect.places] - base_of(self.case, effect)
        return natural_nats(sizes, np.array(effect.std), natural_shares(effect.variant))

    @property
    def maneuvers(self) -> int:
        """Number of manoeuvres."""
        return len(self.case.flown)

    def in_moving_air(self, stage: Stage[AxisModel]) -> Stage[AxisModel] | None:
        """Return the likely explanations refitted with gusts, which disturb all outputs together.

        Coloured instruments and gusts are compared by their likelihoods. The residuals are those of the
        likeliest explanation, because an effect without its model resembles a coloured instrument.
        """
        if not self.case.axis.hidden:
            return None
        each = float(np.log(max(len(self.table), 1)))
        nats_of = [stage.plain.evidence.right, *(m.evidence.either - each for m in stage.effects)]
        least = np.logaddexp.reduce(nats_of) + np.log(LIKELY)
        likely = [m for m, nats in zip(stage.effects, nats_of[1:], strict=True) if nats > least]
        still = [stage.plain, *likely]
        lead = int(np.argmax([m.evidence.either for m in still]))
        fit = still[lead].fit
        air = gusts_of(fit, self.case.flown)
        blown = within_model_error(self, [self._blown(m, air, stage.heat) for m in still], 0.0)
        gain = air.likelihood - coloured_likelihood(fit)
        over = still[lead].evidence.either + gain - blown[lead].evidence.either
        first, *others = (replace(m.more(over), likelihood=m.likelihood + over) for m in blown)
        return Stage(first, tuple(others), (), stage.heat)

    def _wide(self, fit: Fit) -> Known:
        return self.case.prior_of(ERROR_IF_WRONG, fit.free)

    def _blown(self, model: AxisModel, air: Gusts, heat: float) -> AxisModel:
        """Return an explanation with gusts in addition, at its optimum in these gusts.

        A fit in white noise has absorbed part of the gusts in the derivatives, and lies far from the optimum
        in gusts.
        """
        wide = self._wide(model.fit)
        gusts = air.at(model.fit, self.case.flown)
        for _ in range(_STEPS):
            change = gusts.change(wide, model.fit)
            fits = (moved_by(self.case.flown, model.fit, share * change) for share in (1.0, 0.25))
            ahead = ((fit, gusts.at(fit, self.case.flown)) for fit in fits if fit is not None)
            height = gusts.height(wide, model.fit)
            fit, gusts = next(((f, g) for f, g in ahead if g.height(wide, f) > height), (None, gusts))
            if fit is None:
                break
            model = replace(model, fit=fit)
        # At the optimum the gradient balances the prior's. Delays have kinks, where no step leads further.
        gradient = wide.precision * (model.fit.values - wide.mean) / heat
        # What no model has is an error of every model, in gusts as in still air.
        likelihood, matrix = gusts.likelihood / heat, gusts.matrix / heat
        evidence, natural = self._weighed(model.fit, model.effect, likelihood, matrix, gradient)
        blown = replace(model, gusts=gusts, evidence=evidence, natural=natural, likelihood=likelihood)
        return replace(blown.more(model.beyond), model_error=0.0)

    def _weighed(
        self, fit: Fit, effect: AxisEffect | None, likelihood: float, matrix: FloatArray, gradient: FloatArray
    ) -> Iterator[Evidence]:
        """Yield the evidence of a fit, then the evidence with the effect at the small size natural to every
        aircraft."""
        for free in (fit.free, _narrowed(fit.free, effect)):
            priors = (self.case.prior_of(tolerance, free).prior(fit.values) for tolerance in _TOLERANCES)
            yield marginal(likelihood, matrix, gradient, *priors)

    def _model(self, effect: AxisEffect | None, fit: Fit, plain: Fit, share: float) -> AxisModel:
        """Return a model with its evidence, which a loss on held-out manoeuvres may reduce."""
        information, nats = within_bounds(fit, information_of(fit, share), self._wide(fit))
        likelihood = share**2 * fit.likelihood + nats
        matrix, gradient = (np.sum(part, axis=0) for part in information)
        evidence, natural = self._weighed(fit, effect, likelihood, matrix, gradient)
        # A search that ends early, as at a bound, leaves a step to the optimum, which the evidence has taken.
        step = step_of(fit, information, self._wide(fit)) * np.any(matrix != 0.0, axis=0)
        likelihood += float(gradient @ step - 0.5 * step @ matrix @ step)
        model = AxisModel(
            alternative=None, effect=effect, fit=fit, evidence=evidence, natural=natural,
            likelihood=likelihood, beyond=0.0, gain=Value(0.0, 0.0), change=change_of(plain, fit),
        )  # fmt: skip
        if effect is None:
            return model
        # Half of the prior lies below zero, where the bounds exclude a size.
        extra = np.log(2.0) if effect.variant.bounds[0][0] >= 0.0 else 0.0
        if effect.sides is not None:
            extra -= len(self.case.flown) * np.log(len(effect.sides[1]))
        inside, _ = within_bounds(plain, information_of(plain, share), self._wide(plain))
        was = squares_of(plain, inside, self._wide(plain))
        now = squares_of(fit, information, self.case.prior_of(model.tolerance, fit.free))
        # A manoeuvre that alone moves a control is predicted by the prior, which says nothing of an effect.
        kept = self.case.flown.foretold
        counts = sums(fit, np.ones(len(fit.residual)))[kept].sum(axis=0)
        gain = gained(was.held_out[kept], now.held_out[kept], counts, share)
        unseen = min(gain.value - gained(was.in_fit[kept], now.in_fit[kept], counts, share).value, 0.0)
        is_law = effect in self.laws
        answer = UNKNOWN if is_law else Alternative("effect", effect.name)
        answer = replace(answer, block=block_of(self.case.axis, effect.of))
        return replace(
            model.more(extra + unseen), alternative=answer,
            name=effect.name, numbers=effect.variant.names, beyond=extra + unseen, unseen=unseen, gain=gain,
        )  # fmt: skip


def _beside(base: AxisModel | None, table: Sequence[AxisEffect]) -> list[AxisEffect]:
    """Return the effects that share no entry with the effect of a model."""
    taken = set(base.effect.places) if base is not None and base.effect is not None else set()
    name = base.effect.name if base is not None and base.effect is not None else ""
    return [effect for effect in table if effect.name != name and not taken & set(effect.places)]


def _narrowed(free: Sequence[Parameter], effect: AxisEffect | None) -> list[Parameter]:
    """Return the free parameters, with the effect's prior narrowed to the size natural to every aircraft."""
    shares = {} if effect is None else dict(zip(effect.places, natural_shares(effect.variant), strict=True))
    return [replace(f, prior=replace(f.prior, std=shares.get(f.place, 1.0) * f.prior.std)) for f in free]


def change_of(fit: Fit, other: Fit) -> float:
    """Return the largest difference between the outputs of two fits, as a share of each output's peak."""
    shares = []
    for channel in np.unique(fit.assembly.channel):
        rows = fit.assembly.channel == channel
        apart = fit.fitted[rows] - other.fitted[rows]
        shares.append(np.sqrt(np.mean(apart**2)) / max(float(np.ptp(fit.assembly.z[rows])) / 2.0, 1e-12))
    return float(max(shares))
