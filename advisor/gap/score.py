"""What an effect adds to a model, judged on manoeuvres that the fit has not seen."""

from dataclasses import dataclass

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.belief import odds_of_arm
from advisor.gap.fit import Fitted, rms_of
from advisor.gap.floor import doubts
from advisor.gap.holdout import HeldOut, hold_out, lone_witness, mean_squares
from advisor.gap.problem import Problem, counts
from advisor.gap.uncertainty import belief_in, shared_std
from advisor.gap.variant import Variant

LEAST_GAIN = 6.0
"""Log likelihood, on held-out manoeuvres and after the price of its numbers, that an effect must bring."""
_UNCONFIRMED = 20.0
"""The same of what a single manoeuvre tells, which no other can confirm."""
_WITH_THE_AIR = 30.0
"""The same in moving air of what air speed, throttle or height tell: they move with the air themselves ..."""
_PLAINLY, _PLAIN_SIGMAS = 15.0, 5.0
"""... unless nothing else was named, it changes ten times the least, and a number is as far from nothing."""
LEAST_GAP = 0.05
"""What it must change there, mean square over the noise of the instruments, averaged over channels."""
LEAST_SIGMA = 3.0
_CERTAIN, _FAINT = 30.0, 0.15
"""Log likelihood from which on a share of it is enough, where the air is still and nothing else there ..."""
_BY_NATURE = frozenset(
    {
        "elevator_nonlinearity", "nonlinear_pitching_moment", "nonlinear_lift", "unsteady_lift", "alpha_dot",
        "icing", "structural_mode", "airspeed_variation", "thrust_moment", "ground_effect",
    }
)  # fmt: skip
"""... but for what every aircraft has to some degree, or what takes its shape; and times must be
twice the least, and steps that may have come between any two manoeuvres."""
_OF_PEAK = 0.003
"""Share of each channel's peak that an effect must change."""
TIMES = frozenset({"delay_s", "lag_s", "skew_s"})
"""Parameters that are times."""
TIME_DOUBT_S = 0.0006
"""Error of a delay, lag or skew for the simulation's grid and the stamps' resolution."""
_ANY_TIME = 1.5
"""Physical minima that a step must reach which may have come between any two manoeuvres."""
_JITTERS = 3.0
"""Standard deviations of the stamps by which a time must exceed its physical minimum, besides."""
_PLAIN_GAIN, _PLAIN_CHANGE = 100.0, 10.0
"""Log likelihood, and changes of the least size, from which on twice the physical minimum is enough."""
_NOT_SEEN = 0.005
"""Difference of two predictions, mean square beside the instruments' noise, that no flight shows."""
LEAST_BELIEF = 8.0
"""Log probability by which an effect must bring derivatives back to the file's to be named for that alone."""
_SUPPORT = 4.0
"""The same of an effect that is certain anyway."""


