"""Changes from one manoeuvre to the next: a ramp in time, or a step at a time nobody noted."""

from collections.abc import Callable

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.candidates.variant import Values, Variant
from advisor.gap.records.flights import Flights
from advisor.gap.simulator.layout import INDEX

Change = Callable[[FloatArray, FloatArray], None]
"""Change driving numbers (manoeuvres, entries), given the relative change of each manoeuvre."""


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
    t = starts_of(flights)
    span = max(float(t[-1] - t[0]), 1.0)

    def ramp(p: FloatArray, values: Values, _: Flights) -> None:
        change(p, values[0] * (t - t[0]))

    found = [
        Variant(
            effect,
            block,
            ("rate_per_s",),
            ((0.0,),),
            (0.005 / span,),
            ((-0.9 / span, 3.0 / span),),
            0.01 / span,
            apply_with=ramp,
        )
    ]
    for j, at_s in breaks(flights):

        def step(p: FloatArray, values: Values, _: Flights, j: int = j) -> None:
            change(p, np.where(np.arange(len(p)) >= j, values[0], 0.0))

        found.append(
            Variant(
                effect,
                block,
                ("step",),
                ((0.0,),),
                (0.005,),
                ((-0.9, 3.0),),
                0.01,
                apply_with=step,
                fixed={"at_s": at_s},
            )
        )
    return found
