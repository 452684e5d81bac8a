"""Proof of ``advisor gap --prove`` in pitch: the improved simulator on manoeuvres that no fit has used."""

import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft_file.read import parse_aircraft
from advisor.analysis.gap import compare_flown, opened_simulator
from advisor.analysis.gap_flights import GapFlights
from advisor.exports.models.flown import FlownModel, file_of, improved_model
from advisor.exports.models.formats.jsbsim_format import FORMAT as JSBSIM
from advisor.exports.models.proof import (
    NUMBERS,
    ImprovedAxis,
    Kept,
    Proof,
    answer_of,
    parted,
    proved,
    refuse_unimproved,
    without,
)
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.candidates.known import changes_in, lasting, less_of_the_servo, together, variants_for
from advisor.gap.diagnose import Examined
from advisor.gap.inference.prior import FIELD, FieldPrior
from advisor.gap.records.prepare import as_stamped, prepare
from advisor.gap.result import Diagnosis, spelled
from advisor.gap.simulator.layout import DERIVATIVES, ENTRIES, INDEX
from advisor.simulators.compare import Compared
from advisor.simulators.protocol import Progress
from advisor.simulators.unseen import sized_without


def prove(
    flown: GapFlights,
    fresh: GapFlights | None,
    aircraft: Aircraft,
    target_system: int | None = None,
    progress: Progress = lambda *_: None,
    prior: FieldPrior = FIELD,
    whole: Compared | None = None,
) -> Proof:
    """Return the proof of a simulator improved by some manoeuvres and tested on others.

    If the fitted manoeuvres give no correction, the correction of the whole flight is tested, with refitted
    sizes.

    Parameters
    ----------
    fresh
        Manoeuvres of other logs; None to hold out the last third of ``flown``.

    Raises
    ------
    UnusableInputError
        There are too few manoeuvres, no improvement was found, or the simulator does not fly.
    """
    fitted, kept = flown, fresh
    if kept is None:
        some, last = parted(flown.maneuvers)
        fitted, kept = replace(flown, maneuvers=list(some)), replace(flown, maneuvers=list(last))

    def compared(some: GapFlights, simulator: Aircraft, k: int) -> Compared:
        """Return one of the three comparisons of a proof."""
        with opened_simulator(simulator, target_system) as opened:
            return compare_flown(
                some, simulator, opened, None, lambda what, x: progress(what, (k + x) / 3.0), prior
            )

    first = compared(fitted, aircraft, 0)
    diagnosis, alone = first.diagnosis, ""
    if fresh is None and not diagnosis.improves and whole is not None and whole.findings is not None:
        alone = diagnosis.sentence
        examined = Examined(whole.diagnosis, whole.findings)
        diagnosis = sized_without(examined, [m.number for m in kept.maneuvers]).diagnosis
    refuse_unimproved(diagnosis.improves, alone or diagnosis.sentence, len(fitted.maneuvers))
    if fresh is None:
        diagnosis = as_it_ended(diagnosis, fitted.maneuvers, first.aircraft)
    parts = (*diagnosis.effects, NUMBERS)

    def flown_without(gone: tuple[str, ...]) -> Kept:
        stays = diagnosis
        left: tuple[str, ...] = ()
        for part in gone:
            stays = without(stays, part, first.aircraft.model)
        with tempfile.TemporaryDirectory() as folder:
            better = aircraft
            if gone != parts:
                better, left = _improved(stays, first.aircraft, aircraft, Path(folder))
            again = compared(kept, better, 1 if better is aircraft else 2).diagnosis
        gaps = {number: gap for number, gap, _ in again.gap.by_maneuver}
        return Kept(again.gap.before, gaps, again.gap.floor, lambda: (again.verdict, again.sentence), left)

    fewer = [(part,) for part in parts if len(parts) > 1]
    return proved(ImprovedAxis(answer_of(diagnosis), parts, fewer, flown_without, alone))


def as_it_ended(diagnosis: Diagnosis, maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> Diagnosis:
    """Return a diagnosis with changes in flight replaced by the derivatives of its last fitted manoeuvre.

    Later manoeuvres of the flight begin with the changed aircraft.
    """
    if lasting(diagnosis.effects) == diagnosis.effects:
        return diagnosis
    flights = prepare([as_stamped(m) for m in maneuvers if m.number in diagnosis.maneuvers], aircraft)
    p = np.zeros((len(flights), len(ENTRIES)))
    p[:, : len(DERIVATIVES)] = [diagnosis.model[name].value for name in DERIVATIVES]
    effects = dict(diagnosis.effects)
    for change, values in changes_in(effects, variants_for(flights)):
        change.apply(p, values, flights)
        del effects[change.effect]
    ended = {name: replace(diagnosis.model[name], value=float(p[-1, INDEX[name]])) for name in DERIVATIVES}
    return replace(diagnosis, model={**diagnosis.model, **ended}, effects=effects)


def _improved(
    diagnosis: Diagnosis, against: Aircraft, aircraft: Aircraft, folder: Path
) -> tuple[Aircraft, tuple[str, ...]]:
    """Return the aircraft file with the improved simulator, and the parts that it does not support."""
    kind, _, _ = (aircraft.simulator or "linear").partition(":")
    if kind == "linear":
        better = parse_aircraft(file_of(FlownModel(against, None, None, diagnosis)))
        return replace(better, simulator=aircraft.simulator), ()
    flown, effects = less_of_the_servo(aircraft, together(aircraft.effects, diagnosis.effects))
    if kind != "jsbsim":
        numbers = [derivative.name for derivative in diagnosis.derivatives if derivative.differs]
        return replace(flown, effects=effects), tuple(numbers)
    given = replace(against, simulator=aircraft.simulator, elevator=aircraft.elevator)
    name = Path(str(aircraft.simulator).partition(":")[2]).stem
    file = folder / name / f"{name}.xml"
    file.parent.mkdir()
    made = JSBSIM.made(improved_model(diagnosis, given, None), file)
    file.write_text(made.text, encoding="utf-8")
    around = {effect: sizes for effect, sizes in effects.items() if spelled(effect) in made.left_out}
    own = replace(aircraft.elevator, lag_s=0.0, delay_s=0.0)
    better = replace(aircraft, simulator=f"jsbsim:{file}", effects=around, elevator=own)
    return better, tuple(x for x in made.left_out if x not in map(spelled, around))