@dataclass(frozen=True)
class Judged:
    """One effect as an addition to a model."""

    variant: Variant
    fitted: Fitted
    held_out: HeldOut
    gain: float
    """Held-out log likelihood gained, coloured residuals at their worth, minus k/2 ln N, plus belief."""
    removed: float
    """What it changes in the outputs of manoeuvres kept out, mean square beside the instruments' noise."""
    least: float
    """What ``removed`` must exceed ..."""
    least_certain: float
    """... and what it must exceed where ``gain`` leaves no doubt."""
    smallest: float
    """Size below which it is not worth a name."""
    belief: float
    """Log probability gained because the derivatives it leaves agree better with the file's."""
    beforehand: float
    """What of ``gain`` is not the motion's: belief, the odds of an arm, less the price of its numbers."""
    value: FloatArray
    std: FloatArray
    witness: int | None = None
    """The manoeuvre that alone tells of it: ``gain`` and ``removed`` are the fit's own."""
    with_the_air: bool = False
    """The air moves, and with it the channel that tells of the effect."""
    alone: bool = True
    """Nothing else was named before."""

    @property
    def effect(self) -> str:
        """Name in the catalogue."""
        return self.variant.effect

    @property
    def worth_naming(self) -> bool:
        """Better on unseen manoeuvres, by more than noise, and not smaller than matters."""
        certain = self.gain >= _CERTAIN
        least = self.least_certain if certain else self.least
        supported = self.belief >= (_SUPPORT if certain else LEAST_BELIEF)
        if self.gain < self.least_gain or not (supported or self.removed >= least):
            return False
        return self.sigmas > LEAST_SIGMA and self.large_enough and not self.at_its_bounds

    @property
    def sigmas(self) -> float:
        """Standard deviations by which a number of it differs from nothing."""
        return float(np.max(np.abs(self.value) / np.maximum(self.std, 1e-300)))

    @property
    def least_gain(self) -> float:
        """What ``gain`` must reach; where data leave a choice and the file tells, likelier is enough."""
        confirmed = LEAST_GAIN if self.witness is None else _UNCONFIRMED
        if self.with_the_air:
            plain = self.alone and self.removed >= _PLAIN_CHANGE * self.least and self.sigmas > _PLAIN_SIGMAS
            return max(confirmed, _PLAINLY) if plain else _WITH_THE_AIR
        if self.witness is not None:
            return confirmed
        return 0.0 if self.variant.twin is not None and self.belief >= LEAST_BELIEF else LEAST_GAIN

    @property
    def at_its_bounds(self) -> bool:
        """The search ran out of its range: a shape that only resembles the effect.

        A bound at zero is none: the effect does without that number, as an engine without a lag.
        """
        ends = np.array(self.variant.bounds[1:]).reshape(-1, 2)
        near = np.abs(ends - self.value[1:, None]) < 1e-3 * np.ptp(ends, axis=1, keepdims=True)
        near &= ends != 0.0
        return bool(np.any(near)) and not self.variant.one_sided

    @property
    def large_enough(self) -> bool:
        """At or above the physical minimum; stamps that jitter hide no time that is plain all the same."""
        plain = self.gain >= _PLAIN_GAIN and self.removed >= _PLAIN_CHANGE * self.least
        smallest = min(self.smallest, 2.0 * self.variant.smallest) if plain else self.smallest
        return size_of(self.variant, self.value) >= smallest


def size_of(variant: Variant, value: FloatArray) -> float:
    """The number of an effect that its physical minimum is about."""
    if variant.effect == "icing":
        # The lift slope and the stability; the elevator's share of the lift is hardly ever known.
        return float(np.max(np.abs(value[[0, 2]])))
    return float(abs(value[0]))


def smallest_of(problem: Problem, variant: Variant) -> float:
    """Size of an effect's first parameter below which it is not worth a name, the stamps as they are."""
    if variant.names[0] in TIMES:
        return variant.smallest + TIME_DOUBT_S + _JITTERS * problem.jitter_s
    return variant.smallest * (_ANY_TIME if "at_s" in variant.fixed else 1.0)


def addition(
    problem: Problem,
    before: Fitted,
    held_before: HeldOut,
    fitted: Fitted,
    effect: str,
    independent: FloatArray,
) -> Judged:
    """What an effect of a fitted model adds to the model without it."""
    point = fitted.point
    k = [v.effect for v in point.effects].index(effect)
    variant, value = point.effects[k], point.values[k]
    at = len(point.derivatives) + sum(len(v) for v in point.values[:k])
    held = hold_out(problem, fitted)
    # Throttle or height may have moved in one manoeuvre only: kept out, the others know nothing of it.
    witness = lone_witness(problem, fitted, at) if variant.needs else None
    lone = witness is not None
    seen_before, seen_after = (before, fitted) if lone else (held_before, held)
    likelihood = log_likelihood_gained(before, held_before, fitted, held, independent, unconfirmed=lone)
    likelihood += 0.5 * (price_of_edges(problem, before) - price_of_edges(problem, fitted))
    numbers = len(variant.names) + (1 if variant.fixed else 0)
    price = 0.5 * numbers * float(np.log(np.sum(independent)))
    belief = belief_in(problem, fitted, independent) - belief_in(problem, before, independent)
    odds = odds_of_arm(variant.effect, float(value[0]), problem.stated, problem.flights.alpha_is_derived)
    least, beforehand = least_change(problem), belief + odds - price
    return Judged(
        variant=variant, fitted=fitted, held_out=held,
        gain=likelihood + beforehand,
        removed=difference(problem, seen_before, seen_after, witness),
        least=least, least_certain=least * _share_enough(problem, before, variant, value),
        smallest=smallest_of(problem, variant),
        belief=belief, beforehand=beforehand, value=value, witness=witness,
        with_the_air=bool(variant.needs) and problem.knows_the_noise, alone=_is_alone(before),
        std=shared_std(problem, fitted, independent, trusted=belief >= LEAST_BELIEF)[at : at + len(value)],
    )  # fmt: skip


