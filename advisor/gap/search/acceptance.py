"""Acceptance of an effect: better on held-out manoeuvres, significant, and large enough to matter."""

from dataclasses import dataclass

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.decision import CERTAIN, LEAST_GAIN, LEAST_SIGMA, SIGMAS, Decision
from advisor.gap.effects import effect_named
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.holdout import HeldOut
from advisor.gap.kit.variant import Variant

MOST_EFFECTS = 3
"""Most effects named in one flight. More names in one flight are hardly ever right."""
LEAST_OFFSET_RAD = 0.003
"""Least offset of α that is removed before the fit, and that is named, rad."""
_SET_WITHIN_RAD = 0.0087
"""Prior: largest offset of α without a fault, rad, half a degree. The zero of a vane, and the attitude
reference behind the flight path, are hardly set more exactly. An autopilot's estimate is off by as much."""
_HOLD_OUT = "hold-out"
LEAST_SUPPORT = 1.0
"""Least reduction of the gap on held-out manoeuvres, in standard errors over the manoeuvres. Of two
manoeuvres both must improve."""


@dataclass(frozen=True)
class JudgedAddition:
    """An effect that is judged as an addition to a model."""

    variant: Variant
    fitted: EffectFit
    held_out: HeldOut
    gain: float
    """Gain in log likelihood on held-out manoeuvres, with effective sample sizes, minus k/2 ln N, plus the
    prior terms."""
    removed: float
    """Mean square change of the outputs of held-out manoeuvres, relative to the noise of the instruments."""
    least: float
    """Least value of ``removed`` for acceptance."""
    least_certain: float
    """Least value of ``removed`` where ``gain`` leaves no doubt."""
    smallest: float
    """Least size of the first parameter for acceptance."""
    prior_gain: float
    """Gain in log prior probability, because the derivatives agree better with the aircraft file's."""
    support: float
    """Reduction of the gap on held-out manoeuvres, mean over standard error over the manoeuvres."""
    value: FloatArray
    std: FloatArray
    sigmas: float
    """Number of standard deviations by which the size differs from zero (``uncertainty.sigmas_of``)."""
    sole_maneuver: int | None = None
    """Index of the only manoeuvre that determines the effect; ``gain`` and ``removed`` are then those of the
    fit."""
    with_the_air: bool = False
    """Whether the air moves, and with it the channel that determines the effect."""

    @property
    def effect(self) -> str:
        """Name of the effect in the catalogue."""
        return self.variant.effect

    @property
    def block(self) -> str:
        """Block of the simulator that the effect belongs to."""
        return self.variant.block

    @property
    def is_accepted(self) -> bool:
        """Whether the effect is better on held-out manoeuvres, significant, and large enough to matter."""
        return all(decision.holds for decision in self.decisions)

    @property
    def decisions(self) -> tuple[Decision, ...]:
        """Questions that decide on acceptance; all must hold."""
        certain = self.gain >= CERTAIN
        of_the_file = self.prior_gain >= LEAST_GAIN
        change = 0.0 if of_the_file else self.least_certain if certain else self.least
        size, name = size_of(self.variant, self.value), self.variant.names[0]
        inverse = self.variant.inverted  # The search has the reciprocal of the file's parameter.
        asked = [
            Decision(self.effect, "likelihood", self.gain, self.least_gain, "log likelihood gained"),
            Decision(self.effect, "change", self.removed, change, "mean square change over the noise"),
            Decision(self.effect, "significance", self.sigmas, LEAST_SIGMA, "standard deviations"),
            Decision(self.effect, "size", size, self.smallest, f"of {name}", "" if inverse else name),
            self._range(),
        ]
        if self.is_predictable:
            unit = "standard errors of the gap removed"
            asked.append(Decision(self.effect, _HOLD_OUT, self.support, LEAST_SUPPORT, unit))
        return tuple(asked)

    def _range(self) -> Decision:
        """Return the question whether every parameter lies inside its searched range."""
        at = self._at_an_end()
        inside = 1.0 if at is None else 0.0
        about = () if at is None else (self.variant.names[at], self.variant.bounds[at])
        return Decision(self.effect, "range", inside, 1.0, "inside the searched range", *about)

    @property
    def is_predictable(self) -> bool:
        """Whether other manoeuvres can predict the effect: neither one manoeuvre nor the aircraft file alone
        shows it."""
        return self.sole_maneuver is None and self.prior_gain < LEAST_GAIN

    @property
    def is_supported(self) -> bool:
        """Whether held-out manoeuvres support the effect, as far as they can predict it."""
        return not self.is_predictable or self.support >= LEAST_SUPPORT

    @property
    def is_disputed(self) -> bool:
        """Whether held-out manoeuvres alone reject the effect. Each of them may have another size of it."""
        return all(decision.holds != (decision.name == _HOLD_OUT) for decision in self.decisions)

    @property
    def is_only_small(self) -> bool:
        """Whether its size alone, or how little it changes, rejects the effect."""
        refused = {decision.name for decision in self.decisions if not decision.holds}
        return bool(refused) and refused <= {"size", "change"}

    @property
    def least_gain(self) -> float:
        """Least value of ``gain``. Where the data leave a choice and the file decides, a positive gain is
        enough."""
        if self.with_the_air or self.sole_maneuver is not None:
            # Air speed, throttle and height move with the air too; one manoeuvre alone confirms nothing.
            return CERTAIN
        return 0.0 if self.variant.twin is not None and self.prior_gain >= LEAST_GAIN else LEAST_GAIN

    @property
    def at_its_bounds(self) -> bool:
        """Whether a parameter lies at the end of its range: the shape then only resembles the effect."""
        return self._at_an_end() is not None

    def _at_an_end(self) -> int | None:
        """Return the index of the first parameter at an end of its range; None where all lie inside.

        A bound of zero does not count, because the effect exists without that parameter. Nor does a bound of
        the first parameter, its size: an effect larger than the searched range keeps its name.
        """
        ends = np.array(self.variant.bounds[1:]).reshape(-1, 2)
        near = np.abs(ends - self.value[1:, None]) < 1e-3 * np.ptp(ends, axis=1, keepdims=True)
        near &= ends != 0.0
        if self.variant.one_sided or not np.any(near):
            return None
        return 1 + int(np.argmax(np.any(near, axis=1)))

    @property
    def large_enough(self) -> bool:
        """Whether the size is at least the physical minimum."""
        return size_of(self.variant, self.value) >= self.smallest


def least_offset_rad(std_rad: float, derived: bool = False, alone: bool = True) -> float:
    """Return the least offset of α in rad that is named, given its standard deviation.

    Parameters
    ----------
    derived
        Whether α is an autopilot's estimate.
    alone
        Whether no cause other than moving air was found.
    """
    least = _SET_WITHIN_RAD if derived or not alone else LEAST_OFFSET_RAD
    return max(least, SIGMAS * std_rad)


def size_of(variant: Variant, value: FloatArray) -> float:
    """Return the size of an effect that is compared with its physical minimum."""
    # Ice reduces lift: a change that keeps the lift slope is another effect.
    return float(-value[0] if effect_named(variant.effect).takes else abs(value[0]))
