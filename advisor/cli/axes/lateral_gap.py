"""``advisor gap`` of roll and yaw: the simulator against the manoeuvres of aileron and rudder."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import click

from advisor.analysis.axes.side_comparison import (
    SideCompared,
    accepted_of,
    compare_side_flown,
    compare_side_logs,
)
from advisor.analysis.whole_flights import read_whole
from advisor.campaign.state import CampaignState
from advisor.cli.gap_asked import AxisAnswer, GapAsked, Unanswered, write_figure
from advisor.cli.improvement_export import listed, write_exports
from advisor.cli.options import USAGE
from advisor.cli.proving import document as proof_document
from advisor.cli.proving import print_proof, proof_of
from advisor.cli.stages import Stages
from advisor.exports.models.axes.handed_over import improved_side
from advisor.exports.models.axes.prove_side import prove_side, stays_of_side
from advisor.exports.models.proof import Proof
from advisor.report.axes.side_gap_text import side_gap_lines
from advisor.report.gap_causes import why_of
from advisor.report.gap_document import axis_document, gap_document
from advisor.report.table import PlainConsole
from advisor.words.printable import printable


def compare_lateral(asked: GapAsked, state: CampaignState | None = None) -> int:
    """Diagnose the gap of roll and yaw, print the result and write the files.

    Parameters
    ----------
    state
        State of the campaign with both axes, if the logs are already read.
    """
    compared = diagnosed_lateral(asked, state)
    if isinstance(compared, Unanswered):
        return asked.refused(compared)
    return asked.answered(lateral_answer(asked, *proved_lateral(asked, compared)))


def diagnosed_lateral(asked: GapAsked, state: CampaignState | None = None) -> SideCompared | Unanswered:
    """Return the diagnosis of roll and yaw, or the reason for none."""
    with Stages() as tell:

        def compare() -> SideCompared:
            if state is not None:
                return compare_side_flown(state, asked.aircraft, asked.prior, tell)
            tell("reading", 0.0)
            read = asked.read
            return compare_side_logs(
                read.logs,
                asked.aircraft,
                read.target_system,
                read.marks,
                no_marks=read.no_marks,
                prior=asked.prior,
                progress=tell,
            )

        return asked.attempted("lateral, diagnosis", compare)


def proved_lateral(asked: GapAsked, compared: SideCompared) -> tuple[SideCompared, Proof | None]:
    """Return what stays of a diagnosis after the proof that was asked for, and the proof."""
    proof = proof_of(asked.proving, partial(_prove, asked, compared))
    return stays_of_side(compared, proof), proof


def lateral_answer(
    asked: GapAsked, compared: SideCompared, proof: Proof | None, writes: bool = True
) -> AxisAnswer:
    """Return the answer of roll and yaw.

    Parameters
    ----------
    writes
        Whether this axis writes the model files that were asked for.
    """
    found = compared.gap
    written, outcomes = None, []
    if writes:
        written = asked.improved(found.improves, lambda: replace(improved_side(compared), pitch=None))
        outcomes = write_exports(asked.orders, partial(improved_side, compared))
    if found.traces:
        write_figure(asked.figure, lambda: axis_document(found))
    document = gap_document(found) | {"exports": listed(outcomes)}
    named = {"improved_model": None if written is None else str(written)}
    document["lateral"] |= named | proof_document(proof)

    def show() -> None:
        click.echo("\n".join(side_gap_lines(found)))
        if asked.why and found.evidence:
            PlainConsole().print(*why_of(found))
        print_proof(proof)
        if written is not None:
            click.echo(f"The improved simulator is in {printable(str(written))}.")

    return AxisAnswer(document, show, USAGE if any(outcome.problem for outcome in outcomes) else 0)


def _prove(
    asked: GapAsked, compared: SideCompared, named: Sequence[Path], tell: Callable[[str, float], None]
) -> Proof:
    """Fly the improved roll and yaw on the manoeuvres of logs; without any, on the last third."""
    tell("flying for the proof", 0.0)
    fresh = None
    if named:
        target, no_marks = asked.read.target_system, asked.read.no_marks
        read = read_whole(named, compared.aircraft, target, no_marks=no_marks, axis="lateral")
        fresh = accepted_of(read.state)
    return prove_side(compared, fresh, asked.prior, tell)
