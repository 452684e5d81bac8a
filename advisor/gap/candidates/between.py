"""Changes from one manoeuvre to the next: a drift, a step at a time nobody noted, or what took a while."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.candidates.variant import Values, Variant
from advisor.gap.records.flights import Flights
from advisor.gap.simulator.layout import INDEX

Change = Callable[[FloatArray, FloatArray], None]
"""Change driving numbers (manoeuvres, entries), given the relative change of each manoeuvre."""

Course = Callable[[FloatArray, Values, FloatArray], None]
"""Change driving numbers, given an effect's own numbers and the share of it that each manoeuvre has."""

_FOR_GRADUAL = 4
"""Manoeuvres that a change needs which begins and ends in flight: with fewer it is a step or a drift."""
_TIME_STEP = 0.02
"""Finite-difference step of when it begins and how long it takes, of the flight."""


def shift_moments(p: FloatArray, by: FloatArray) -> None:
    """Move the centre of gravity: every force of Eq. (1) gets the same further arm in Eq. (2).

    ``by`` is the relative change of M_α.
    """
    arm = by * p[:, INDEX["M_alpha"]] / p[:, INDEX["Z_alpha"]]
    for force, moment in (("Z_alpha", "M_alpha"), ("Z_q", "M_q"), ("Z_delta_e", "M_delta_e")):
        p[:, INDEX[moment]] += arm * p[:, INDEX[force]]


def shift_stability(p: FloatArray, by: FloatArray) -> None:
    """The same as textbooks have it: far behind the wing, tail and elevator hardly notice."""
    p[:, INDEX["M_alpha"]] *= 1.0 + by


def divide(*entries: str) -> Change:
    """Divide these derivatives by 1 + change, as more mass does."""
    columns = [INDEX[name] for name in entries]

    def change(p: FloatArray, by: FloatArray) -> None:
        p[:, columns] /= np.maximum(1.0 + by, 0.1)[:, None]

    return change


def starts_of(flights: Flights) -> FloatArray:
    """Shape (manoeuvres,): vehicle time of each record's start."""
    return np.array([f.started_s for f in flights.flights])


def breaks(flights: Flights) -> list[tuple[int, float]]:
    """Every place a step may hide: index of the first manoeuvre after it, and a time between the two."""
    t = starts_of(flights)
    ends = t + np.array([f.duration_s for f in flights.flights])
    return [(j, float((ends[j - 1] + t[j]) / 2.0)) for j in range(1, len(t))]


def ramps_and_steps(effect: str, block: str, flights: Flights, change: Change) -> list[Variant]:
    """One variant for a steady drift, one for a step at each place between two manoeuvres."""
    if len(flights) < 3:
        return []
    t, span = starts_of(flights), _span_of(flights)
    step = Variant(effect, block, ("step",), ((0.0,),), (0.005,), ((-0.9, 3.0),), 0.01)

    def course(p: FloatArray, values: Values, share: FloatArray) -> None:
        change(p, values[0] * share)

    def drift(p: FloatArray, values: Values, _: Flights) -> None:
        change(p, values[0] * (t - t[0]))

    steady = Variant(
        effect,
        block,
        ("rate_per_s",),
        ((0.0,),),
        (0.005 / span,),
        ((-0.9 / span, 3.0 / span),),
        0.01 / span,
        apply_with=drift,
        likewise=_longer(flights, step, course, lambda rate: (rate[0] * span, float(t[0]), span)),
    )
    return [steady, *steps_in(flights, step, course)]


def steps_in(flights: Flights, one: Variant, course: Course) -> list[Variant]:
    """A step at each place between two manoeuvres; ``one`` has the names, starts and bounds of the change.

    Beside each stands what takes a while, fitted where the step has led: a tank that is pumped over, people
    who move, ice that grows.
    """
    lasts_s = _span_of(flights) / 3.0

    def at(j: int, at_s: float) -> Variant:
        later = (np.arange(len(flights)) >= j).astype(float)
        return replace(
            one,
            apply_with=lambda p, values, _: course(p, values, later),
            fixed={"at_s": at_s},
            likewise=_longer(flights, one, course, lambda v: (*map(float, v), at_s - 0.5 * lasts_s, lasts_s)),
        )

    return [at(j, at_s) for j, at_s in breaks(flights)]


def _longer(
    flights: Flights, one: Variant, course: Course, carried: Callable[[FloatArray], Values]
) -> tuple[Variant, ...]:
    """The change as one that begins in mid-flight and takes a while; none where manoeuvres are too few."""
    if len(flights) < _FOR_GRADUAL:
        return ()
    t, span = starts_of(flights), _span_of(flights)
    gradual = replace(
        one,
        names=(*one.names, "at_s", "over_s"),
        starts=(),
        steps=(*one.steps, _TIME_STEP * span, _TIME_STEP * span),
        bounds=(*one.bounds, (float(t[0] - span), float(t[-1])), (0.05 * span, 2.0 * span)),
        apply_with=lambda p, v, _: course(p, v[:-2], np.clip((t - v[-2]) / v[-1], 0.0, 1.0)),
        carried=carried,
        places=("at_s", "over_s"),
        # One that outlasts the flight is told by its rate alone, whatever the size and however long.
        one_sided=True,
    )
    return (gradual,)


def _span_of(flights: Flights) -> float:
    """Time from the first manoeuvre to the last, in s."""
    t = starts_of(flights)
    return max(float(t[-1] - t[0]), 1.0)
