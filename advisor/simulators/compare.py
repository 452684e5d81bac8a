"""Comparison of a flight with the user's own simulator: place, cause and reduction of the gap.

The simulator S replays the recorded inputs. The diagnosis compares the simulator's linear surrogate L with y
− (y_S − y_L). The difference between S and L is part of the simulator. The diagnosis does not report it as
missing.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.candidates.catalogue import variants_for
from advisor.gap.candidates.known import with_known
from advisor.gap.diagnose import Examined, examine
from advisor.gap.effects import EFFECTS
from advisor.gap.fitting.problem import EffectProblem, SearchPoint
from advisor.gap.inference.findings import Findings
from advisor.gap.inference.prior import FIELD, FieldPrior
from advisor.gap.records.prepare import as_stamped, prepare
from advisor.gap.records.unmeasured_alpha import alpha_by_motion, is_known
from advisor.gap.result import Diagnosis, Trace, TrimDifference
from advisor.gap.search.baseline import base_entries
from advisor.gap.simulator.layout import DERIVATIVES, INDEX, NUISANCES, OUTPUTS
from advisor.simulators.air import refuse_unknown_air, standard_heights, still_air_said, winds
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
    without_difference,
)
from advisor.simulators.improved import EQUATIONS, in_simulator, where_it_acts
from advisor.simulators.inputs import other_controls
from advisor.simulators.linear import LinearSimulator
from advisor.simulators.mirror import Mirror, said_of_the_simulator
from advisor.simulators.protocol import Condition, Inputs, Replay, Simulator
from advisor.simulators.static_errors import trim_differences, with_static_errors
from advisor.simulators.surrogate import Surrogate, surrogate_of
from advisor.simulators.taken_back import with_unseen_shrink, without_worse
from advisor.simulators.unseen import Flown, UnseenManeuvers, changes_something, resaid, shrink_on, unseen_of

_FLIES, _DIAGNOSED, _FOUND = 0.2, 0.9, 0.95
"""Fractions of the work that are done after the first replays, after the diagnosis, and after the corrected
replays.
"""


@dataclass(frozen=True)
class Compared:
    """Diagnosis against a simulator, with the simulator's linear surrogate."""

    diagnosis: Diagnosis
    aircraft: Aircraft
    """Aircraft file with the simulator's surrogate as its model."""
    findings: Findings | None = None
    """Findings on which the diagnosis is based."""


def compare(
    maneuvers: Sequence[Maneuver],
    simulator: Simulator,
    aircraft: Aircraft,
    holdout: int | None = None,
    progress: Progress = lambda *_: None,
    prior: FieldPrior = FIELD,
) -> Compared:
    """Diagnose the gap between a flight and a simulator.

    Parameters
    ----------
    maneuvers, holdout, progress, prior
        Arguments as in ``advisor.gap.diagnose.examine``.
    simulator
        User's own simulator.
    aircraft
        Aircraft file of the crew. The effects and the servo of the aircraft file are used, but its model is
        not.

    Raises
    ------
    UnusableInputError
        There is no usable manoeuvre or no angle of attack, or the simulator does not fly.
    """
    if not simulator.takes_increments:
        aircraft = _without_equations(aircraft)
    maneuvers = alpha_by_motion([as_stamped(m) for m in maneuvers], aircraft)
    flights = prepare(maneuvers, aircraft)
    if not len(flights) or not is_known(maneuvers):
        examine(maneuvers, aircraft, holdout, progress, prior)
    heights = standard_heights(maneuvers, aircraft)
    if not isinstance(simulator, LinearSimulator):
        refuse_unknown_air(simulator.description, heights)
    heights_m = {number: height or 0.0 for number, height in heights.items()}
    mass_kg = aircraft.reference.mass_kg
    trims: tuple[TrimDifference, ...] = ()
    replays: list[Replay] = []
    controls = other_controls(flights.flights, maneuvers)
    blown = winds(maneuvers)
    flying = Flying(
        simulator, flights, heights_m, controls, mass_kg, lambda w, s: progress(w, _FLIES * s), blown
    )
    if isinstance(simulator, LinearSimulator):
        surrogate = Surrogate(simulator.derivatives, simulator.reference_m_s or flights.reference_m_s)
        basis = simulator.as_file if isinstance(simulator, IdentifiedSimulator) else aircraft
        as_file = replace(basis, simulator=None)
        as_flown = _linear(flying)
    else:
        surrogate, as_flown, replays = _surrogate_and_rest(flying, aircraft)
        trims = trim_differences(flights, maneuvers, replays, aircraft)
        as_file = replace(surrogate.aircraft(aircraft), simulator=simulator.description)
    beside = [without_difference(m, as_flown) for m in maneuvers]
    examined = examine(
        beside,
        as_file,
        holdout,
        lambda what, share: progress(what, _FLIES + (_DIAGNOSED - _FLIES) * share),
        prior,
        Mirror(maneuvers, flying, replays, aircraft, as_flown),
    )
    # Nothing can be added to a simulator that has an effect too much.
    lacks = examined.findings.without is not None
    again = replace(flying, progress=lambda w, s: progress(w, _DIAGNOSED + (_FOUND - _DIAGNOSED) * s))
    if isinstance(simulator, LinearSimulator):
        reference = examined.findings.problem.flights.reference_m_s
        surrogate = replace(surrogate, reference_m_s=reference)
        again = replace(again, simulator=replace(simulator, reference_m_s=reference))
    elif not lacks:
        examined = where_it_acts(examined, again, surrogate, as_flown)
    corrects = changes_something(examined.diagnosis) and not lacks
    unseen = unseen_of(examined, holdout) if corrects else None
    fly = partial(in_simulator, examined, flying=again, surrogate=surrogate, as_flown=as_flown)
    stays, flown = (examined, fly(None)) if unseen is None else without_worse(examined, unseen, fly)
    if unseen is not None and not changes_something(stays.diagnosis):
        unseen, flown = None, fly(None)
    diagnosis = _measured(stays, unseen, as_file, flown, as_flown)
    diagnosis = said_of_the_simulator(examined, diagnosis)
    diagnosis = with_static_errors(diagnosis, examined, trims)
    notes = (*getattr(simulator, "notes", ()), *still_air_said(simulator, blown))
    return Compared(replace(diagnosis, notes=(*notes, *diagnosis.notes)), as_file, stays.findings)


