"""``advisor gap --axis lateral``: the simulator's roll and yaw against the flight's."""

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import click

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.side_gap import SideCompared, accepted_of, compare_side_flown, compare_side_logs
from advisor.analysis.whole_flights import read_whole
from advisor.campaign.state import CampaignState
from advisor.cli.gap import compared_or_code, write_improved
from advisor.cli.gap_figure import write_figure
from advisor.cli.improvement_export import listed, write_exports
from advisor.cli.log_options import LogsAsked
from advisor.cli.options import USAGE
from advisor.cli.proving import document as proof_document
from advisor.cli.proving import print_proof, proof_of
from advisor.cli.stages import Stages
from advisor.exports.models.axes.lateral import prove_side, stays_of_side
from advisor.exports.models.proof import Proof
from advisor.exports.models.roll_and_yaw import improved_side
from advisor.exports.models.write import ExportOrder
from advisor.gap.inference.prior import FIELD, FieldPrior, field_prior
from advisor.gap.result import IMPROVING
from advisor.report.console import PlainConsole
from advisor.report.gap_causes import why_of
from advisor.report.side_gap import side_gap_document, side_gap_lines, whole_document
from advisor.words.printable import printable


def compare_lateral(
    asked: LogsAsked,
    aircraft: Aircraft,
    as_json: bool,
    prior: str | None,
    out: Path | None,
    orders: list[ExportOrder],
    proving: Sequence[str] = (),
    why: bool = False,
    figure: Path | None = None,
    state: CampaignState | None = None,
) -> int:
    """Compare roll and yaw of the aircraft file with the flight, print the result and write the files.

    ``state``: the logs' campaign with both axes, if they are already read.
    """
    shares = FIELD if prior is None else field_prior(prior)
    with Stages() as tell:

        def compare() -> SideCompared:
            if state is not None:
                return compare_side_flown(state, aircraft, shares, tell)
            tell("reading", 0.0)
            return compare_side_logs(
                asked.logs,
                aircraft,
                asked.target_system,
                asked.marks,
                no_marks=asked.no_marks,
                prior=shares,
                progress=tell,
            )

        compared = compared_or_code("lateral, diagnosis", compare, as_json)
    if isinstance(compared, int):
        return compared
    proof = proof_of(proving, partial(_prove, asked, compared, shares))
    compared = stays_of_side(compared, proof)
    found = compared.gap
    improves = found.verdict in IMPROVING
    written = write_improved(out, improves, lambda: replace(improved_side(compared), pitch=None))
    outcomes = write_exports(orders, partial(improved_side, compared))
    if found.traces:
        write_figure(figure, lambda: side_gap_document(found))
    if as_json:
        document = whole_document(found) | {"exports": listed(outcomes)}
        document["lateral"] |= {"improved_model": str(out) if written else None} | proof_document(proof)
        click.echo(json.dumps(document, allow_nan=False, indent=1))
    else:
        click.echo("\n".join(side_gap_lines(found)))
        if why and found.diagnosis is not None:
            PlainConsole().print(*why_of(found.diagnosis))
        print_proof(proof)
        if written:
            click.echo(f"The improved simulator is in {printable(str(out))}.")
    return USAGE if any(one.problem for one in outcomes) else 0


def _prove(
    asked: LogsAsked,
    compared: SideCompared,
    prior: FieldPrior,
    named: Sequence[Path],
    tell: Callable[[str, float], None],
) -> Proof:
    """Fly the improved roll and yaw on the manoeuvres of logs; without any, on the last third."""
    tell("flying for the proof", 0.0)
    fresh = None
    if named:
        read = read_whole(
            named, compared.aircraft, asked.target_system, no_marks=asked.no_marks, axis="lateral"
        )
        fresh = accepted_of(read.state)
    return prove_side(compared, fresh, prior, tell)
