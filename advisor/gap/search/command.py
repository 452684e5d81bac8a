"""The motion of the command between its stamps: held or linear."""

from dataclasses import replace

import numpy as np

from advisor.gap.candidates.nuisances import LOOP
from advisor.gap.effects.actuator_lag import LAG
from advisor.gap.effects.transport_delay import DELAY
from advisor.gap.fitting.fit import EffectFit, evidence_of, fit
from advisor.gap.fitting.problem import EffectProblem, counts
from advisor.gap.search.screen import Screen

_NEARLY = 0.25
"""Largest share of the gain from delay, lag and the right reading that a held command may miss without
them."""
_LOOKS_HELD = 0.3
"""Largest missing share where delay and lag amount to half an interval together. With a real delay a third
would be missing: the variance of edges anywhere in an interval, relative to the square of half of it."""
_ALL_LATE_ALIKE = 0.05
"""Largest missing share where delay and lag amount to between half an interval and a whole one. Edges
anywhere in their intervals would leave more."""
_HALF_S = 0.003
"""Tolerance in s for a delay of half an interval."""


def read_command(linear: EffectProblem, fitted: EffectFit) -> tuple[EffectProblem, EffectFit]:
    """Return the baseline model with the command held or linear between its stamps, as the data decide.

    The choice is made with a delay and a lag in the model. Otherwise a held command would pass for a delay of
    half an interval, and a delay for a held command.
    """
    best = min(Screen(linear, fitted).quick_fits((DELAY, LAG)), key=lambda s: s.cost, default=None)
    if best is None:
        return linear, fitted
    other = LAG if best.variant is DELAY else DELAY
    held, plainly_held = read_otherwise(linear, fitted)
    plain = {False: evidence_of(linear, fitted), True: evidence_of(held, plainly_held)}
    price = 2.0 * float(np.log(np.sum(counts(linear))))
    if plain[False] <= plain[True] and fitted.cost - best.cost < price:
        return linear, fitted
    both_linear = fit(linear, best.point.with_effect(other, (0.005,)), best.noise, 8)
    # A held command responds half an interval later than a linear one.
    half = 0.5 * float(np.median(np.diff(linear.flights.flights[0].t_u)))
    sooner = max(float(best.point.values[-1][0]) - half, 0.002)
    less = fitted.point.with_effect(best.variant, (sooner,)).with_effect(other, (0.005,))
    both_held = fit(held, less, best.noise, 8)
    both = {False: evidence_of(linear, both_linear), True: evidence_of(held, both_held)}
    best_of_all = min(*plain.values(), *both.values())
    # Held with a delay d, and linear with d plus half an interval, give equal motions. The held reading is
    # chosen where it needs no delay; otherwise half an interval goes into the delay's error.
    near = best_of_all + _NEARLY * (max(plain.values()) - best_of_all)
    is_held = plain[True] < min(near, plain[False], both[False] + price)
    # A held command looks like a delay of half an interval when edges are free to explain the rest.
    late = sum(float(values[0]) for values in both_linear.point.values[-2:])
    nearly = best_of_all + _LOOKS_HELD * (max(plain.values()) - best_of_all)
    looks_held = abs(late - half) < _HALF_S and plain[True] < min(nearly, plain[False])
    # The case with a lag in addition: held, the lag is enough; linear, half an interval of delay is needed
    # too.
    delays = {p.held: _delay_of(f) for p, f in ((linear, both_linear), (held, both_held))}
    without_delay = delays[True] < _HALF_S and abs(delays[False] - half) < _HALF_S
    # Steps of a fast loop, all at one place of their interval, are late by up to a whole interval together.
    in_step = half - _HALF_S < late < 2.0 * half + LOOP.bounds[0][1]
    nearest = best_of_all + _ALL_LATE_ALIKE * (max(plain.values()) - best_of_all)
    steps_alike = in_step and plain[True] < min(nearest, plain[False])
    if is_held or looks_held or steps_alike or (without_delay and both[True] < both[False] + price):
        return held, plainly_held
    return linear, fitted


def read_otherwise(problem: EffectProblem, fitted: EffectFit) -> tuple[EffectProblem, EffectFit]:
    """Return the baseline model with the other reading of the command: held instead of linear, or the
    reverse."""
    other = replace(problem, held=not problem.held)
    return other, fit(other, fitted.point, fitted.noise)


def _delay_of(fitted: EffectFit) -> float:
    delays = zip(fitted.point.effects, fitted.point.values, strict=True)
    return sum(float(values[0]) for effect, values in delays if effect.effect == DELAY.effect)
