"""Which: full fits of the few candidates worth it, each judged on manoeuvres it has not seen."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.fit import Fitted, fit
from advisor.gap.floor import independent_samples
from advisor.gap.holdout import HeldOut, hold_out
from advisor.gap.problem import Problem
from advisor.gap.screen import Screen, Screened
from advisor.gap.variant import Variant

FULL_FITS = 5
"""Candidates that get a full fit after the screening."""
LEAST_GAIN = 6.0
"""Log likelihood, on held-out manoeuvres and after the price of its numbers, that an effect must bring."""
LEAST_GAP = 0.03
"""Part of the gap, in units of the floor's mean square averaged over channels, it must remove there."""
LEAST_SIGMA = 3.0
_PROMISE = 0.7
"""Share of ``LEAST_GAP`` that the screening must promise before a full fit is spent on a candidate."""
_ARMS = {"alpha_vane_offset", "accelerometer_offset"}
"""One and the same thing in the data: only the derivatives they leave behind differ."""
_EQUIVALENT = 5.0
"""Difference of gain between two descriptions of the very same thing."""


@dataclass(frozen=True)
class Judged:
    """One effect as an addition to a model."""

    variant: Variant
    fitted: Fitted
    held_out: HeldOut
    gain: float
    """Held-out log likelihood gained, coloured residuals counted at their worth, minus k/2 ln N."""
    removed: float
    """Gap removed on held-out manoeuvres, in units of what is left."""
    value: FloatArray
    std: FloatArray

    @property
    def effect(self) -> str:
        """Name in the catalogue."""
        return self.variant.effect

    @property
    def worth_naming(self) -> bool:
        """Better on unseen manoeuvres, by more than noise, and not smaller than matters."""
        if self.gain < LEAST_GAIN or self.removed < LEAST_GAP:
            return False
        size = float(np.max(np.abs(self.value) / np.maximum(self.std, 1e-300)))
        return size > LEAST_SIGMA and self.large_enough

    @property
    def large_enough(self) -> bool:
        """At or above the physical minimum."""
        if self.effect == "icing":
            return bool(np.max(np.abs(self.value)) >= self.variant.smallest)
        return bool(abs(self.value[0]) >= self.variant.smallest)


def worth(problem: Problem, lefts: Sequence[FloatArray]) -> FloatArray:
    """Shape (channels,): independent samples of each channel over all manoeuvres."""
    total = np.zeros(len(problem.channels))
    for flight, left in zip(problem.flights.flights, lefts, strict=True):
        for c, rows in enumerate(problem.rows(flight)):
            total[c] += independent_samples(left[rows])
    return total


def judge(
    problem: Problem, before: Fitted, held_before: HeldOut, candidates: Sequence[Screened]
) -> list[Judged]:
    """Full fits of the best variant of the best effects; the best judgement first."""
    chosen: dict[str, Screened] = {}
    for candidate in candidates:
        promised = float(np.mean(before.noise**2 / candidate.noise**2 - 1.0))
        if promised < _PROMISE * LEAST_GAP or candidate.cost >= before.cost:
            continue
        if candidate.variant.effect not in chosen and len(chosen) < FULL_FITS:
            chosen[candidate.variant.effect] = candidate
    fits = [(s.variant, fit(problem, s.point, s.noise, iterations=8, tolerance=0.5)) for s in chosen.values()]
    if not fits:
        return []
    best = min(fits, key=lambda f: f[1].cost)[1]
    independent = worth(problem, best.left)
    judged = [_judge(problem, before, held_before, v, f, independent) for v, f in fits]
    return plausible(sorted(judged, key=lambda j: -j.gain), problem.believed)


def _judge(
    problem: Problem,
    before: Fitted,
    held_before: HeldOut,
    variant: Variant,
    fitted: Fitted,
    independent: FloatArray,
) -> Judged:
    held = hold_out(problem, fitted)
    ratio = np.log(held_before.mean_square / held.mean_square)
    numbers = len(variant.names) + (1 if variant.fixed else 0)
    gain = float(np.sum(independent / 2.0 * ratio)) - 0.5 * numbers * float(np.log(np.sum(independent)))
    floor = fitted.noise**2
    removed = float(np.mean((held_before.mean_square - held.mean_square) / floor))
    k = len(variant.names)
    return Judged(
        variant,
        fitted,
        held,
        gain,
        removed,
        fitted.point.values[-1],
        shared_std(problem, fitted, independent)[-k:],
    )


def shared_std(problem: Problem, fitted: Fitted, independent: FloatArray) -> FloatArray:
    """Shape (k,): standard deviations of the shared numbers, widened for coloured residuals."""
    scale = np.sqrt(np.maximum(np.diag(fitted.information), 1e-300))
    normal = fitted.information / np.outer(scale, scale)
    plain = np.sqrt(np.maximum(np.diag(np.linalg.pinv(normal, rcond=1e-12)), 0.0)) / scale
    samples = np.array([sum(len(f.outputs[c].t) for f in problem.flights.flights) for c in problem.channels])
    return np.asarray(plain * np.sqrt(float(np.mean(samples / np.maximum(independent, 1.0)))))


def candidates_for(problem: Problem, fitted: Fitted, variants: Sequence[Variant]) -> list[Screened]:
    """The screening, without the effects the model has already."""
    present = {e.effect for e in fitted.point.effects}
    return Screen(problem, fitted).try_all([v for v in variants if v.effect not in present])


def plausible(judged: Sequence[Judged], believed: FloatArray | None) -> list[Judged]:
    """The ranking with equivalent explanations put into the order that what is known suggests.

    Explanations that fit equally well leave different derivatives behind; the one whose derivatives agree
    with the aircraft file's comes first. Without a file: a vane sits ahead of the centre of gravity,
    so an arm pointing backwards is the accelerometer's.
    """
    if not judged:
        return []
    best = max(j.gain for j in judged)
    leader = next(j.effect for j in judged if j.gain == best)

    def strange(j: Judged) -> float:
        twins = {j.effect, leader} == _ARMS and j.gain > 0.95 * best
        if j.gain < best - _EQUIVALENT and not twins:
            return float("inf")
        if believed is not None:
            size = np.maximum(0.03 * np.abs(believed), np.array([0.05, 0.01, 0.02, 0.3, 0.05, 0.3]))
            return float(np.sum(((j.fitted.point.derivatives - believed) / size) ** 2)) + (best - j.gain)
        return 10.0 if j.effect == "alpha_vane_offset" and j.value[0] < 0.0 else best - j.gain

    ahead = [j for j in judged if np.isfinite(strange(j))]
    ranking = sorted(ahead, key=strange)
    # What the file settles counts as settled; what nothing settles stays a tie.
    settled = len(ranking) > 1 and strange(ranking[1]) > strange(ranking[0]) + _EQUIVALENT
    first = replace(ranking[0], gain=best + 2.0 * _EQUIVALENT if settled else best)
    return [first, *ranking[1:], *(j for j in judged if j not in ahead)]
