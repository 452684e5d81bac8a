"""Compile the kernels of the diagnosis once, before a user waits: ``python -m advisor.gap.precompile``."""

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from advisor.gap.candidates.known import base_entries
from advisor.gap.fitting.linear import linearise
from advisor.gap.fitting.problem import EffectProblem, SearchPoint
from advisor.gap.records.prepare import prepare
from advisor.gap.search.baseline import everywhere, prior_derivatives
from advisor.gap.simulator.layout import ENTRIES, LAYOUT, NUISANCES
from advisor.gap.simulator.reading import differences, filtered
from advisor.gap.simulator.right_sides import MOTION, right_sides

_ANY_AIRCRAFT = dict(zip(PARAMETERS, (0.0, -4.0, 0.0, -0.3, 0.0, -30.0, -4.0, -50.0), strict=True))
"""Numerical: parameters of an aircraft that is simulated to compile the kernels."""


def warm_up() -> None:
    """Simulate a tiny flight and filter some samples, so that every kernel is compiled."""
    aircraft = Aircraft(model=_ANY_AIRCRAFT)
    flights = prepare([_pulse(number) for number in (0, 1)], aircraft)
    derivatives = prior_derivatives(aircraft)
    assert derivatives is not None
    problem = EffectProblem(flights, base_entries(aircraft), prior_derivatives=derivatives)
    own = np.zeros((len(flights), len(NUISANCES)))
    point = everywhere(SearchPoint(derivatives, own), flights)
    linearise(problem, point)
    problem.fly_and_read(flights.flights[0], problem.driving(point)[:1])
    right_sides(LAYOUT, np.zeros((2, len(ENTRIES))), np.ones(len(MOTION)), 1.0, np.ones(2), np.ones(2))
    none = np.zeros(2, dtype=np.int64)
    differences(np.ones((4, 2)), np.ones(4), none, np.ones(2))
    filtered(np.ones((1, 4, 4, 2)), 0.005, none, np.asfortranarray(np.ones((2, 3))))


def _pulse(number: int) -> Maneuver:
    """Return a manoeuvre with a pulse of the elevator, whose outputs are noise."""
    t = np.arange(0.0, 5.0, 0.02) + 30.0 * number
    noise = 1e-6 * np.random.default_rng(number).standard_normal((4, len(t)))
    y = dict(zip(("alpha", "q", "a_z", "theta"), noise, strict=True))
    y["elevator"] = np.where((t > t[0] + 1.0) & (t < t[0] + 1.5), -0.02, 0.0)
    y["airspeed"] = np.full(len(t), 25.0)
    channels = {name: Channel(name, t, values, "plan", "measured") for name, values in y.items()}
    span = Span(t[0], t[0] + 1.0, t[0] + 1.5, t[-1], "other", (), "end of log")
    return Maneuver(number + 1, 0, span, channels)


if __name__ == "__main__":
    warm_up()
