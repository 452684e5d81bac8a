"""``advisor doctor``: whether the telemetry is good enough, before a flight."""

import json
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click
from click.shell_completion import CompletionItem

from advisor.aircraft.aircraft import Aircraft
from advisor.cli.options import UNUSABLE, LogsAsked, json_option, log_options
from advisor.words.problems import Problem, UnusableInputError, printable

if TYPE_CHECKING:
    from advisor.doctor.examination import Examination


@click.command
@click.argument(
    "target",
    metavar="LOG|CONN",
    shell_complete=lambda ctx, parameter, text: [CompletionItem(text, type="file")],
)
@click.option(
    "--seconds", type=click.FloatRange(min=1.0), default=15.0, show_default=True, help="Time to listen, s."
)
@click.option(
    "--request-rates",
    is_flag=True,
    help="First ask the vehicle for streams of 50 Hz and for its servo parameters.",
)
@log_options(logs=False)
@json_option
def command(asked: LogsAsked, target: str, seconds: float, request_rates: bool, as_json: bool) -> int:
    """Check whether the telemetry is good enough to identify the aircraft, and say what to change.

    The command reads a log, or listens to a live link. Nothing is sent to the vehicle without
    --request-rates.

    \b
    Example:
      advisor doctor udpin:0.0.0.0:14550 --aircraft my-aircraft.yaml
      advisor doctor flight.tlog --json
    """
    aircraft = asked.read_aircraft()
    findings, problem = None, None
    try:
        if _is_log(target):
            from advisor.analysis.gap import as_in_tables

            log = Path(target)
            findings = examine_log(log, as_in_tables(aircraft, [log]), asked.target_system)
        else:
            findings = _examine_link(target, aircraft, asked.target_system, seconds, request_rates)
    except UnusableInputError as error:
        problem = error.problem
    commands: tuple[str, ...] = ()
    if findings is not None:
        from advisor.doctor.examination import ExaminedInput, next_commands

        file = str(asked.aircraft_file) if asked.aircraft_file else None
        has_model = bool(aircraft.model) or aircraft.simulator is not None
        commands = next_commands(
            findings, ExaminedInput(target, _is_log(target), file, asked.target_system, has_model)
        )
    if as_json:
        from advisor.doctor.text import doctor_document

        click.echo(json.dumps(doctor_document(findings, problem, commands), allow_nan=False, indent=1))
    elif findings is not None:
        from advisor.doctor.text import ExaminationText
        from advisor.report.text import PlainConsole

        PlainConsole(soft_wrap=True).print(ExaminationText(findings, commands))
    sentence = problem or _first_obstacle(findings)
    if sentence is None:
        return 0
    click.echo(sentence.about(target), err=True)
    return UNUSABLE


def _is_log(target: str) -> bool:
    """Return whether the target must be a file, because it is neither a network address nor a device."""
    from advisor.mavlink.logs.formats import ENDINGS

    if Path(target).is_file() or target.lower().endswith(ENDINGS):
        return True
    return ":" not in target and "," not in target and not target.startswith("/dev/")


def _first_obstacle(findings: "Examination | None") -> Problem | None:
    stopping = [limit for limit in findings.limits if limit.stops] if findings else []
    return Problem(stopping[0].code, f"{stopping[0].text}.", f"Fix: {stopping[0].fix}.") if stopping else None


def examine_log(log: Path, aircraft: Aircraft, target_system: int | None) -> "Examination":
    """Return the examination of a log's telemetry.

    Raises
    ------
    UnusableInputError
        The log cannot be read.
    """
    from advisor.analysis.vibration import vibration_of
    from advisor.doctor.examiner import Examiner
    from advisor.mavlink.logs.logs import read_whole_log
    from advisor.mavlink.wire.frames import FrameScanner, Received

    examiner, scanner = Examiner(aircraft, target_system), FrameScanner()
    for columns in read_whole_log(log, scanner=scanner, columns=aircraft.columns):
        examiner.feed(columns)
    vehicle = examiner.vehicle
    senders = scanner.statistics.senders
    came = senders.get((vehicle.system, vehicle.component), Received()) if vehicle else Received()
    state = examiner.findings(repeated_percent=came.repeated_percent, repeated_after_s=came.repeated_after_s)
    unit_s = state.expectation.unit_s if state.expectation else None
    return replace(state, notes=(*state.notes, *vibration_of(log, aircraft.columns).notes(unit_s)))


def _examine_link(
    connection: str, aircraft: Aircraft, target_system: int | None, seconds: float, request_rates: bool
) -> "Examination":
    from advisor.doctor.examiner import Examiner
    from advisor.mavlink.link.inquiry import Inquiry
    from advisor.mavlink.link.link import Link
    from advisor.mavlink.link.outgoing import Talker
    from advisor.mavlink.link.rates import STREAMS, RateRequest

    talkers: list[Talker] = []
    if request_rates:
        talkers = [RateRequest(dict.fromkeys(STREAMS, 50.0)), Inquiry()]
    examiner = Examiner(aircraft, target_system)
    with Link(connection, target_system=target_system, talkers=talkers) as link:
        click.echo(f"Listening on {printable(connection)} for {seconds:g} s ...", err=True)
        until_s = time.monotonic() + seconds
        while time.monotonic() < until_s:
            examiner.feed(link.read(0.1))
        for notice in link.take_notices():
            click.echo(notice, err=True)
        came = link.statistics
        return examiner.findings(came.lost_percent, came.repeated_percent, came.repeated_after_s)
