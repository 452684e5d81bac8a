"""Between its stamps: was the command held, or did it move linearly?"""

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from advisor.gap.candidates import input
from advisor.gap.candidates.traits import KINKED
from advisor.gap.fitting.fit import Fitted, evidence_of, fit
from advisor.gap.fitting.neighbourhood import Neighbourhood
from advisor.gap.fitting.problem import Problem, counts
from advisor.gap.search.merit import LEAST_GAIN
from advisor.gap.search.screen import Screen
from advisor.gap.search.stage import only

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
_SEVERAL = 2
"""Effects from which on another reading may do with fewer."""
_LIKELIER = 12.0
"""Twice the log likelihood by which a whole diagnosis with a held command must be the better one."""
_KINKED = 500.0
"""The same by which the other reading may seem the worse one before the search for its own effects, beside
one that is not linear: from where such an effect was found a fit does not find its way to the end."""


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


def may_be_held(problem: Problem, fitted: Fitted, seen: Collection[str]) -> bool:
    """Whether a command read as linear shows the half interval by which a held one is later.

    As a delay, or up to a whole interval before a servo that moves no faster than some rate: it would have
    begun when the command left its old value. Or as a lag, or in the stamps of sensors, which are as late as
    that beside a command read too early. ``fitted`` has all effects that were named, ``seen`` are those and
    what came near to being the first.
    """
    if problem.held:
        return False
    # The few milliseconds of latency that any model has may hold a part of it, and run out.
    late = _is_of_a_stamp(problem, _delay_of(fitted)) or _latency_of(fitted) >= input.LATENCY.bounds[0][1]
    return (late and not KINKED.isdisjoint(seen)) or _is_out_of_step(problem, fitted)


def may_be_linear(problem: Problem, fitted: Fitted) -> bool:
    """Whether a command read as held shows the half interval by which a linear one is sooner.

    Several sensors seem out of step then, where one of them is.
    """
    if not problem.held or sum(not effect.always for effect in fitted.point.effects) < _SEVERAL:
        return False
    return _is_out_of_step(problem, fitted)


def may_pay(problem: Problem, fitted: Fitted, seen: Collection[str]) -> bool:
    """Whether the other reading may win: the effects that were named are fitted with it, none is sought.

    It may do without some of them, each of which has its price; nothing else makes it the better one.
    ``fitted`` and ``seen`` as in ``may_be_held``.
    """
    named = [effect.effect for effect in fitted.point.effects if not effect.always]
    other = replace(problem, held=not problem.held)
    same = _with_latency(other, only(other, fitted, named))
    more = evidence_of(other, same) - evidence_of(problem, fitted)
    return more < (_KINKED if not KINKED.isdisjoint(seen) else len(named) * _price_of_one(problem))


def read_otherwise(problem: Problem, fitted: Fitted) -> tuple[Problem, Fitted]:
    """The plain model with the command held between its stamps instead of linear, or the reverse."""
    other = replace(problem, held=not problem.held)
    return other, _with_latency(other, fit(other, fitted.point, fitted.noise))


def is_likelier_held(linear: Problem, named: Fitted, held: Problem, named_held: Fitted) -> bool:
    """Whether all that was named with a held command describes the data better, and without a delay.

    It must have named what no delay or lag imitates, need no sensor or servo that is late by what the linear
    reading shifts, where that needs one, or do with fewer effects, each of which has its price: between those
    two readings ``read_command`` decides.
    """
    if _delay_of(named_held) > 0.0:
        return False
    more = evidence_of(held, named_held) - evidence_of(linear, named)
    bends = any(effect.effect in KINKED for effect in named_held.point.effects)
    bends = bends and not _is_the_ramp(held, named_held)
    in_step = _is_out_of_step(linear, named) and not _is_out_of_step(held, named_held)
    in_step = in_step and len(named_held.point.effects) <= len(named.point.effects)
    return ((bends or in_step) and more < -_LIKELIER) or is_plainer(linear, named, held, named_held)


def is_plainer(one: Problem, named: Fitted, other: Problem, named_there: Fitted) -> bool:
    """Whether the other reading does with fewer effects, each of which must bring more than its price."""
    fewer = len(named.point.effects) - len(named_there.point.effects)
    more = evidence_of(other, named_there) - evidence_of(one, named)
    return fewer > 0 and more < fewer * _price_of_one(one)


def _price_of_one(problem: Problem) -> float:
    """Twice the log likelihood that an effect must bring."""
    return float(np.log(np.sum(counts(problem)))) + 2.0 * LEAST_GAIN


def _is_the_ramp(held: Problem, fitted: Fitted) -> bool:
    """Whether a servo at its limit takes no longer for a usual step than from one stamp to the next.

    That is what a linear command does by itself.
    """
    effects = zip(fitted.point.effects, fitted.point.values, strict=True)
    slowness_s_rad = next((float(v[0]) for e, v in effects if e.effect == "actuator_rate_limit"), np.inf)
    steps, intervals = np.vstack([flight.edges[:, 1:3] for flight in held.flights.flights]).T
    return float(np.median(np.abs(steps) / intervals**2)) * slowness_s_rad < 1.0


def _is_out_of_step(problem: Problem, fitted: Fitted) -> bool:
    """Whether a lag of the servo or a skew of a sensor is what another reading of the command shifts."""
    effects = zip(fitted.point.effects, fitted.point.values, strict=True)
    return any(
        _is_of_a_stamp(problem, abs(float(values[0])))
        for effect, values in effects
        if effect.names[0] == "skew_s" or effect.effect == "actuator_lag"
    )


def _is_of_a_stamp(problem: Problem, time_s: float) -> bool:
    """Whether a time is between half an interval of the command and a whole one."""
    interval = float(np.median(np.diff(problem.flights.flights[0].t_u)))
    return 0.5 * interval - _HALF_S < time_s < interval + _HALF_S


def _latency_of(fitted: Fitted) -> float:
    return float(fitted.point.values[fitted.point.effects.index(input.LATENCY)][0])


def _delay_of(fitted: Fitted) -> float:
    delays = zip(fitted.point.effects, fitted.point.values, strict=True)
    return sum(float(values[0]) for effect, values in delays if effect.effect == "transport_delay")


def _with_latency(problem: Problem, fitted: Fitted) -> Fitted:
    """The fit, begun again where another latency is better: steps make the cost rough in it.

    Within the few milliseconds of its bounds the latency passes stamps, and each may hold a minimum.
    """
    lower, upper = input.LATENCY.bounds[0]
    points = [
        replace(fitted.point, values=(np.array([latency]), *fitted.point.values[1:]))
        for latency in np.arange(lower, upper + 1e-9, 1e-3)
    ]
    places = Neighbourhood(problem, fitted).at_all(points)
    best = min((place for place in places if place is not None), key=lambda place: place.cost)
    if best.cost > fitted.cost - 1.0:
        return fitted
    again = fit(problem, best.point, fitted.noise)
    return again if again.cost < fitted.cost else fitted
