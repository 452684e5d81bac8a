"""Comparison of a flight with the user's own simulator: place, cause and reduction of the gap.

The simulator S replays the recorded inputs. The diagnosis compares the simulator's linear surrogate L with y
− (y_S − y_L). The difference between S and L is part of the simulator. The diagnosis does not report it as
missing.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.diagnose import Examined, examine, without_simulator
from advisor.gap.effects import EFFECTS
from advisor.gap.inference.findings import Findings
from advisor.gap.inference.prior import FIELD, FieldPrior
from advisor.gap.records.prepare import as_stamped, prepare
from advisor.gap.records.unmeasured_alpha import alpha_by_motion, is_known
from advisor.gap.result import Diagnosis, Value
from advisor.gap.search.baseline import prior_derivatives
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.simulators.air import still_air_said
from advisor.simulators.as_given import GivenSimulator, given_of, without_difference
from advisor.simulators.improved import in_simulator, where_it_acts
from advisor.simulators.increments import EQUATIONS
from advisor.simulators.linear import LinearSimulator
from advisor.simulators.mirror import Mirror, said_of_the_simulator
from advisor.simulators.protocol import Progress, Simulator
from advisor.simulators.static_errors import with_static_errors
from advisor.simulators.unseen import (
    Flown,
    UnseenManeuvers,
    changes_something,
    resaid,
    shrink_on,
    unseen_of,
    with_unseen_shrink,
    without_worse,
)
from advisor.words.quantities import PARAMETERS

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
    given = given_of(simulator, flights, maneuvers, aircraft, lambda w, s: progress(w, _FLIES * s))
    beside = [without_difference(m, given.as_flown) for m in maneuvers]
    examined = examine(
        beside,
        given.as_file,
        holdout,
        lambda what, share: progress(what, _FLIES + (_DIAGNOSED - _FLIES) * share),
        prior,
        Mirror(maneuvers, given.flying, given.replays, aircraft, given.as_flown),
    )
    # Nothing can be added to a simulator that has an effect too much.
    lacks = examined.findings.without is not None
    surrogate = given.surrogate
    again = replace(given.flying, progress=lambda w, s: progress(w, _DIAGNOSED + (_FOUND - _DIAGNOSED) * s))
    if isinstance(simulator, LinearSimulator):
        reference = examined.findings.problem.flights.reference_m_s
        surrogate = replace(surrogate, reference_m_s=reference)
        again = replace(again, simulator=replace(simulator, reference_m_s=reference))
    elif not lacks:
        examined = where_it_acts(examined, again, surrogate, given.as_flown)
    corrects = changes_something(examined.diagnosis) and not lacks
    unseen = unseen_of(examined, holdout) if corrects else None
    fly = partial(in_simulator, examined, flying=again, surrogate=surrogate, as_flown=given.as_flown)
    stays, flown = (examined, fly(None)) if unseen is None else without_worse(examined, unseen, fly)
    if unseen is not None and not changes_something(stays.diagnosis):
        unseen, flown = None, fly(None)
    diagnosis = _measured(stays, unseen, given, flown)
    diagnosis = said_of_the_simulator(examined, diagnosis)
    diagnosis = with_static_errors(diagnosis, examined, given.trims)
    notes = (*getattr(simulator, "notes", ()), *still_air_said(simulator, given.flying.winds))
    return Compared(replace(diagnosis, notes=(*notes, *diagnosis.notes)), given.as_file, stays.findings)


def _measured(
    examined: Examined, unseen: UnseenManeuvers | None, given: GivenSimulator, flown: Flown
) -> Diagnosis:
    """Return the diagnosis with the simulator's own gap, before and after the corrections."""
    diagnosis, gap = examined.diagnosis, flown.gap
    assert gap is not None
    if unseen is not None and flown.after is not None and not gap.on_paper:
        diagnosis = resaid(diagnosis, shrink_on(examined, unseen, flown.before, flown.after), given.as_file)
    elif unseen is not None:
        diagnosis = with_unseen_shrink(examined, unseen, given.as_file).diagnosis
    elif changes_something(diagnosis):
        gap = replace(gap, after=None, percent=None)
    notes = diagnosis.notes
    if gap.refused:
        notes = (f"The simulator cannot take the effects: {gap.refused}", *notes)
    return replace(diagnosis, in_simulator=gap, notes=notes, traces=given.as_logged(diagnosis.traces))


def _without_equations(aircraft: Aircraft) -> Aircraft:
    """Return the aircraft file without effects of the force and of the moment."""
    kept = {e: sizes for e, sizes in aircraft.effects.items() if EFFECTS[e].block not in EQUATIONS}
    return replace(aircraft, effects=kept)


def compare_to_file(
    maneuvers: Sequence[Maneuver],
    aircraft: Aircraft,
    holdout: int | None,
    progress: Progress,
    prior: FieldPrior,
) -> Compared:
    """Diagnose the gap of manoeuvres to the file's model, and measure its reduction on held-out manoeuvres.

    Raises
    ------
    UnusableInputError
        The manoeuvres cannot be used.
    """
    whole = stays = examine(maneuvers, aircraft, holdout, progress, prior)
    diagnosis = whole.diagnosis
    if prior_derivatives(aircraft) is None:
        diagnosis = without_simulator(diagnosis, aircraft)
    elif changes_something(diagnosis):
        progress("measuring the gap's reduction on held-out manoeuvres", 0.9)
        unseen = unseen_of(whole, holdout)
        if unseen is not None:
            stays = with_unseen_shrink(whole, unseen, aircraft)
            diagnosis = stays.diagnosis
    return Compared(with_static_errors(diagnosis, whole), aircraft, stays.findings)


def agreeing(diagnosis: Diagnosis, logged: Estimate | NoEstimate) -> Diagnosis:
    """Return a diagnosis whose derivatives agree with an estimate within their 95 % intervals.

    The estimate is made without a simulator. A significant difference between two analyses of one log is a
    lower bound of both errors. A derivative whose wider interval contains the simulator's value is not stated
    as changed.

    Parameters
    ----------
    logged
        Estimate from all manoeuvres together, as logged.
    """
    if isinstance(logged, NoEstimate):
        return diagnosis
    estimated = zip(logged.names, logged.theta.tolist(), logged.std.tolist(), strict=True)
    others = {name: Value(x, std) for name, x, std in estimated if name not in logged.not_identifiable}
    shared = [derivative.name for derivative in diagnosis.derivatives if derivative.name in others]
    model = {**diagnosis.model, **{name: diagnosis.model[name].agreeing(others[name]) for name in shared}}
    wider = [PARAMETERS[name].symbol for name in shared if model[name] != diagnosis.model[name]]
    derivatives = tuple(
        replace(derivative, found=model[derivative.name]) for derivative in diagnosis.derivatives
    )
    said = f"The intervals of {', '.join(wider)} contain those of advisor analyze, which lie elsewhere."
    notes = (*diagnosis.notes, *([said] if wider else []))
    return replace(diagnosis, model=model, derivatives=derivatives, notes=notes)
