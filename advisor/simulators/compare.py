"""The comparison of a flight with the user's own simulator: place, cause and shrink of the gap.

The simulator S replays the recorded inputs. Its linear surrogate L is diagnosed on y − (y_S − y_L). The
difference between S and L belongs to the simulator, and is not called missing.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.messages import FloatArray
from advisor.flight.signals.record import Channel
from advisor.gap.candidates.catalogue import variants_for
from advisor.gap.candidates.known import with_known
from advisor.gap.candidates.traits import TRAITS
from advisor.gap.diagnose import DiagnosisEvidence, examine
from advisor.gap.fitting.problem import EffectProblem, SearchPoint
from advisor.gap.records.as_stamped import as_stamped
from advisor.gap.records.prepare import prepare
from advisor.gap.records.unmeasured_alpha import by_the_motion, is_known
from advisor.gap.result import Diagnosis
from advisor.gap.search.baseline import base_entries
from advisor.gap.simulator.layout import DERIVATIVES, INDEX, NUISANCES, OUTPUTS
from advisor.simulators.around import COMMAND
from advisor.simulators.by_log import IdentifiedSimulator
from advisor.simulators.flying import AsGiven, Flying, Progress, added, beyond, refuse_unmoved
from advisor.simulators.improved import EQUATIONS, in_simulator
from advisor.simulators.inputs import condition_of
from advisor.simulators.linear import LinearSimulator
from advisor.simulators.protocol import Condition, Inputs, Simulator
from advisor.simulators.surrogate import Surrogate, surrogate_of

_FLIES, _DIAGNOSED = 0.25, 0.8
"""Shares of the work that are done after the first replays, and after the diagnosis."""


@dataclass(frozen=True)
class Compared:
    """The diagnosis against a simulator, and the simulator's linear surrogate."""

    diagnosis: Diagnosis
    aircraft: Aircraft
    """The aircraft file with the simulator's surrogate as its model."""


def compare(
    maneuvers: Sequence[Maneuver],
    simulator: Simulator,
    aircraft: Aircraft,
    holdout: int | None = None,
    progress: Progress = lambda *_: None,
) -> Compared:
    """Diagnose the gap between a flight and a simulator.

    Parameters
    ----------
    maneuvers, holdout, progress
        Arguments of ``advisor.gap.diagnose.diagnose``.
    simulator
        The user's own simulator.
    aircraft
        The aircraft file. Its effects and its servo act around and in the simulator; its model is not used.

    Raises
    ------
    UnusableInputError
        No usable manoeuvre, no angle of attack, or a simulator that does not fly.
    """
    if not simulator.takes_increments:
        aircraft = _without_equations(aircraft)
    maneuvers = by_the_motion([as_stamped(m) for m in maneuvers], aircraft)
    flights = prepare(maneuvers, aircraft)
    if not len(flights) or not is_known(maneuvers):
        examine(maneuvers, aircraft, holdout, progress)
    flying = Flying(simulator, flights, aircraft.reference.mass_kg, lambda w, s: progress(w, _FLIES * s))
    if isinstance(simulator, LinearSimulator):
        surrogate = Surrogate(simulator.derivatives, simulator.reference_m_s or flights.reference_m_s)
        known = simulator.as_file if isinstance(simulator, IdentifiedSimulator) else aircraft
        as_file = replace(known, simulator=None)
        as_flown = _linear(flying)
    else:
        surrogate, as_flown = _surrogate_and_rest(flying, aircraft)
        as_file = replace(surrogate.aircraft(aircraft), simulator=simulator.description)
    examined = examine(
        [_without(m, as_flown) for m in maneuvers],
        as_file,
        holdout,
        lambda what, share: progress(what, _FLIES + (_DIAGNOSED - _FLIES) * share),
    )
    again = replace(flying, progress=lambda w, s: progress(w, _DIAGNOSED + (1.0 - _DIAGNOSED) * s))
    if isinstance(simulator, LinearSimulator):
        reference = examined.evidence.problem.flights.reference_m_s
        surrogate = replace(surrogate, reference_m_s=reference)
        again = replace(again, simulator=replace(simulator, reference_m_s=reference))
    found = _measured(examined, again, surrogate, as_flown, holdout)
    notes = simulator.notes if isinstance(simulator, IdentifiedSimulator) else ()
    return Compared(replace(found, notes=(*notes, *found.notes)), as_file)


