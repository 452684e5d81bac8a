"""``advisor analyze``: a log judged without a screen."""

import json
from pathlib import Path
from typing import Literal

import click

from advisor.aircraft import Aircraft, Rule
from advisor.campaign_state import CampaignState
from advisor.commands.options import (
    UNUSABLE,
    aircraft_option,
    json_option,
    read_aircraft,
    rule_option,
    target_system_option,
)
from advisor.problems import Problem, UnusableInputError


@click.command
@click.argument("log", type=click.Path(path_type=Path))
@aircraft_option
@rule_option
@target_system_option
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
    method: Literal["gauss-newton", "nelder-mead"],
    every_movement: bool,
    as_json: bool,
) -> int:
    """Every manoeuvre's verdict, the estimates, stop or continue: as text, or as one JSON document.

    \b
    Example:
      advisor analyze flight.tlog --aircraft my-aircraft.yaml
      advisor analyze flight.tlog --json | python -m json.tool
    """
    aircraft = read_aircraft(aircraft_file, rule)
    state, problems = _analyze(log, aircraft, target_system, method)
    if as_json:
        from advisor.report.document import analysis_document

        click.echo(
            json.dumps(analysis_document(state, str(log), aircraft, problems), allow_nan=False, indent=1)
        )
    elif state is not None and not problems:
        from rich.console import Console

        from advisor.report.text import AnalysisText

        Console(highlight=False, soft_wrap=True).print(
            AnalysisText(state, log.name, aircraft, every_movement)
        )
    elif state is not None and every_movement:
        from advisor.report.text import activity_line

        for activity in state.activity:
            click.echo(activity_line(activity))
    for problem in problems:
        click.echo(problem.about(log.name), err=True)
    return UNUSABLE if problems else 0


def _analyze(
    log: Path, aircraft: Aircraft, target_system: int | None, method: Literal["gauss-newton", "nelder-mead"]
) -> tuple[CampaignState | None, list[Problem]]:
    from advisor.campaign import Campaign
    from advisor.mavlink.logs import open_log

    campaign = Campaign(aircraft, target_system, method=method)
    try:
        for columns in open_log(log):
            campaign.feed(columns)
    except UnusableInputError as error:
        return None, [error.problem]
    campaign.finish()
    return campaign.state, campaign.problems
