"""``advisor analyze``: verdicts on the manoeuvres of a log, as text or JSON."""

import json
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

import click

from advisor.campaign.state import NOTHING
from advisor.cli.doctor import examine_log
from advisor.cli.improvement_export import export_option, orders_of, write_exports
from advisor.cli.options import UNUSABLE, USAGE, LogsAsked, json_option, log_options
from advisor.cli.running import Stages
from advisor.words.problems import Problem, printable

if TYPE_CHECKING:
    from advisor.aircraft.aircraft import Aircraft
    from advisor.analysis.marks_file import LogSeries
    from advisor.analysis.whole_flights import Axis
    from advisor.campaign.campaign import Campaign
    from advisor.campaign.state import CampaignState
    from advisor.exports.models.flown import FlownModel


@click.command
@log_options("rule", "marks", "no_marks", "fixes", "terms")
@click.option(
    "--all",
    "every_movement",
    is_flag=True,
    help="List also the elevator movements that were no test inputs, and the course of every rule.",
)
@click.option(
    "--axis",
    type=click.Choice(["pitch", "lateral", "both"]),
    default="both",
    show_default=True,
    help="Axis to analyze: pitch (elevator), lateral (aileron and rudder), or both.",
)
@export_option(
    "Write the model of the flight, both axes, as jsbsim, ardupilot, matlab or aircraft; repeatable."
)
@json_option
def command(
    asked: LogsAsked, every_movement: bool, axis: "Axis", exports: tuple[str, ...], as_json: bool
) -> int:
    """Print every manoeuvre's verdict, the estimates, and stop or continue.

    Several logs are one campaign of several flights. Manoeuvres are numbered through all logs, and a
    manoeuvre that is in two logs counts once.

    \b
    Example:
      advisor analyze flight.tlog --aircraft my-aircraft.yaml
      advisor analyze battery-1.tlog battery-2.bin --aircraft my-aircraft.yaml
      advisor analyze flight.tlog --maneuver +12:+24 --maneuver 312.5:320
      advisor analyze flight.tlog --json | python -m json.tool
      advisor analyze flight.tlog --fix Z_q=0 --term "M:q*abs(q)"
      advisor analyze flight.tlog --axis lateral --export matlab:roll-and-yaw.m
    """
    aircraft = asked.read_aircraft()
    orders = orders_of(exports, aircraft, asked.inputs, "both")
    from advisor.analysis.marks_file import LogSeries
    from advisor.analysis.whole_flights import holds_no_test

    series = LogSeries(asked.logs, aircraft.columns)
    by_hand = NOTHING if asked.no_marks else series.read_by_hand()
    from advisor.campaign.campaign import Campaign

    campaign = partial(
        Campaign,
        aircraft,
        asked.target_system,
        by_hand=by_hand,
        marks=asked.marks,
        names=series.names,
        lateral=axis != "pitch",
    )
    with Stages() as tell:
        tell("reading and judging", 0.0)
        state, left_out = _analyze(series, campaign, axis)
    usable = len(left_out) < len(asked.logs)
    said = [series.order_said] if series.order_said else []
    for flight, problems in sorted(left_out.items()):
        said += [problem.about(series.names[flight]) for problem in problems]
    said += [part.sentence for part in (state.failed if state else ())]
    if as_json:
        from advisor.report.document import analysis_document

        files = [str(log) for log in series.logs]
        document = analysis_document(state, files, aircraft, left_out, said)
        click.echo(json.dumps(document, allow_nan=False, indent=1))
    elif state is not None and usable:
        from advisor.report.text import AnalysisText, PlainConsole

        shown = AnalysisText(
            state, list(map(printable, series.names)), aircraft, every_movement, pitch=axis != "lateral"
        )
        PlainConsole(soft_wrap=True).print(shown)
    elif state is not None and holds_no_test(left_out):
        print_untested(state, series, aircraft, asked.target_system, axis)
    if state is not None and not usable and every_movement and not as_json:
        from advisor.report.text import activity_line

        for activity in state.activity:
            click.echo(activity_line(activity))
    for sentence in said:
        click.echo(sentence, err=True)
    if state is None or not usable:
        return UNUSABLE
    outcomes = write_exports(orders, partial(_flown_model, state, aircraft))
    return USAGE if any(outcome.problem for outcome in outcomes) else 0


def _flown_model(state: "CampaignState", aircraft: "Aircraft") -> "FlownModel":
    from advisor.exports.models.flown import flown_model

    return flown_model(state, aircraft)


def _analyze(
    series: "LogSeries", make_campaign: "Callable[[], Campaign]", axis: "Axis"
) -> "tuple[CampaignState | None, dict[int, tuple[Problem, ...]]]":
    """Return the campaign at the end of the logs, None without a usable log, and by flight the reasons why
    logs do not count.
    """
    from advisor.analysis.whole_flights import left_out_of

    campaign = series.fed_to(make_campaign, lambda campaign, columns: campaign.feed(columns))
    unreadable: dict[int, tuple[Problem, ...]] = {
        flight: (problem,) for flight, problem in series.unreadable.items()
    }
    if len(unreadable) == len(series.logs):
        return None, unreadable
    campaign.finish()
    state = campaign.state
    return state, left_out_of(axis, state) | unreadable


_COLUMNS = 80
"""Width of the drawing, columns, which fits a narrow terminal."""


def print_untested(
    state: "CampaignState", series: "LogSeries", aircraft: "Aircraft", target_system: int | None, axis: "Axis"
) -> None:
    """Print the next input of each axis with its drawing, then the telemetry examination of each log."""
    from advisor.doctor.text import ExaminationText
    from advisor.report.text import PlainConsole
    from advisor.tui.stick_drawing import drawn

    tests = [state.flight_test] if axis != "lateral" else []
    tests += [state.lateral.flight_test] if state.lateral is not None else []
    for test in tests:
        click.echo(test.sentence)
        if test.next is not None:
            click.echo(drawn(test.next, _COLUMNS, large=True))
        click.echo()
    for name, log in zip(series.names, series.logs, strict=True):
        click.echo(f"Even so, {printable(name)} tells:")
        PlainConsole(soft_wrap=True).print(ExaminationText(examine_log(log, aircraft, target_system)))