def _measured(
    examined: DiagnosisEvidence,
    flying: Flying,
    surrogate: Surrogate,
    as_flown: Mapping[int, AsGiven],
    holdout: int | None,
) -> Diagnosis:
    """Return the diagnosis with the gap of the simulator itself, before and after the findings."""
    found = in_simulator(examined, flying, surrogate, as_flown, holdout)
    found_by_fit = examined.diagnosis
    notes = found_by_fit.notes
    if found.refused:
        notes = (f"The simulator cannot take the effects: {found.refused}", *notes)
    return replace(found_by_fit, in_simulator=found, notes=notes)


def _linear(flying: Flying) -> dict[int, AsGiven]:
    """Return how a linear simulator starts every manoeuvre: it equals its surrogate."""
    begun = []
    for flight in flying.flights.flights:
        rest = Inputs(np.array([0.5, 1.5]) * flight.h, np.zeros(2))
        begun.append(flying.simulator.replay(condition_of(flight, flying.flights, flying.mass_kg), rest))
    return {f.number: AsGiven(f, np.zeros((len(OUTPUTS), f.n + 1))) for f in flying.as_flown(begun)}


def _surrogate_and_rest(flying: Flying, aircraft: Aircraft) -> tuple[Surrogate, dict[int, AsGiven]]:
    """Return the surrogate, and every manoeuvre as flown by the simulator."""
    flights = flying.flights
    variants = variants_for(flights)
    known = with_known(base_entries(aircraft), aircraft.effects, flights, variants)
    command = np.zeros_like(known)
    entries = [INDEX[name] for name in COMMAND]
    command[:, entries] = known[:, entries]
    replays = flying.replays(command, held=False)
    refuse_unmoved(flying.simulator.description, replays, flights)
    flown = flying.as_flown(replays)
    surrogate = surrogate_of(flights, flown, replays, command, flying.simulator.linearise(_usual(flying)))
    base = with_known(base_entries(surrogate.aircraft(aircraft)), aircraft.effects, flights, variants)
    derivatives = np.array([surrogate.derivatives[name] for name in DERIVATIVES])
    own = np.zeros((len(flights), len(NUISANCES)))
    p = EffectProblem(flights, base).driving(SearchPoint(derivatives, own))
    if any(TRAITS[effect].block in EQUATIONS for effect in aircraft.effects):
        replays = flying.replays(command, False, added(flown, p, derivatives))
    grids = beyond(flying, replays, p)
    return surrogate, {f.number: AsGiven(f, grid) for f, grid in zip(flown, grids, strict=True)}


def _without_equations(aircraft: Aircraft) -> Aircraft:
    """Return the aircraft file without effects of the force and of the moment."""
    kept = {e: sizes for e, sizes in aircraft.effects.items() if TRAITS[e].block not in EQUATIONS}
    return replace(aircraft, effects=kept)


def _usual(flying: Flying) -> Condition:
    """Return the condition in the middle of those at the starts of the manoeuvres."""
    conditions = [condition_of(f, flying.flights, flying.mass_kg) for f in flying.flights.flights]
    height = float(np.mean([c.height_m for c in conditions]))
    return Condition(flying.flights.reference_m_s, height, 0.0, flying.mass_kg)


def _without(m: Maneuver, as_flown: Mapping[int, AsGiven]) -> Maneuver:
    """Return the manoeuvre without the simulator's difference to its surrogate."""
    if m.number not in as_flown:
        return m
    flight, grid = as_flown[m.number].flight, as_flown[m.number].beyond
    t: FloatArray = flight.started_s + np.arange(grid.shape[1], dtype=np.float64) * flight.h
    channels = dict(m.channels)
    for c, name in enumerate(OUTPUTS):
        if name in channels:
            channels[name] = _less(channels[name], t, grid[c])
    return replace(m, channels=channels)


def _less(channel: Channel, t: FloatArray, by: FloatArray) -> Channel:
    """Return a channel minus a series; a sample that repeats the one before still repeats it."""
    y = channel.y - np.interp(channel.t, t, by)
    fresh = np.concatenate([[True], np.diff(channel.y) != 0.0])
    return replace(channel, y=y[np.maximum.accumulate(np.where(fresh, np.arange(len(y)), 0))])
