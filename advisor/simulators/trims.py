"""Trimmed flight of simulator and aircraft: angle of attack, elevator, throttle."""

from collections.abc import Mapping, Sequence

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.records.flights import PreparedManeuver, PreparedManeuvers
from advisor.gap.result import TrimDifference
from advisor.simulators.protocol import Replay


def trim_differences(
    flights: PreparedManeuvers, maneuvers: Sequence[Maneuver], replays: Sequence[Replay], aircraft: Aircraft
) -> tuple[TrimDifference, ...]:
    """Return the trims of simulator and aircraft, averaged over the manoeuvres.

    The elevator is included if calibrated, and a control if the simulator reports it.
    """
    by_number = {m.number: m for m in maneuvers}
    flown = [_of_the_flight(f, by_number[f.number], aircraft) for f in flights.flights]
    simulated = [{"alpha": float(replay.alpha[0]), **replay.trim} for replay in replays]
    found = []
    for name in ("alpha", "elevator", "throttle"):
        pairs = [(s[name], f[name]) for s, f in zip(simulated, flown, strict=True) if name in s and name in f]
        if pairs:
            theirs, ours = np.array(pairs).T
            std = float(np.std(theirs - ours) / np.sqrt(len(pairs)))
            found.append(TrimDifference(name, float(np.mean(theirs)), float(np.mean(ours)), std))
    return tuple(found)


def _of_the_flight(flight: PreparedManeuver, maneuver: Maneuver, aircraft: Aircraft) -> Mapping[str, float]:
    trim = {"alpha": flight.alpha_trim} if "alpha" in flight.outputs else {}
    if aircraft.elevator.is_calibrated:
        trim["elevator"] = flight.u_trim
    throttle = maneuver.channels.get("throttle")
    if throttle is not None:
        before = throttle.y[throttle.t <= flight.started_s + flight.first_step_s]
        if len(before):
            trim["throttle"] = float(np.mean(before))
    return trim
