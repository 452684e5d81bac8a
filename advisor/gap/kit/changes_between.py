"""Changes between manoeuvres: a drift, a step at an unknown time, or a gradual change."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from advisor.gap.kit.effect import ANY, Values, Variant
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import INDEX
from advisor.process.arrays import FloatArray

Change = Callable[[FloatArray, FloatArray], None]
"""Function that changes simulator inputs (manoeuvres, entries), given each manoeuvre's relative change."""

Course = Callable[[FloatArray, Values, FloatArray], None]
"""Function that changes simulator inputs, given an effect's parameters and its share in each manoeuvre."""

ONSET = {"rate_per_s": ANY, "step": ANY, "at_s": ANY, "over_s": 0.0}
"""Parameters of a change in the aircraft file, each with its least allowed value."""
_FOR_GRADUAL = 4
"""Least number of manoeuvres for a change that begins and ends in flight. With fewer manoeuvres, a step or a
drift describes the change."""
_TIME_STEP = 0.02
"""Finite-difference step for the begin and the duration of a gradual change, as a share of the flight's
duration."""


def shift_moments(p: FloatArray, by: FloatArray) -> None:
    """Move the centre of gravity: every force of Eq. (1) gets the same additional arm in Eq. (2).

    ``by`` is the relative change of M_α.
    """
    arm = by * p[:, INDEX["M_alpha"]] / p[:, INDEX["Z_alpha"]]
    for force, moment in (("Z_alpha", "M_alpha"), ("Z_q", "M_q"), ("Z_delta_e", "M_delta_e")):
        p[:, INDEX[moment]] += arm * p[:, INDEX[force]]


def shift_stability(p: FloatArray, by: FloatArray) -> None:
    """Change M_α alone, as in textbooks: a shift hardly changes the arms of the distant tail and elevator."""
    p[:, INDEX["M_alpha"]] *= 1.0 + by


def divide(*entries: str) -> Change:
    """Return a function that divides the derivatives of ``entries`` by 1 + change, as additional mass
    does."""
    columns = [INDEX[name] for name in entries]

    def change(p: FloatArray, by: FloatArray) -> None:
        p[:, columns] /= np.maximum(1.0 + by, 0.1)[:, None]

    return change


def starts_of(flights: PreparedManeuvers) -> FloatArray:
    """Return the vehicle time of the start of each record in s, shape (manoeuvres,)."""
    return np.array([f.started_s for f in flights.flights])


def breaks(flights: PreparedManeuvers) -> list[float]:
    """Return every possible time of a step, in s, each at the middle between two manoeuvres."""
    t = starts_of(flights)
    ends = t + np.array([f.duration_s for f in flights.flights])
    return [float(at_s) for at_s in (ends[:-1] + t[1:]) / 2.0]


def ramps_and_steps(effect: str, block: str, flights: PreparedManeuvers, change: Change) -> list[Variant]:
    """Return one variant for a steady drift, and one for a step at each place between two manoeuvres."""
    if len(flights) < 3:
        return []
    began_s, span = float(starts_of(flights)[0]), _span_of(flights)
    step = Variant(effect, block, ("step",), ((0.0,),), (0.005,), ((-0.9, 3.0),), 0.01)

    def course(p: FloatArray, values: Values, share: FloatArray) -> None:
        change(p, values[0] * share)

    def drift(p: FloatArray, values: Values, flown: PreparedManeuvers) -> None:
        change(p, values[0] * (starts_of(flown) - began_s))

    steady = Variant(
        effect, block, ("rate_per_s",), ((0.0,),), (0.005 / span,), ((-0.9 / span, 3.0 / span),),
        0.01 / span, apply_with=drift,
        likewise=_longer(flights, step, course),
    )  # fmt: skip
    return [steady, *steps_in(flights, step, course)]


def steps_in(flights: PreparedManeuvers, variant: Variant, course: Course) -> list[Variant]:
    """Return a step at each place between two manoeuvres, with the names, starts and bounds of ``one``.

    Every step has a gradual change as alternative, fitted from the step's result: fuel that is pumped, people
    who move, ice that grows.
    """

    def at(at_s: float) -> Variant:
        return replace(
            variant,
            apply_with=lambda p, values, flown: course(p, values, (starts_of(flown) > at_s).astype(float)),
            fixed={"at_s": at_s},
            likewise=_longer(flights, variant, course),
        )

    return [at(at_s) for at_s in breaks(flights)]


def _longer(flights: PreparedManeuvers, variant: Variant, course: Course) -> tuple[Variant, ...]:
    """Return the change as a gradual one that begins in flight; empty with too few manoeuvres."""
    if len(flights) < _FOR_GRADUAL:
        return ()
    t, span = starts_of(flights), _span_of(flights)
    gradual = replace(
        variant,
        names=(*variant.names, "at_s", "over_s"),
        starts=(),
        steps=(*variant.steps, _TIME_STEP * span, _TIME_STEP * span),
        bounds=(*variant.bounds, (float(t[0] - span), float(t[-1])), (0.05 * span, 2.0 * span)),
        apply_with=lambda p, v, flown: course(
            p, v[:-2], np.clip((starts_of(flown) - v[-2]) / v[-1], 0.0, 1.0)
        ),
        places=("at_s", "over_s"),
    )
    return (gradual,)


def _span_of(flights: PreparedManeuvers) -> float:
    t = starts_of(flights)
    return max(float(t[-1] - t[0]), 1.0)