def _measured(
    examined: Examined,
    unseen: UnseenManeuvers | None,
    as_file: Aircraft,
    flown: Flown,
    as_flown: Mapping[int, AsGiven],
) -> Diagnosis:
    """Return the diagnosis with the simulator's own gap, before and after the corrections."""
    diagnosis, gap = examined.diagnosis, flown.gap
    assert gap is not None
    if unseen is not None and flown.after is not None and not gap.on_paper:
        diagnosis = resaid(diagnosis, shrink_on(examined, unseen, flown.before, flown.after), as_file)
    elif unseen is not None:
        diagnosis = with_unseen_shrink(examined, unseen, as_file).diagnosis
    elif changes_something(diagnosis):
        gap = replace(gap, after=None, percent=None)
    notes = diagnosis.notes
    if gap.refused:
        notes = (f"The simulator cannot take the effects: {gap.refused}", *notes)
    return replace(diagnosis, in_simulator=gap, notes=notes, traces=_as_logged(diagnosis.traces, as_flown))


def _as_logged(traces: Sequence[Trace], as_flown: Mapping[int, AsGiven]) -> tuple[Trace, ...]:
    """Return the traces of the logged flight, with those of the simulator in place of its surrogate."""
    logged = []
    for trace in traces:
        as_given = as_flown[trace.number]
        t = np.arange(as_given.beyond.shape[1]) * as_given.flight.h
        by = np.interp(trace.t, t, as_given.beyond[OUTPUTS.index(trace.channel)])
        logged.append(
            replace(trace, measured=trace.measured + by, before=trace.before + by, after=trace.after + by)
        )
    return tuple(logged)


def _linear(flying: Flying) -> dict[int, AsGiven]:
    """Return the start of every manoeuvre for a linear simulator, which equals its surrogate."""
    begun = []
    for flight in flying.flights.flights:
        rest = Inputs(np.array([0.5, 1.5]) * flight.h, np.zeros(2))
        begun.append(flying.simulator.replay(flying.condition(flight), rest))
    return {f.number: AsGiven(f, np.zeros((len(OUTPUTS), f.n + 1))) for f in flying.as_flown(begun)}


def _surrogate_and_rest(
    flying: Flying, aircraft: Aircraft
) -> tuple[Surrogate, dict[int, AsGiven], list[Replay]]:
    """Return the surrogate, every manoeuvre as the simulator flew it, and the replays."""
    flights = flying.flights
    variants = variants_for(flights)
    values = with_known(base_entries(aircraft), aircraft.effects, flights, variants)
    command = np.zeros_like(values)
    entries = [INDEX[name] for name in COMMAND]
    command[:, entries] = values[:, entries]
    replays = flying.replays(command, held=False)
    refuse_unmoved(flying.simulator.description, replays, flights)
    flown = flying.as_flown(replays)
    surrogate = surrogate_of(flights, flown, replays, command, flying.simulator.linearise(_usual(flying)))
    refuse_wrong_elevator(flying.simulator.description, surrogate.derivatives["M_delta_e"], replays, flights)
    base = with_known(base_entries(surrogate.aircraft(aircraft)), aircraft.effects, flights, variants)
    derivatives = np.array([surrogate.derivatives[name] for name in DERIVATIVES])
    own = np.zeros((len(flights), len(NUISANCES)))
    p = EffectProblem(flights, base).driving(SearchPoint(derivatives, own))
    if any(EFFECTS[effect].block in EQUATIONS for effect in aircraft.effects):
        replays = flying.replays(command, False, added(flown, p, derivatives))
    grids = beyond(flying, replays, p)
    return surrogate, {f.number: AsGiven(f, grid) for f, grid in zip(flown, grids, strict=True)}, replays


def _without_equations(aircraft: Aircraft) -> Aircraft:
    """Return the aircraft file without effects of the force and of the moment."""
    kept = {e: sizes for e, sizes in aircraft.effects.items() if EFFECTS[e].block not in EQUATIONS}
    return replace(aircraft, effects=kept)


def _usual(flying: Flying) -> Condition:
    """Return the median flight condition at the starts of the manoeuvres."""
    height = float(np.mean([flying.condition(f).height_m for f in flying.flights.flights]))
    return Condition(flying.flights.reference_m_s, height, 0.0, flying.mass_kg)
