"""One stage of the diagnosis: probabilities of nothing more, other numbers, side gusts, or one more effect.

An effect goes with right or with wrong derivatives, both equally likely before the flight. Its evidence is
never more than what it gains on manoeuvres that the fit has not seen. Each explanation goes with still air or
with side gusts.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from advisor.gap.fitting.prior import ERROR_IF_RIGHT, ERROR_IF_WRONG
from advisor.gap.inference.prior import FieldPrior
from advisor.gap.search.air import NATURAL_GUST_ANGLE
from advisor.side_gap.effects import SideEffect
from advisor.side_gap.evidence import (
    Gain,
    Squares,
    gain_of,
    information_of,
    log_evidence,
    probabilities,
    squares_of,
)
from advisor.side_gap.fit import Fit, Point
from advisor.side_gap.gusts import Gusts, coloured_likelihood
from advisor.side_gap.lacking import residuals_of, with_a_lacking_law
from advisor.side_gap.models import Case, base_of, best_start, effect_fit
from advisor.side_gap.moving_air import Model, for_model_error, in_moving_air

FITTED = 5
"""Number of effects that are fitted in full: those that leave least after a linear refit. The others take
part with no probability."""
LIKELY = 0.01
"""Probability above which an effect is fitted again with the likelier tolerance of the derivatives, and is
tried in side gusts."""


@dataclass(frozen=True, slots=True)
class Tried:
    """One effect with its fit and its evidence."""

    effect: SideEffect
    fit: Fit
    right: float
    """Log evidence with right derivatives, limited by the gain on unseen manoeuvres."""
    wrong: float
    gain: Gain
    beyond: tuple[float, float]
    """Parts of ``right`` and ``wrong`` beyond the marginal likelihood: sides of a prior, loss on unseen
    manoeuvres."""

    @property
    def evidence(self) -> float:
        """Log evidence with derivatives of either kind."""
        return float(np.logaddexp(self.right, self.wrong) - np.log(2.0))

    @property
    def tolerance(self) -> float:
        """Likelier relative error of the derivatives."""
        return ERROR_IF_RIGHT if self.right > self.wrong else ERROR_IF_WRONG


@dataclass(frozen=True, slots=True)
class Stage:
    """Probabilities of what may be added to a model."""

    plain: Fit
    share: float
    none: float
    parameters: float
    air: float
    """Probability of right derivatives in side gusts above the natural ones, and of nothing else."""
    gusts: Gusts
    air_gain: float
    """Log likelihood that gusts gain over coloured instruments, nats."""
    tried: tuple[Tried, ...]
    probability: Mapping[str, float]
    """Name of every effect that was tried to its probability."""
    unknown: Mapping[str, float]
    """Probability of a law that no effect describes, by block."""

    @property
    def ranked(self) -> tuple[Tried, ...]:
        """Effects, the likeliest first."""
        return tuple(sorted(self.tried, key=lambda one: -self.probability[one.effect.name]))

    @property
    def found(self) -> Tried | None:
        """The likeliest effect, where no other explanation is likelier."""
        first = next(iter(self.ranked), None)
        others = (self.none, self.parameters, self.air, sum(self.unknown.values()))
        return first if first is not None and self.probability[first.effect.name] > max(others) else None


def stage_of(case: Case, plain: Fit, share: float, table: Sequence[SideEffect], prior: FieldPrior) -> Stage:
    """Return the probabilities of all that may be added to the model of a fit.

    Parameters
    ----------
    plain
        Fit with derivatives that may be wrong.
    share
        Share of white noise in its residuals (``share_of``).
    table
        Effects to try.
    prior
        Shares of the answers before the flight.
    """
    told = information_of(plain, share)
    none, parameters = (
        log_evidence(plain, told, case.known(tolerance, plain.free), share)
        for tolerance in (ERROR_IF_RIGHT, ERROR_IF_WRONG)
    )
    left = squares_of(plain, told, case.known(ERROR_IF_WRONG, plain.free))
    starts = sorted(((best_start(case, plain, e), e) for e in table), key=lambda one: one[0].squares)
    tried = [
        one
        for one in (_tried(case, plain, e, start.point, left, share) for start, e in starts[:FITTED])
        if one is not None
    ]
    each = prior.effect / max(len(table), 1)
    models = [Model(plain, ()), *(Model(t.fit, t.effect.variant.names, t.beyond) for t in tried)]
    made_up = for_model_error(models, [share**2 * one.fit.likelihood for one in models])
    evidence = np.add([none, parameters, *(t.evidence for t in tried)], [made_up[0], *made_up])
    log_share = np.log([prior.none, prior.parameters, *(each for _ in tried)])
    likely = probabilities(evidence + log_share) > LIKELY
    gusts, in_gusts = in_moving_air(case, models, [True, *likely[2:]])
    gain = gusts.likelihood - coloured_likelihood(plain)
    # Moving air is as likely before the flight as any one effect.
    moving = each / (each + prior.none)
    still = evidence + log_share + np.log(1.0 - moving)
    blown = none + gain + in_gusts + log_share + np.log(moving)
    residuals = residuals_of(case, [models[0], *models], np.maximum(still, blown), share)
    posterior = with_a_lacking_law(still, blown, residuals, prior.unknown)
    found = np.sum(posterior.known, axis=0)
    air = float(posterior.known[1, 0]) if gusts.angle > NATURAL_GUST_ANGLE else 0.0
    return Stage(
        plain, share, float(found[0]) - air, float(found[1]), air, gusts, gain, tuple(tried),
        {one.effect.name: float(p) for one, p in zip(tried, found[2:], strict=True)}, posterior.unknown,
    )  # fmt: skip


def _tried(
    case: Case, plain: Fit, effect: SideEffect, begin: Point, left: Squares, share: float
) -> Tried | None:
    """Return an effect with its evidence; None where no fit exists or its size is below the least one."""
    fit = effect_fit(case, plain, effect, begin, share)
    if fit is None:
        return None
    size = fit.point.setting[effect.places[0]][0] - base_of(case, effect)[0]
    if abs(size) < effect.variant.smallest:
        return None
    told = information_of(fit, share)
    counts = np.bincount(fit.assembly.channel, minlength=len(fit.noise)).astype(float)
    # Half of the prior lies below zero, where the bounds exclude a size.
    extra = np.log(2.0) if effect.is_one_sided else 0.0
    if effect.sides is not None:
        extra -= len(case.flown) * np.log(len(effect.sides[1]))
    evidence, gains, beyond = [], [], []
    for tolerance in (ERROR_IF_RIGHT, ERROR_IF_WRONG):
        known = case.known(tolerance, fit.free)
        own = squares_of(fit, told, known)
        in_fit = gain_of(left.in_fit, own.in_fit, counts, share)
        gains.append(gain_of(left.held_out, own.held_out, counts, share))
        beyond.append(extra + min(gains[-1].total - in_fit.total, 0.0))
        evidence.append(log_evidence(fit, told, known, share) + beyond[-1])
    right, wrong = evidence
    return Tried(effect, fit, right, wrong, gains[int(wrong > right)], (beyond[0], beyond[1]))
