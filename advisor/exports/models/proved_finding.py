"""Findings of a diagnosis for the manoeuvres that prove them: later ones, unseen ones, and parts alone."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.candidates.catalogue import variants_for
from advisor.gap.candidates.known import changes_in, lasting
from advisor.gap.candidates.nuisances import PROPELLER
from advisor.gap.fitting.fit import fit
from advisor.gap.inference.findings import Findings
from advisor.gap.records.as_stamped import as_stamped
from advisor.gap.records.prepare import prepare
from advisor.gap.result import Diagnosis
from advisor.gap.simulator.layout import DERIVATIVES, ENTRIES, INDEX
from advisor.gap.verdict.causes import parameters_of

NUMBERS = "the fitted numbers"


def as_it_ended(found: Diagnosis, maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> Diagnosis:
    """Return a finding with its changes in flight as other numbers: those of the last manoeuvre of its fit.

    Later manoeuvres of the flight begin with the changed aircraft.
    """
    if lasting(found.effects) == found.effects:
        return found
    flights = prepare([as_stamped(m) for m in maneuvers if m.number in found.maneuvers], aircraft)
    p = np.zeros((len(flights), len(ENTRIES)))
    p[:, : len(DERIVATIVES)] = [found.model[name].value for name in DERIVATIVES]
    effects = dict(found.effects)
    for change, values in changes_in(effects, variants_for(flights)):
        change.apply(p, values, flights)
        del effects[change.effect]
    ended = {name: replace(found.model[name], value=float(p[-1, INDEX[name]])) for name in DERIVATIVES}
    return replace(found, model={**found.model, **ended}, effects=effects)


def without(found: Diagnosis, part: str, given: Mapping[str, float]) -> Diagnosis:
    """Return a finding without one of its effects, or with the numbers of the simulator as given."""
    if part == NUMBERS:
        own = {name: replace(one, value=given.get(name, one.value)) for name, one in found.model.items()}
        return replace(found, model=own, derivatives=())
    return replace(
        found,
        effects={effect: sizes for effect, sizes in found.effects.items() if effect != part},
        causes=tuple(replace(c, present=c.present and c.effect != part) for c in found.causes),
    )


def sized_without(found: Diagnosis, findings: Findings, kept: Collection[int]) -> Diagnosis:
    """Return a diagnosis with derivatives and sizes of effects from a fit without some manoeuvres.

    The effects themselves are those that all manoeuvres tell.

    Parameters
    ----------
    findings
        Findings behind the diagnosis.
    kept
        Numbers of the manoeuvres that the fit leaves out.
    """
    problem, fitted = findings.problem, findings.last.fitted
    out = [i for i, flight in enumerate(problem.flights.flights) if flight.number in kept]
    point = fit(problem, fitted.point, fitted.noise, aside=out).point
    slopes = zip(DERIVATIVES, point.derivatives.tolist(), strict=True)
    effects = {effect: dict(sizes) for effect, sizes in found.effects.items()}
    for variant, values in zip(point.effects, point.values, strict=True):
        effect = "thrust_moment" if variant == PROPELLER else variant.effect
        if effect in effects:
            sizes = parameters_of(variant, values, np.zeros(len(values)))
            effects[effect] |= {name: size.value for name, size in sizes.items()}
    model = {name: replace(found.model[name], value=value) for name, value in slopes}
    return replace(found, model={**found.model, **model}, effects=effects)
