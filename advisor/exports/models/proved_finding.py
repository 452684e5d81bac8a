"""Findings of a diagnosis for the manoeuvres that prove them: later ones, unseen ones, and parts alone."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.candidates.catalogue import variants_for
from advisor.gap.candidates.known import changes_in, lasting
from advisor.gap.records.as_stamped import as_stamped
from advisor.gap.records.prepare import prepare
from advisor.gap.result import Diagnosis
from advisor.gap.simulator.layout import DERIVATIVES, ENTRIES, INDEX

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
