"""The simulator as given: it flies the recorded inputs next to its linear surrogate."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.candidates.catalogue import variants_for
from advisor.gap.candidates.known import base_entries, with_known
from advisor.gap.effects import EFFECTS
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.result import Trace, TrimDifference
from advisor.gap.simulator.layout import DERIVATIVES, INDEX, OUTPUTS
from advisor.simulators.air import refuse_unknown_air, standard_heights, winds
from advisor.simulators.around import COMMAND
from advisor.simulators.by_log import IdentifiedSimulator
from advisor.simulators.flying import (
    AsGiven,
    Flying,
    Progress,
    added,
    beyond,
    refuse_unmoved,
    refuse_wrong_elevator,
)
from advisor.simulators.improved import EQUATIONS
from advisor.simulators.inputs import other_controls
from advisor.simulators.linear import LinearSimulator
from advisor.simulators.protocol import Condition, Inputs, Replay, Simulator
from advisor.simulators.static_errors import trim_differences
from advisor.simulators.surrogate import Surrogate, entries_of, surrogate_of


@dataclass(frozen=True)
class GivenSimulator:
    """A simulator that has flown the recorded inputs, with its linear surrogate."""

    flying: Flying
    surrogate: Surrogate
    as_flown: Mapping[int, AsGiven]
    """Difference of simulator and surrogate, by manoeuvre number."""
    as_file: Aircraft
    """Aircraft file with the surrogate as its model."""
    replays: Sequence[Replay] = ()
    """Replays of the simulator; empty where the simulator is linear."""
    trims: tuple[TrimDifference, ...] = ()

    def as_logged(self, traces: Sequence[Trace]) -> tuple[Trace, ...]:
        """Return the traces of the logged flight, with those of the simulator in place of its surrogate."""
        logged = []
        for trace in traces:
            as_given = self.as_flown[trace.number]
            t = np.arange(as_given.beyond.shape[1]) * as_given.flight.h
            by = np.interp(trace.t, t, as_given.beyond[OUTPUTS.index(trace.channel)])
            logged.append(
                replace(trace, measured=trace.measured + by, before=trace.before + by, after=trace.after + by)
            )
        return tuple(logged)


def given_of(
    simulator: Simulator,
    flights: PreparedManeuvers,
    maneuvers: Sequence[Maneuver],
    aircraft: Aircraft,
    progress: Progress,
) -> GivenSimulator:
    """Fly the recorded inputs with a simulator, and separate the simulator from its linear surrogate.

    Raises
    ------
    UnusableInputError
        The air of the flight is unknown, or the simulator does not fly.
    """
    heights = standard_heights(maneuvers, aircraft)
    if not isinstance(simulator, LinearSimulator):
        refuse_unknown_air(simulator.description, heights)
    heights_m = {number: height or 0.0 for number, height in heights.items()}
    controls, mass_kg = other_controls(flights.flights, maneuvers), aircraft.reference.mass_kg
    flying = Flying(simulator, flights, heights_m, controls, mass_kg, progress, winds(maneuvers))
    if isinstance(simulator, LinearSimulator):
        surrogate = Surrogate(simulator.derivatives, simulator.reference_m_s or flights.reference_m_s)
        basis = simulator.as_file if isinstance(simulator, IdentifiedSimulator) else aircraft
        return GivenSimulator(flying, surrogate, _linear(flying), replace(basis, simulator=None))
    surrogate, as_flown, replays = _surrogate_and_rest(flying, aircraft)
    as_file = replace(surrogate.aircraft(aircraft), simulator=simulator.description)
    trims = trim_differences(flights, maneuvers, replays, aircraft)
    return GivenSimulator(flying, surrogate, as_flown, as_file, replays, trims)


def _linear(flying: Flying) -> dict[int, AsGiven]:
    """Return the start of every manoeuvre for a linear simulator, which equals its surrogate."""
    rests = ((f, Inputs(np.array([0.5, 1.5]) * f.h, np.zeros(2))) for f in flying.flights.flights)
    begun = [flying.simulator.replay(flying.condition(f), rest) for f, rest in rests]
    return {f.number: AsGiven(f, np.zeros((len(OUTPUTS), f.n + 1))) for f in flying.as_flown(begun)}


def _surrogate_and_rest(
    flying: Flying, aircraft: Aircraft
) -> tuple[Surrogate, dict[int, AsGiven], list[Replay]]:
    """Return the surrogate, every manoeuvre as the simulator flew it, and the replays."""
    flights = flying.flights
    values = with_known(base_entries(aircraft), aircraft.effects, flights, variants_for(flights))
    command = np.zeros_like(values)
    entries = [INDEX[name] for name in COMMAND]
    command[:, entries] = values[:, entries]
    replays = flying.replays(command, held=False)
    refuse_unmoved(flying.simulator.description, replays, flights)
    flown = flying.as_flown(replays)
    surrogate = surrogate_of(flights, flown, replays, command, flying.simulator.linearise(_usual(flying)))
    refuse_wrong_elevator(flying.simulator.description, surrogate.derivatives["M_delta_e"], replays, flights)
    p = entries_of(flights, surrogate.aircraft(aircraft), aircraft.effects)
    if any(EFFECTS[effect].block in EQUATIONS for effect in aircraft.effects):
        as_given = np.array([surrogate.derivatives[name] for name in DERIVATIVES])
        replays = flying.replays(command, False, added(flown, p, as_given))
    grids = beyond(flying, replays, p)
    return surrogate, {f.number: AsGiven(f, grid) for f, grid in zip(flown, grids, strict=True)}, replays


def _usual(flying: Flying) -> Condition:
    """Return the median flight condition at the starts of the manoeuvres."""
    height = float(np.mean([flying.condition(f).height_m for f in flying.flights.flights]))
    return Condition(flying.flights.reference_m_s, height, 0.0, flying.mass_kg)