def log_likelihood_gained(
    before: Fitted,
    held_before: HeldOut,
    after: Fitted,
    held_after: HeldOut,
    independent: FloatArray,
    unconfirmed: bool = False,
) -> float:
    """What was gained on manoeuvres kept out, but by luck not more than in the fit itself.

    ``unconfirmed``: no other manoeuvre could confirm it, so the fit is asked alone.
    """
    ratios = [np.log((before.noise / after.noise) ** 2)]
    if not unconfirmed:
        ratios.append(np.log(held_before.innovations / held_after.innovations))
    return min(float(np.sum(independent / 2.0 * r)) for r in ratios)


def _share_enough(problem: Problem, before: Fitted, variant: Variant, value: FloatArray) -> float:
    """Of the least change: what is enough where an effect is certain."""
    if not _is_alone(before) or problem.knows_the_noise or variant.effect in _BY_NATURE:
        return 1.0
    times = 2.0 if variant.names[0] in TIMES or variant.fixed else 1.0
    return _FAINT if size_of(variant, value) >= times * smallest_of(problem, variant) else 1.0


def _is_alone(before: Fitted) -> bool:
    """Whether the model has nothing yet that is anyone's fault."""
    return all(effect.always for effect in before.point.effects)


def price_of_edges(problem: Problem, fitted: Fitted) -> float:
    """What the cost has beside noise and belief: edges and air speeds off where they likely were.

    A wrong model buys some of its fit by shifting them.
    """
    noise = float(np.sum(counts(problem) * 2.0 * np.log(fitted.noise)))
    return fitted.cost - noise - problem.disbelief(fitted.point)


def least_change(problem: Problem) -> float:
    """Mean square change of the outputs, beside the instruments' noise, from which an effect is worth a name.

    Where instruments are very good, what matters is no longer their noise: a description to low order is
    itself no better than a share of each channel's peak.
    """
    if problem.instruments is None:
        return LEAST_GAP
    return max(LEAST_GAP, float(_OF_PEAK**2 / np.mean((problem.instruments / problem.flights.peaks) ** 2)))


def predict_alike(problem: Problem, one: HeldOut, other: HeldOut) -> bool:
    """Whether two predictions differ by next to nothing, or by what a description to low order may err."""
    apart = rms_of(problem, [a - b for a, b in zip(one.left, other.left, strict=True)])
    return (
        bool(np.all(apart < _OF_PEAK * problem.flights.peaks)) or difference(problem, one, other) < _NOT_SEEN
    )


def difference(
    problem: Problem, before: HeldOut | Fitted, after: HeldOut | Fitted, only: int | None = None
) -> float:
    """Mean over channels of the squared change of the prediction, beside the noise that may be doubted.

    ``only``: in this manoeuvre, where no other tells of it.
    """
    changed = mean_squares(problem, [a - b for a, b in zip(before.left, after.left, strict=True)])
    noise = 1.0 if problem.instruments is None else problem.instruments * doubts(problem.flights)
    power = np.mean(changed, axis=0) if only is None else changed[only]
    return float(np.mean(power / noise**2))
