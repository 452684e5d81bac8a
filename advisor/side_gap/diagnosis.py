"""Explanations of a lateral flight with their probabilities: no gap, wrong numbers, or one effect.

An effect goes with right or with wrong derivatives, both equally likely before the flight. Its evidence is
never more than what it gains on manoeuvres that the fit has not seen.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.fitting.prior import ERROR_IF_RIGHT, ERROR_IF_WRONG
from advisor.gap.judge.prior import FIELD, FieldPrior
from advisor.gap.result import Cause, Value
from advisor.gap.verdict.statements import what
from advisor.side_gap.effects import SideEffect, side_effects, unseen
from advisor.side_gap.evidence import (
    Gain,
    Squares,
    gain_of,
    information_of,
    log_evidence,
    posterior_of,
    probabilities,
    share_of,
    squares_of,
)
from advisor.side_gap.fit import Fit, N, Point
from advisor.side_gap.models import Case, best_start, effect_fit, plain_fit, refitted, simulated

FITTED = 5
"""Number of effects that are fitted in full: those that leave least after a linear refit. The others take
part with no probability."""
LIKELY = 0.01
"""Probability above which an effect is fitted again with the likelier tolerance of the derivatives."""
PEAKS = ("p", "r")
"""Outputs whose largest errors are reported."""


@dataclass(frozen=True, slots=True)
class SideCause:
    """One effect as the explanation of the gap."""

    of: str
    """Control or output."""
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


@dataclass(frozen=True, slots=True)
class SideDiagnosis:
    """Probability of every explanation, and the likeliest effects."""

    none: float
    parameters: float
    effects: Mapping[str, float]
    """Name of every effect that was tried to its probability."""
    causes: tuple[SideCause, ...]
    """Likeliest first."""
    peaks: Mapping[str, float]
    """Largest error of roll and yaw rate with the simulator's derivatives, rad/s."""
    peaks_by_numbers: Mapping[str, float]
    """Largest error with the flight's derivatives and no effect, rad/s."""
    cannot_see: Mapping[str, str]
    """Causes that these records cannot show, with the reason."""

    @property
    def verdict(self) -> Literal["none", "parameters", "effect"]:
        """Kind of the likeliest single explanation: ``none``, ``parameters`` or ``effect``."""
        kinds: dict[Literal["none", "parameters", "effect"], float]
        likeliest = max(self.effects.values(), default=0.0)
        kinds = {"none": self.none, "parameters": self.parameters, "effect": likeliest}
        return max(kinds, key=lambda kind: kinds[kind])


@dataclass(frozen=True, slots=True)
class _Tried:
    """One effect with its fit and its evidence."""

    effect: SideEffect
    fit: Fit
    right: float
    """Log evidence with right derivatives, limited by the gain on unseen manoeuvres."""
    wrong: float
    gain: Gain

    @property
    def evidence(self) -> float:
        return float(np.logaddexp(self.right, self.wrong) - np.log(2.0))


def diagnose_side(case: Case, prior: FieldPrior = FIELD, listed: int = 5) -> SideDiagnosis | None:
    """Return the probabilities of all explanations; None where no plain fit exists.

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
    told = information_of(plain, share)
    none, parameters = (
        log_evidence(plain, told, case.known(tolerance, plain.free), share)
        for tolerance in (ERROR_IF_RIGHT, ERROR_IF_WRONG)
    )
    left = squares_of(plain, told, case.known(ERROR_IF_WRONG, plain.free))
    table = list(side_effects(case.flown))
    starts = sorted(((best_start(case, plain, e), e) for e in table), key=lambda one: one[0].squares)
    tried = [
        one
        for one in (_tried(case, plain, e, start.point, left, share) for start, e in starts[:FITTED])
        if one is not None
    ]
    each = prior.effect / max(len(table), 1)
    found = probabilities(
        [none, parameters, *(one.evidence for one in tried)],
        [prior.none, prior.parameters, *(each for _ in tried)],
    )
    order = np.argsort(-found[2:])[:listed]
    return SideDiagnosis(
        float(found[0]),
        float(found[1]),
        {one.effect.name: float(p) for one, p in zip(tried, found[2:], strict=True)},
        tuple(_cause(case, tried[k], float(found[2 + k]), share) for k in order),
        peaks_of(as_given),
        peaks_of(plain),
        unseen(case.flown),
    )


def _tried(
    case: Case, plain: Fit, effect: SideEffect, begin: Point, left: Squares, share: float
) -> _Tried | None:
    """Return an effect with its evidence; None where no fit exists or its size is below the least one."""
    fit = effect_fit(case, plain, effect, begin, share)
    if fit is None or abs(_sizes(case, effect, fit)[0]) < effect.variant.smallest:
        return None
    told = information_of(fit, share)
    counts = np.bincount(fit.assembly.channel, minlength=len(fit.noise)).astype(float)
    # Half of the prior lies below zero, where the bounds exclude a size.
    extra = np.log(2.0) if effect.is_one_sided else 0.0
    if effect.sides is not None:
        extra -= len(case.flown) * np.log(len(effect.sides[1]))
    evidence, gains = [], []
    for tolerance in (ERROR_IF_RIGHT, ERROR_IF_WRONG):
        known = case.known(tolerance, fit.free)
        own = squares_of(fit, told, known)
        in_fit = gain_of(left.in_fit, own.in_fit, counts, share)
        gains.append(gain_of(left.held_out, own.held_out, counts, share))
        lost = min(gains[-1].total - in_fit.total, 0.0)
        evidence.append(log_evidence(fit, told, known, share) + extra + lost)
    right, wrong = evidence
    return _Tried(effect, fit, right, wrong, gains[int(wrong > right)])


def _cause(case: Case, tried: _Tried, probability: float, share: float) -> SideCause:
    effect, fit = tried.effect, tried.fit
    tolerance = ERROR_IF_RIGHT if tried.right > tried.wrong else ERROR_IF_WRONG
    if probability > LIKELY:
        fit = refitted(case, fit, tolerance, share) or fit
    mean, covariance = posterior_of(fit, information_of(fit, share), case.known(tolerance, fit.free))
    places = [one.place for one in fit.free]
    at = [N + places.index(place) for place in effect.places]
    sizes = mean[at] - _base(case, effect)
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
        effect.variant.effect, effect.variant.block, probability, parameters, (), "", float(np.nan), True
    )
    return SideCause(effect.of, effect.named, cause, effect.said(what(cause)), tried.gain, peaks_of(fit))


def _sizes(case: Case, effect: SideEffect, fit: Fit) -> FloatArray:
    found = np.array([fit.point.setting[place][0] for place in effect.places])
    return np.asarray(found - _base(case, effect))


def _base(case: Case, effect: SideEffect) -> FloatArray:
    """Return the numbers that the aircraft file states at an effect's places."""
    begin = case.begin.setting
    return np.array([begin[place][0] if place in begin else 0.0 for place in effect.places])


def peaks_of(fit: Fit) -> Mapping[str, float]:
    """Return the largest error of roll and yaw rate, rad/s."""
    return {
        name: max(float(np.max(np.abs(fit.residual[rows[name]]))) for rows in fit.assembly.rows)
        for name in PEAKS
    }
