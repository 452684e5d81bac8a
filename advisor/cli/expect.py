"""``advisor expect``: compare a flight with a file of expectations."""

import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from advisor.cli.options import (
    UNMET,
    UNUSABLE,
    LogsAsked,
    json_option,
    log_options,
    refuse_unwritable,
    writing,
)
from advisor.cli.running import Stages
from advisor.words.problems import ConfigurationError, Problem, UnusableInputError, printable

if TYPE_CHECKING:
    from advisor.aircraft.aircraft import Aircraft
    from advisor.analysis.whole_flights import WholeFlights
    from advisor.expectations.check import Outcome
    from advisor.expectations.read import Expectations


@click.command
@click.argument("log", type=click.Path(path_type=Path))
@click.argument("file", type=click.Path(path_type=Path))
@log_options("rule", "marks", "no_marks", logs=False)
@click.option(
    "--junit", type=click.Path(path_type=Path), metavar="XML", help="File for the report as JUnit XML."
)
@click.option(
    "--write",
    is_flag=True,
    help="Write the results of LOG as expectations into FILE, with tolerances for the next flight.",
)
@json_option
def command(asked: LogsAsked, log: Path, file: Path, junit: Path | None, write: bool, as_json: bool) -> int:
    """Test a flight: compare LOG with the expectations in FILE (YAML).

    FILE asks for accepted manoeuvres, completion, derivatives, modes, levels, gap, pauses and alarms. The
    exit code is 1 if an expectation does not hold.

    \b
    Example:
      advisor expect flight.tlog expectations.yaml --write
      advisor expect flight.tlog expectations.yaml --aircraft my-aircraft.yaml
      advisor expect flight.tlog expectations.yaml --junit report.xml --json
    """
    _refuse(asked, log, file, junit, write, as_json)
    asked = replace(asked, logs=(log,))
    aircraft = asked.read_aircraft()
    if write:
        return _write(asked, aircraft, file)
    from advisor.expectations.check import expect_document
    from advisor.expectations.check import junit as junit_report
    from advisor.expectations.read import read_expectations

    expected = read_expectations(file, aircraft)
    outcomes: list[Outcome] = []
    problems: tuple[Problem, ...] = ()
    try:
        outcomes = _checked(asked, aircraft, expected)
        code = 0 if all(outcome.holds for outcome in outcomes) else UNMET
    except UnusableInputError as error:
        problems, code = error.problems, UNUSABLE
    if junit is not None:
        from advisor.process.atomic_file import write_atomically

        with writing("--junit", junit):
            write_atomically(junit, junit_report(log.name, file.name, outcomes, problems))
    if as_json:
        document = expect_document(str(log), str(file), outcomes, problems)
        click.echo(json.dumps(document, allow_nan=False, indent=1))
    else:
        _print(outcomes, log)
    for problem in problems:
        click.echo(str(problem), err=True)
    return code


def _refuse(asked: LogsAsked, log: Path, file: Path, junit: Path | None, write: bool, as_json: bool) -> None:
    """Refuse, before any work, options that would fail after the work."""
    if write and (junit is not None or as_json):
        raise ConfigurationError(
            "--write checks nothing: leave out --junit and --json, or leave out --write."
        )
    if write and file.exists():
        raise ConfigurationError(f"--write: {file} exists already; name another file, or remove this one.")
    if write:
        refuse_unwritable("--write", file)
    if junit is not None:
        refuse_unwritable("--junit", junit)
        if any(p.exists() and junit.exists() and p.samefile(junit) for p in (log, file, *asked.inputs)):
            raise ConfigurationError(f"--junit: {junit} is an input of the command; name another file.")


def _read(asked: LogsAsked, aircraft: "Aircraft") -> "WholeFlights":
    from advisor.analysis.whole_flights import read_whole

    return read_whole(
        asked.logs, aircraft, asked.target_system, asked.marks, no_marks=asked.no_marks, axis="both"
    )


def _checked(asked: LogsAsked, aircraft: "Aircraft", expected: "Expectations") -> "list[Outcome]":
    """Return the outcome of every expectation.

    Raises
    ------
    UnusableInputError
        The log, or the log of ``of: log``, cannot be used.
    """
    from advisor.expectations.check import check
    from advisor.expectations.flown import flown_of, gap_of

    with Stages() as tell:
        tell("reading and judging", 0.0)
        flights = _read(asked, aircraft)
        gap = {axis: gap_of(axis, flights, aircraft, asked.target_system, tell) for axis in expected.gap}
        other = None
        if expected.asks_of_log and expected.log is not None:
            tell("reading the log of the expectations", 0.9)
            other = flown_of(_read(LogsAsked((expected.log,)), aircraft), aircraft, {})
        for note in flights.notes:
            click.echo(printable(note), err=True)
        return check(expected, flown_of(flights, aircraft, gap), aircraft, other)


def _write(asked: LogsAsked, aircraft: "Aircraft", file: Path) -> int:
    from advisor.expectations.draft import draft
    from advisor.expectations.flown import flown_of
    from advisor.process.atomic_file import write_atomically

    with Stages() as tell:
        tell("reading and judging", 0.0)
        flown = flown_of(_read(asked, aircraft), aircraft, {})
    with writing("--write", file):
        write_atomically(file, draft(flown, asked.logs[0].name))
    click.echo(f"Wrote {printable(str(file))}.", err=True)
    return 0


def _print(outcomes: "list[Outcome]", log: Path) -> None:
    from advisor.report.text import PlainConsole, Table

    if not outcomes:
        return
    rows = tuple((o.name, o.asked, o.found, "✓" if o.holds else "✗ no") for o in outcomes)
    table = Table("expectations", "", ("expectation", "asked", "found", "holds"), rows)
    PlainConsole().print(table.on_console())
    failed = sum(not outcome.holds for outcome in outcomes)
    said = (
        "every expectation holds" if not failed else f"{failed} of {len(outcomes)} expectations do not hold"
    )
    click.echo(f"{printable(log.name)}: {said}.")
