"""When an effect is worth a name: better on unseen manoeuvres, beyond noise, not too small to matter."""

from dataclasses import dataclass

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.candidates.traits import TAKES
from advisor.gap.candidates.variant import Variant
from advisor.gap.decision import Decision
from advisor.gap.fitting.fit import Fitted
from advisor.gap.fitting.holdout import HeldOut

MOST_EFFECTS = 3
"""More names in one flight are hardly ever right."""
LEAST_GAIN = 6.0
"""Log likelihood, on held-out manoeuvres and after the price of its numbers, that an effect must bring."""
_UNCONFIRMED = 20.0
"""The same of what a single manoeuvre tells, which no other can confirm."""
_WITH_THE_AIR = 30.0
"""The same in moving air of what air speed, throttle or height tell: they move with the air themselves ..."""
_CLEAR_GAIN, _CLEAR_SIGMAS = 15.0, 5.0
"""... unless nothing else was named, it changes ten times the least, and a number is as far from nothing."""
LEAST_SIGMA = 3.0
"""Standard deviations by which a number of it must differ from nothing."""
CERTAIN = 30.0
"""Log likelihood from which on there is no doubt that something like the effect is there."""
BEYOND_DOUBT, _VISIBLE_CHANGE, _CLEAR_CHANGE = 100.0, 5.0, 10.0
"""Log likelihood, and changes of the least size, from which on stamps that jitter hide no time, and an effect
is more than the shape of the air."""
LEAST_OFFSET_RAD = 0.003
"""Smaller offsets of α are not taken out before the fit, and get no name."""
_SET_WITHIN_RAD = 0.007
"""Smaller ones are a cause only where nothing else is: neither a vane's zero nor an attitude reference, from
which the path is taken, is set much better than within 0.4 deg ..."""
_ESTIMATED_WITHIN_RAD = 0.0087
"""... and an autopilot's estimate is off by up to half a degree by itself: that has no name."""
OFFSET_SIGMAS, _SMALL_OFFSET_SIGMAS = 5.0, 7.0
"""Standard deviations that an offset of α must have to be named, and one that small."""
LEAST_PRIOR_GAIN = 8.0
"""Log probability by which an effect must bring derivatives back to the file's to be named for that alone."""
_PRIOR_GAIN_IF_CERTAIN = 4.0
"""The same of an effect that is certain anyway."""
_HOLD_OUT = "hold-out"
LEAST_SUPPORT = 1.0
"""Standard errors over manoeuvres by which an effect must lower the gap of those kept out: of two, both."""


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
    prior_gain: float
    """Log probability gained because the derivatives it leaves agree better with the file's."""
    prior_terms: float
    """What of ``gain`` is not the motion's: belief, the odds of an arm, less the price of its numbers."""
    support: float
    """Gap that it takes away from a manoeuvre kept out, mean over its standard error over manoeuvres."""
    value: FloatArray
    std: FloatArray
    sigmas: float
    """Standard deviations by which its size differs from nothing (``uncertainty.sigmas_of``)."""
    sole_maneuver: int | None = None
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
    def block(self) -> str:
        """Part of the simulator that it belongs to."""
        return self.variant.block

    @property
    def is_accepted(self) -> bool:
        """Better on unseen manoeuvres, by more than noise, and not smaller than matters."""
        return all(decision.holds for decision in self.decisions)

    @property
    def decisions(self) -> tuple[Decision, ...]:
        """What is asked of an effect before it has a name; all must hold."""
        certain = self.gain >= CERTAIN
        of_the_file = self.prior_gain >= (_PRIOR_GAIN_IF_CERTAIN if certain else LEAST_PRIOR_GAIN)
        change = 0.0 if of_the_file else self.least_certain if certain else self.least
        asked = [
            ("likelihood", self.gain, self.least_gain, "log likelihood gained"),
            ("change", self.removed, change, "mean square change over the noise"),
            ("significance", self.sigmas, LEAST_SIGMA, "standard deviations"),
            ("size", size_of(self.variant, self.value), self.least_size, f"of {self.variant.names[0]}"),
            ("range", 0.0 if self.at_its_bounds else 1.0, 1.0, "inside the searched range"),
        ]
        if self.is_foretold:
            asked.append((_HOLD_OUT, self.support, LEAST_SUPPORT, "standard errors of the gap removed"))
        return tuple(Decision(self.effect, *question) for question in asked)

    @property
    def is_foretold(self) -> bool:
        """Whether other manoeuvres foretell its work: neither that of one alone nor the file's numbers."""
        return self.sole_maneuver is None and self.prior_gain < LEAST_PRIOR_GAIN

    @property
    def is_supported(self) -> bool:
        """Whether manoeuvres kept out support it, as far as they can foretell its work."""
        return not self.is_foretold or self.support >= LEAST_SUPPORT

    @property
    def is_disputed(self) -> bool:
        """Whether manoeuvres kept out alone refuse it: each of them may tell another size."""
        return all(decision.holds != (decision.name == _HOLD_OUT) for decision in self.decisions)

    @property
    def least_gain(self) -> float:
        """What ``gain`` must reach; where data leave a choice and the file tells, likelier is enough."""
        confirmed = LEAST_GAIN if self.sole_maneuver is None else _UNCONFIRMED
        if self.with_the_air:
            return max(confirmed, _CLEAR_GAIN) if self.alone and self.changes_clearly else _WITH_THE_AIR
        if self.sole_maneuver is not None:
            return confirmed
        return 0.0 if self.variant.twin is not None and self.prior_gain >= LEAST_PRIOR_GAIN else LEAST_GAIN

    @property
    def changes_clearly(self) -> bool:
        """Ten times the least change, by a number that is far from nothing."""
        return self.removed >= _CLEAR_CHANGE * self.least and self.sigmas > _CLEAR_SIGMAS

    @property
    def at_its_bounds(self) -> bool:
        """The search ran out of its range: a shape that only resembles the effect.

        A bound at zero is none: the effect does without that number, as an engine without a lag. Nor is one
        of its first number, its size: what is larger than any that is searched for has the name all the same.
        """
        ends = np.array(self.variant.bounds[1:]).reshape(-1, 2)
        near = np.abs(ends - self.value[1:, None]) < 1e-3 * np.ptp(ends, axis=1, keepdims=True)
        near &= ends != 0.0
        return bool(np.any(near)) and not self.variant.one_sided

    @property
    def large_enough(self) -> bool:
        """At or above the physical minimum."""
        return size_of(self.variant, self.value) >= self.least_size

    @property
    def least_size(self) -> float:
        """The physical minimum; stamps that jitter hide no time that is plain all the same."""
        plain = self.gain >= BEYOND_DOUBT and self.removed >= _VISIBLE_CHANGE * self.least
        return min(self.smallest, 2.0 * self.variant.smallest) if plain else self.smallest


def least_offset_rad(std_rad: float, derived: bool = False, alone: bool = True) -> float:
    """Offset of α from which on it has a name, given its error.

    Parameters
    ----------
    derived
        Whether α is an autopilot's estimate.
    alone
        Whether nothing else was found but air that moves.
    """
    least = max(_ESTIMATED_WITHIN_RAD if derived else _SET_WITHIN_RAD, OFFSET_SIGMAS * std_rad)
    if derived or not alone:
        return least
    return min(least, max(LEAST_OFFSET_RAD, _SMALL_OFFSET_SIGMAS * std_rad))


def size_of(variant: Variant, value: FloatArray) -> float:
    """The number of an effect that its physical minimum is about."""
    # Ice takes lift: what leaves the lift slope alone is something else.
    return float(-value[0] if variant.effect in TAKES else abs(value[0]))
