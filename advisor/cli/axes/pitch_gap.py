"""``advisor gap`` of pitch: the simulator against the manoeuvres of the elevator."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache, partial
from pathlib import Path

from advisor.analysis import gap as reading
from advisor.campaign.hand_decisions import ByHand
from advisor.cli.gap_asked import AxisAnswer, GapAsked, Unanswered, write_figure
from advisor.cli.improvement_export import listed, write_exports
from advisor.cli.options import USAGE, decided_on
from advisor.cli.proving import document as proof_document
from advisor.cli.proving import print_proof, proof_of
from advisor.cli.stages import Stages
from advisor.exports.models.axes.handed_over import side_of_logs
from advisor.exports.models.axes.prove_pitch import prove, stays_of
from advisor.exports.models.flown import FlownModel, SideModel, improved_model
from advisor.exports.models.proof import Proof
from advisor.exports.models.write import ExportOutcome
from advisor.report.gap_document import gap_document
from advisor.report.gap_screen import GapScreen
from advisor.report.gap_steps import next_steps
from advisor.report.table import PlainConsole
from advisor.simulators.compare import Compared
from advisor.words.plain import plain
from advisor.words.printable import printable


def compare_pitch(
    asked: GapAsked,
    by_hand: Sequence[ByHand],
    holdout: int | None,
    everything: bool,
    flown: reading.GapFlights | None = None,
) -> int:
    """Diagnose the gap of pitch, print the result and write the files.

    Parameters
    ----------
    flown
        Manoeuvres of the elevator, if the logs are already read.
    """
    compared = diagnosed_pitch(asked, by_hand, holdout, flown)
    if isinstance(compared, Unanswered):
        return asked.refused(compared)
    return asked.answered(pitch_answer(asked, by_hand, everything, compared, partial(_side_of, asked)))


def diagnosed_pitch(
    asked: GapAsked, by_hand: Sequence[ByHand], holdout: int | None, flown: reading.GapFlights | None
) -> Compared | Unanswered:
    """Return the diagnosis of pitch, or the reason for none."""
    aircraft, read = asked.aircraft, asked.read

    def compare() -> Compared:
        simulator = reading.named_simulator(aircraft, read.target_system)
        try:
            return reading.compare_logs(
                read.logs,
                aircraft,
                simulator,
                holdout,
                read.target_system,
                progress,
                by_hand,
                asked.prior,
                flown,
            )
        finally:
            if simulator is not None:
                simulator.close()

    with Stages() as progress:
        return asked.attempted("pitch, diagnosis", compare)


def pitch_answer(
    asked: GapAsked,
    by_hand: Sequence[ByHand],
    everything: bool,
    compared: Compared,
    make_side: Callable[[], SideModel | None],
    side_improves: bool = False,
) -> AxisAnswer:
    """Write the files that were asked for, and return the answer of pitch.

    Parameters
    ----------
    make_side
        Returns roll and yaw for the files.
    side_improves
        Whether the diagnosis of roll and yaw improves the simulator.
    """
    aircraft, read = asked.aircraft, asked.read
    found = compared.diagnosis
    proof = proof_of(asked.proving, partial(_prove, asked, by_hand, compared))
    if proof is not None:
        found = stays_of(proof, found, compared.aircraft.model)
    side = cache(make_side)
    improves = found.improves or side_improves
    written = asked.improved(improves, lambda: FlownModel(compared.aircraft, None, side(), found))
    # The simulator's own servo is no part of the improvement.
    as_given = replace(compared.aircraft, simulator=aircraft.simulator, elevator=aircraft.elevator)
    outcomes = write_exports(
        asked.orders, lambda: replace(improved_model(found, as_given, side()), unchanged=not improves)
    )
    write_figure(asked.figure, lambda: gap_document(found))
    steps = next_steps(
        found, list(map(str, read.logs)), read.aircraft_text, aircraft.simulator, read.reading,
        _flown_next(aircraft.simulator, written, outcomes),
    )  # fmt: skip
    document = gap_document(found, (), None if written is None else str(written))
    document |= {"exports": listed(outcomes), "next": plain(steps), **proof_document(proof)}

    def show() -> None:
        name = None if written is None else printable(str(written))
        PlainConsole().print(GapScreen(found, name, asked.why, steps, everything))
        print_proof(proof)

    return AxisAnswer(document, show, USAGE if any(one.problem for one in outcomes) else 0)


def _prove(
    asked: GapAsked,
    by_hand: Sequence[ByHand],
    whole: Compared,
    named: Sequence[Path],
    tell: Callable[[str, float], None],
) -> Proof:
    """Fly the improved simulator on the manoeuvres of logs; without any, on the last third."""
    aircraft, read = asked.aircraft, asked.read
    tell("reading for the proof", 0.0)
    flown = reading.maneuvers_of(read.logs, aircraft, read.target_system, by_hand)
    decided = [decided_on(log, read.no_marks) for log in named]
    fresh = reading.maneuvers_of(named, aircraft, read.target_system, decided) if named else None
    return prove(flown, fresh, aircraft, read.target_system, tell, asked.prior, whole)


def _side_of(asked: GapAsked) -> SideModel | None:
    """Return roll and yaw as the logs tell them; None where they tell none."""
    read = asked.read
    with Stages() as tell:
        tell("reading roll and yaw for the files", 0.0)
        return side_of_logs(read.logs, asked.aircraft, read.target_system, read.marks, no_marks=read.no_marks)


def _flown_next(
    simulator: str | None, improved: Path | None, outcomes: Sequence[ExportOutcome]
) -> str | None:
    """Return the written file of the improved simulator that the simulator of the diagnosis can fly."""
    kind, _, _ = (simulator or "linear").partition(":")
    files = [one.order.file for one in outcomes if one.order.format == kind and not one.problem]
    file = next(iter(files), None) if kind != "linear" else improved
    return None if file is None else str(file)
