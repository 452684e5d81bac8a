"""``advisor analyze``: a log judged without a screen."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from advisor.aircraft import Rule
from advisor.campaign_state import CampaignState
from advisor.commands.options import (
    UNUSABLE,
    aircraft_option,
    decided_on,
    json_option,
    maneuver_option,
    no_marks_option,
    read_aircraft,
    rule_option,
    target_system_option,
)
from advisor.printable import printable
from advisor.problems import Problem, UnusableInputError

if TYPE_CHECKING:
    from advisor.campaign import Campaign
    from advisor.flight.marks import Mark


@click.command
@click.argument("log", type=click.Path(path_type=Path))
@aircraft_option
@rule_option
@target_system_option
@maneuver_option
@no_marks_option
@click.option(
    "--method",
    type=click.Choice(["gauss-newton", "nelder-mead"]),
    default="gauss-newton",
    show_default=True,
    help="Search for each manoeuvre's optimum; nelder-mead is the paper's, slower by far.",
)
@click.option(
    "--all", "every_movement", is_flag=True, help="List also what moved the elevator and was no test input."
)
@json_option
def command(
    log: Path,
    aircraft_file: Path | None,
    rule: Rule | None,
    target_system: int | None,
    marks: "tuple[Mark, ...]",
    no_marks: bool,
    method: Literal["gauss-newton", "nelder-mead"],
    every_movement: bool,
    as_json: bool,
) -> int:
    """Every manoeuvre's verdict, the estimates, stop or continue: as text, or as one JSON document.

    \b
    Example:
      advisor analyze flight.tlog --aircraft my-aircraft.yaml
      advisor analyze flight.tlog --maneuver +12:+24 --maneuver 312.5:320
      advisor analyze flight.tlog --json | python -m json.tool
    """
    aircraft = read_aircraft(aircraft_file, rule)
    by_hand = decided_on(log, no_marks)
    from advisor.campaign import Campaign

    campaign = Campaign(aircraft, target_system, method=method, by_hand=by_hand, marks=marks)
    state, problems = _analyze(log, campaign)
    if as_json:
        from advisor.report.document import analysis_document

        click.echo(
            json.dumps(analysis_document(state, str(log), aircraft, problems), allow_nan=False, indent=1)
        )
    elif state is not None and not problems:
        from advisor.report.console import PlainConsole
        from advisor.report.text import AnalysisText

        shown = AnalysisText(state, printable(log.name), aircraft, every_movement)
        PlainConsole(soft_wrap=True).print(shown)
    elif state is not None and every_movement:
        from advisor.report.text import activity_line

        for activity in state.activity:
            click.echo(activity_line(activity))
    for problem in problems:
        click.echo(problem.about(log.name), err=True)
    return UNUSABLE if problems else 0


def _analyze(log: Path, campaign: "Campaign") -> tuple[CampaignState | None, list[Problem]]:
    from advisor.mavlink.logs import open_log

    try:
        for columns in open_log(log):
            campaign.feed(columns)
    except UnusableInputError as error:
        return None, [error.problem]
    campaign.finish()
    return campaign.state, campaign.problems
