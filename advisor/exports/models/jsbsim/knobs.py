"""Values in a corrected aircraft that set its derivatives, and their search.

A lift term also changes the pitching moment by its arm, and any term changes the trim. The aircraft is
corrected and measured repeatedly until each derivative has its target value.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from advisor.exports.models.jsbsim.slopes import COLUMNS, Slopes
from advisor.exports.models.jsbsim.source import AXES, PLAIN, AddedFunction, Factor

ROUNDS = 8
"""Largest number of rounds for the search. Each round of corrections divides the derivatives' error by ten or
more."""
WITHIN = 1e-3
"""Relative error of a derivative below which the search has converged."""


@dataclass(frozen=True)
class Knob:
    """One value in the corrected aircraft that changes one derivative."""

    parameter: str
    change: Factor | AddedFunction
    gain: float
    """Change of the derivative per unit of the value."""

    def turned(self, missing: float) -> "Knob":
        """Return the knob with its value changed to add the missing part of the derivative."""
        return replace(self, change=replace(self.change, value=self.change.value + missing / self.gain))


def knob_for(parameter: str, terms: Sequence[str], first: Slopes, surface: str) -> Knob:
    """Return a knob with a value that changes nothing."""
    axis, variable = AXES[parameter[0]], parameter[2:]
    per_force = first.per_force(parameter[0])
    share = per_force * sum(first.shares[name][COLUMNS.index(variable)] for name in terms)
    if share != 0.0:
        return Knob(parameter, Factor(parameter, axis, tuple(terms), 1.0), share)
    property_ = surface if variable == "delta_e" else PLAIN[variable]
    added = AddedFunction(parameter, axis, 0.0, property_, first.trim[variable])
    return Knob(parameter, added, per_force * first.pressure_psf)


def _turned(knob: Knob, missing: float, first: Slopes, surface: str) -> Knob:
    """Return the knob changed by the derivative's missing part. A knob whose factor is negative becomes a
    function.
    """
    turned = knob.turned(missing)
    if isinstance(turned.change, AddedFunction) or turned.change.value > 0.0:
        return turned
    instead = knob_for(knob.parameter, (), first, surface)
    return instead.turned(missing + (knob.change.value - 1.0) * knob.gain)


def settled(
    knobs: Sequence[Knob],
    first: Slopes,
    targets: Mapping[str, float],
    surface: str,
    measured: Callable[[Sequence[Knob]], Slopes],
) -> tuple[list[Knob], Slopes]:
    """Change the knobs until the aircraft has its target derivatives, for at most ``ROUNDS`` rounds."""
    now, turned = first, list(knobs)
    for _ in range(ROUNDS):
        if not missed(now, targets):
            break
        missing = {p: target - now.derivatives[p] for p, target in targets.items()}
        turned = [_turned(knob, missing[knob.parameter], first, surface) for knob in turned]
        now = measured(turned)
    return turned, now


def missed(now: Slopes, targets: Mapping[str, float]) -> list[str]:
    """Return the derivatives that miss their target values."""
    return [
        p for p, target in targets.items()
        if not math.isclose(now.derivatives[p], target, rel_tol=WITHIN, abs_tol=1e-6)
    ]  # fmt: skip
