"""Between its stamps: was the command held, or did it move linearly?"""

from dataclasses import replace

import numpy as np

from advisor.gap.candidates import input
from advisor.gap.fitting.fit import Fitted, evidence_of, fit
from advisor.gap.fitting.problem import Problem, counts
from advisor.gap.search.screen import Screen

_NEARLY = 0.25
"""Share of what a delay, a lag and the right reading explain which may stay unexplained without them ..."""
_LOOKS_HELD = 0.3
"""... and where delay and lag are half an interval together. A third would be left if they were real: the
variance of edges anywhere in an interval, beside the square of half of it."""
_IN_STEP = 0.05
"""The same where delay and lag are together between half an interval and a whole one: edges anywhere in their
intervals would leave more."""
_HALF_S = 0.003
"""How near to half an interval that is."""


def read_command(linear: Problem, fitted: Fitted) -> tuple[Problem, Fitted]:
    """The plain model, with the command held or linear between its stamps as the data decide.

    The choice is made with a delay and a lag in the model, else a held command would pass for a
    delay of half a sample, or a delay for a held command.
    """
    best = min(
        Screen(linear, fitted).quick_fits((input.DELAY, input.LAG)), key=lambda s: s.cost, default=None
    )
    if best is None:
        return linear, fitted
    other = input.LAG if best.variant is input.DELAY else input.DELAY
    held, plainly_held = read_otherwise(linear, fitted)
    plain = {False: evidence_of(linear, fitted), True: evidence_of(held, plainly_held)}
    price = 2.0 * float(np.log(np.sum(counts(linear))))
    if plain[False] <= plain[True] and fitted.cost - best.cost < price:
        return linear, fitted
    both_linear = fit(linear, best.point.with_effect(other, (0.005,)), best.noise, 8)
    # A held command answers half an interval later than a linear one by itself.
    half = 0.5 * float(np.median(np.diff(linear.flights.flights[0].t_u)))
    sooner = max(float(best.point.values[-1][0]) - half, 0.002)
    less = fitted.point.with_effect(best.variant, (sooner,)).with_effect(other, (0.005,))
    both_held = fit(held, less, best.noise, 8)
    both = {False: evidence_of(linear, both_linear), True: evidence_of(held, both_held)}
    best_of_all = min(*plain.values(), *both.values())
    # Held with a delay d and linear with d plus half an interval are the same motion. The held reading is
    # believed where it needs no delay at all; else the doubt of half an interval goes into the delay's error.
    near = best_of_all + _NEARLY * (max(plain.values()) - best_of_all)
    is_held = plain[True] < min(near, plain[False], both[False] + price)
    # Just half an interval is what a held command looks like when edges are free to take up the rest.
    late = sum(float(values[0]) for values in both_linear.point.values[-2:])
    nearly = best_of_all + _LOOKS_HELD * (max(plain.values()) - best_of_all)
    looks_held = abs(late - half) < _HALF_S and plain[True] < min(nearly, plain[False])
    # The same with a lag besides: held, the lag is enough; linear, it takes half an interval of delay, too.
    delays = {p.held: _delay_of(f) for p, f in ((linear, both_linear), (held, both_held))}
    without_delay = delays[True] < _HALF_S and abs(delays[False] - half) < _HALF_S
    # A fast loop's steps, all at the same place of their interval, are late by up to a whole one together.
    in_step = half - _HALF_S < late < 2.0 * half + input.LATENCY.bounds[0][1]
    nearest = best_of_all + _IN_STEP * (max(plain.values()) - best_of_all)
    steps_alike = in_step and plain[True] < min(nearest, plain[False])
    if is_held or looks_held or steps_alike or (without_delay and both[True] < both[False] + price):
        return held, plainly_held
    return linear, fitted


def read_otherwise(problem: Problem, fitted: Fitted) -> tuple[Problem, Fitted]:
    """The plain model with the command held between its stamps instead of linear, or the reverse."""
    other = replace(problem, held=not problem.held)
    return other, fit(other, fitted.point, fitted.noise)


def _delay_of(fitted: Fitted) -> float:
    delays = zip(fitted.point.effects, fitted.point.values, strict=True)
    return sum(float(values[0]) for effect, values in delays if effect.effect == "transport_delay")
