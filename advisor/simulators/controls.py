"""Controls other than the elevator, as a manoeuvre was flown."""

from collections.abc import Mapping, Sequence

import numpy as np

from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.messages import FloatArray
from advisor.gap.records.flights import PreparedManeuver
from advisor.simulators.protocol import CONTROLS


def other_controls(
    flights: Sequence[PreparedManeuver], maneuvers: Sequence[Maneuver]
) -> Mapping[int, Mapping[str, FloatArray]]:
    """Return the logged controls of ``CONTROLS`` by manoeuvre number, each of shape (n,) on its grid.

    Values are departures from the mean before the first step of the elevator.
    """
    by_number = {m.number: m for m in maneuvers}
    return {flight.number: _departures(flight, by_number[flight.number]) for flight in flights}


def _departures(flight: PreparedManeuver, maneuver: Maneuver) -> Mapping[str, FloatArray]:
    middles = (np.arange(flight.n) + 0.5) * flight.h
    before = middles < max(flight.first_step_s, flight.h)
    found = {}
    for name in CONTROLS:
        channel = maneuver.channels.get(name)
        if channel is not None and len(channel) > 1:
            y = np.interp(middles, channel.t - flight.started_s, channel.y)
            found[name] = y - float(np.mean(y[before]))
    return found
