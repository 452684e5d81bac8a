"""``advisor aircraft``: write an aircraft file, or check one for missing keys."""

import json
import shlex
from dataclasses import asdict
from functools import partial
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING

import click

from advisor.aircraft.aircraft import Aircraft
from advisor.cli.options import json_option, read_aircraft, refuse_unwritable, target_system_option
from advisor.process.first_run import compile_once
from advisor.words.problems import ConfigurationError, printable

if TYPE_CHECKING:
    from advisor.aircraft_file.log_facts import Lack, LogFacts


SCHEMA = "advisor.aircraft/1"


@click.group
def command() -> None:
    """Write an aircraft file, or list missing keys with their cost.

    \b
    Example:
      advisor aircraft new --from flight.tlog -o my-aircraft.yaml
      advisor aircraft check my-aircraft.yaml --log flight.tlog
      advisor aircraft schema > aircraft.schema.json
    """


@command.command
@click.option(
    "--from", "log", type=click.Path(path_type=Path), metavar="LOG", help="Log whose facts the file takes."
)
@click.option(
    "-o",
    "--out",
    type=click.Path(path_type=Path),
    default=Path("aircraft.yaml"),
    show_default=True,
    help="File to write.",
)
@click.option("--blank", is_flag=True, help="Write every key as a comment, as without --from.")
@click.option("--force", is_flag=True, help="Replace a file that exists.")
@target_system_option
def new(log: Path | None, out: Path, blank: bool, force: bool, target_system: int | None) -> None:
    """Write a commented aircraft file, blank or from a log.

    A log gives the outputs with their functions and limits, the air speed, the pressure, and the source of
    the angle of attack. An unknown key becomes a comment that states the cost of its absence.

    \b
    Example:
      advisor aircraft new
      advisor aircraft new --from flight.tlog -o my-aircraft.yaml
    """
    from advisor.aircraft_file.proposal import Draft, aircraft_text, proposed
    from advisor.aircraft_file.read import load_aircraft
    from advisor.doctor.examination import USUAL_LINK
    from advisor.process.atomic_file import write_atomically

    if blank and log is not None:
        raise ConfigurationError("--blank and --from contradict each other; give one of them.")
    refuse_unwritable("-o", out)
    if out.exists() and not force:
        raise ConfigurationError(f"-o: {out} exists; name another file, or add --force to replace this one.")
    if log is None:
        head = ["Aircraft file of the inflight advisor. Remove the # in front of a key that you know."]
        draft = Draft(head=head, values={})
    else:
        draft = proposed(_facts(log, Aircraft(), target_system), printable(log.name))
        draft.values.setdefault("name", printable(log.stem))
    write_atomically(out, aircraft_text(draft))
    load_aircraft(out)
    click.echo(f"Wrote {printable(str(out))}.")
    for sentence in draft.unsure:
        click.echo(f"! {sentence}")
    examined = ["--log", str(log)] if log else []
    chosen = ["--target-system", str(target_system)] if target_system is not None else []
    click.echo("Next:")
    for command in (
        ["aircraft", "check", str(out), *examined, *(chosen if log else [])],
        ["doctor", str(log or USUAL_LINK), "--aircraft", str(out), *chosen],
    ):
        click.echo(f"  {printable(shlex.join(['advisor', *command]))}")


@command.command
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "--log", type=click.Path(path_type=Path), metavar="LOG", help="Compare the file with this log as well."
)
@target_system_option
@json_option
def check(file: Path, log: Path | None, target_system: int | None, as_json: bool) -> None:
    """Read an aircraft file, and list missing keys with their cost.

    \b
    Example:
      advisor aircraft check my-aircraft.yaml
      advisor aircraft check my-aircraft.yaml --log flight.tlog --json
    """
    from advisor.aircraft_file.log_facts import known_keys, lacks_of

    aircraft = read_aircraft(file)
    facts = _facts(log, aircraft, target_system) if log else None
    lacks = lacks_of(aircraft, facts)
    if log is not None:
        lacks = (*_contradicted(log, aircraft, target_system), *lacks)
    if as_json:
        document = {"schema": SCHEMA, "usable": True, "problems": [], "name": aircraft.name}
        document |= {"given": known_keys(aircraft), "lacks": [asdict(lack) for lack in lacks]}
        click.echo(json.dumps(document, indent=1))
        return
    click.echo(f"{printable(str(file))} is a valid aircraft file: {aircraft.name}.")
    click.echo(f"Given: {', '.join(known_keys(aircraft)) or 'no key that estimates rest on'}.")
    _list("Does not fit the log:", [lack for lack in lacks if lack.wrong])
    _list("Missing, with the cost:", [lack for lack in lacks if not lack.wrong])
    if not lacks:
        click.echo("Nothing is missing.")


@command.command
def schema() -> None:
    """Print the JSON schema of the aircraft file. An editor completes and explains the file's keys by this
    schema.

    \b
    Example:
      advisor aircraft schema > aircraft.schema.json
    """
    from advisor.aircraft_file.read import aircraft_schema

    click.echo(json.dumps(aircraft_schema(), indent=1, ensure_ascii=False))


def _list(title: str, lacks: "list[Lack]") -> None:
    if not lacks:
        return
    click.echo(f"\n{title}")
    for lack in lacks:
        click.echo(f"  {lack.key}")
        click.echo(fill(lack.cost, 96, initial_indent="    ", subsequent_indent="    "))
        click.echo(f"    -> {lack.mend}.")


def _contradicted(log: Path, aircraft: Aircraft, target_system: int | None) -> "list[Lack]":
    """Return the keys that the log's manoeuvres contradict, as in ``advisor analyze``."""
    from advisor.aircraft_file.log_facts import contradicted
    from advisor.analysis.whole_flights import read_whole
    from advisor.words.problems import UnusableInputError

    try:
        state = read_whole([log], aircraft, target_system, axis="both", untested=True).state
    except UnusableInputError:
        return []
    return contradicted(state.instruments)


def _facts(log: Path, aircraft: Aircraft, target_system: int | None) -> "LogFacts":
    from advisor.aircraft_file.log_facts import facts_of
    from advisor.mavlink.logs.logs import read_whole_log

    compile_once(partial(click.echo, err=True))
    return facts_of(read_whole_log(log, columns=aircraft.columns), aircraft, target_system)
