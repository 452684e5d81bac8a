"""Motion of the command between its stamps: held or linear."""

from dataclasses import replace

import numpy as np

from advisor.gap.effects.actuator_lag import LAG
from advisor.gap.effects.transport_delay import DELAY
from advisor.gap.fitting.fit import EffectFit, evidence_of, fit
from advisor.gap.fitting.problem import EffectProblem, counts
from advisor.gap.search.screen import Screen

_SLIGHT_S = 0.005
"""Numerical: starting value of a delay or lag in its fit, s."""


def read_command(linear: EffectProblem, fitted: EffectFit) -> tuple[EffectProblem, EffectFit]:
    """Return the baseline model with the command held or linear between stamps, whichever the data favour.

    A held command looks like a linear one with a delay of half an interval. The linear command may have a
    delay and a lag, at their price (Schwarz). The held command is chosen if it explains more without a delay
    and a lag. Otherwise half an interval is added to the delay's error.
    """
    best = min(Screen(linear, fitted).quick_fits((DELAY, LAG)), key=lambda s: s.cost, default=None)
    if best is None:
        return linear, fitted
    other = LAG if best.variant is DELAY else DELAY
    held, plainly_held = read_otherwise(linear, fitted)
    as_linear, as_held = evidence_of(linear, fitted), evidence_of(held, plainly_held)
    price = float(np.log(np.sum(counts(linear))))
    if as_linear <= as_held and fitted.cost - best.cost < 2.0 * price:
        return linear, fitted
    late = fit(linear, best.point.with_effect(other, (_SLIGHT_S,)), best.noise, 8)
    is_held = as_held < min(as_linear, evidence_of(linear, late) + 2.0 * price)
    return (held, plainly_held) if is_held else (linear, fitted)


def read_otherwise(problem: EffectProblem, fitted: EffectFit) -> tuple[EffectProblem, EffectFit]:
    """Return the baseline model with the other motion of the command: held instead of linear, or the
    reverse."""
    other = replace(problem, held=not problem.held)
    return other, fit(other, fitted.point, fitted.noise)
