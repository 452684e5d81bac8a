"""The columns of the evidence: names, units, and the scale on which the judge weighs each of them."""

import math
from collections.abc import Callable
from dataclasses import dataclass

from advisor.gap.alternative import Column


def _as_is(value: float) -> float:
    return value


def _folded(value: float) -> float:
    """Return the signed logarithm of 1 + |value|: linear below one unit, logarithmic far above."""
    return math.copysign(math.log1p(abs(value)), value)


def _figures(value: float) -> str:
    """Return three digits, never in powers of ten below ten million."""
    return f"{value:,.0f}" if 1e3 <= abs(value) < 1e7 else f"{value:.3g}"


@dataclass(frozen=True, slots=True)
class Quantity:
    """One column of the evidence. A value of zero means that the alternative has no such evidence."""

    name: str
    unit: str
    words: str
    """The quantity in words, as the subject of a sentence."""
    scale: Callable[[float], float] = _as_is
    """The value as the judge weighs it."""

    def column(self, value: float) -> Column:
        """Return the column with a value, and its sentence."""
        return Column(self.name, value, self.unit, f"The {self.words} is {self.written(value)}.")

    def written(self, value: float) -> str:
        """Return a value with its unit."""
        return f"{_figures(value)} {self.unit}".rstrip()

    def compared(self, value: float, other: float) -> str:
        """Return two values with their unit; one where they read as equal."""
        first, second = _figures(value), _figures(other)
        return self.written(value) if first == second else f"{first} against {second} {self.unit}".rstrip()


QUANTITIES: tuple[Quantity, ...] = (
    Quantity("answer", "", "mark of the answer that the search ends with"),
    Quantity("tried", "", "mark of an alternative that this flight can show"),
    Quantity("screen_gain", "nats", "gain in the quick fit, less the price of parameters", _folded),
    Quantity("screen_share", "", "gain in the quick fit relative to the best alternative"),
    Quantity("screen_lead", "", "lead in the quick fit over the best other alternative"),
    Quantity("file_agreement", "nats", "gain in agreement with the file's derivatives", _folded),
    Quantity("fit_gain", "nats", "gain in the full fit, less the price of parameters", _folded),
    Quantity("fit_share", "", "gain in the full fit relative to the best alternative"),
    Quantity("heldout_gain", "nats", "gain on held-out manoeuvres", _folded),
    Quantity("heldout_sigmas", "standard errors", "held-out gain over its error over manoeuvres", _folded),
    Quantity("support", "standard errors", "gap removed on held-out manoeuvres over its error", _folded),
    Quantity("gap_removed", "", "share of the held-out gap that the cause removes"),
    Quantity("change", "", "change of the motion over the least visible one", _folded),
    Quantity("size_sigmas", "standard deviations", "size over its standard deviation", _folded),
    Quantity("size", "", "size over the smallest physical size", _folded),
    Quantity("at_bound", "", "mark of a parameter at the end of its range"),
    Quantity("model_gain", "nats", "loss of the final model without the cause", _folded),
    Quantity("model_share", "", "share of what the final model's effects remove"),
    Quantity("misfit", "", "largest misfit of the final model, over the noise", _folded),
    Quantity("misfit_alpha", "", "misfit of the final model in the angle of attack, over the noise", _folded),
    Quantity("misfit_q", "", "misfit of the final model in the pitch rate, over the noise", _folded),
    Quantity("misfit_a_z", "", "misfit of the final model in the acceleration, over the noise", _folded),
    Quantity("misfit_theta", "", "misfit of the final model in the attitude, over the noise", _folded),
    Quantity("of_peak", "%", "largest misfit in per cent of a channel's peak", _folded),
    Quantity("activity", "", "misfit while the stick moves over the misfit in quiet flight", _folded),
    Quantity("block_gain", "nats", "gain of a free disturbance in the block", _folded),
    Quantity("block_share", "", "gain of a free disturbance relative to the best block"),
    Quantity("block_left", "nats", "gain of a free disturbance in the block, after the effects", _folded),
    Quantity("block_left_share", "", "gain of a disturbance after the effects, relative to the best block"),
    Quantity("block_explains", "", "share of the residual that a free disturbance explains"),
    Quantity("law_gain", "nats", "gain of the best simple law without a name", _folded),
    Quantity("law_lead", "nats", "lead of the best law without a name over all named effects", _folded),
    Quantity("few_maneuvers", "", "concentration of the residual in a few manoeuvres, as expected"),
    Quantity("shape", "", "mark of the air's course: 1 as expected, -1 otherwise"),
    Quantity("kinematics", "standard deviations", "finding of the kinematics alone", _folded),
    Quantity("kinematic_size", "", "finding of the kinematics over the smallest physical size", _folded),
    Quantity("weight", "", "error of the weight that a sensor reads, over its largest offset", _folded),
    Quantity("estimated", "", "mark of a channel that the autopilot estimates"),
    Quantity("file_gap", "", "gap of the file's derivatives beyond the gap of fitted ones", _folded),
    Quantity(
        "file_distance", "standard deviations", "distance of the file's derivatives from fitted ones", _folded
    ),
    Quantity("drift", "nats", "gain of a steady drift of trims and offsets", _folded),
    Quantity("step", "nats", "gain of a step of trims and offsets", _folded),
)  # fmt: skip
"""All columns, in their order."""
