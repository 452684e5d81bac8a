"""``advisor export``: a flight's data for other tools."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from advisor.aircraft.aircraft import Rule
from advisor.cli.options import (
    aircraft_option,
    maneuver_option,
    no_marks_option,
    read_aircraft,
    refuse_marks_on_several,
    refuse_unwritable,
    refuse_unwritable_folder,
    rule_option,
    target_system_option,
)
from advisor.exports.flights.formats import WRITERS, parse_formats, write_formats
from advisor.exports.flights.staging import refuse_inputs, staged
from advisor.words.printable import printable
from advisor.words.problems import ConfigurationError

if TYPE_CHECKING:
    from advisor.flight.maneuvers.marks import Mark


@click.command
@click.argument("logs", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--out",
    "out",
    required=True,
    type=click.Path(path_type=Path),
    metavar="DIR|FILE",
    help="Folder to write to; with --cut, the log to write.",
)
@click.option(
    "--format",
    "formats",
    metavar="NAMES",
    help=f"Formats, separated by commas: {', '.join(WRITERS)}. Default: csv.",
)
@click.option(
    "--cut",
    type=click.IntRange(1),
    metavar="N",
    help="Write only the packets of manoeuvre N, as a tlog.",
)
@aircraft_option
@rule_option
@target_system_option
@maneuver_option
@no_marks_option
def command(
    logs: tuple[Path, ...],
    out: Path,
    formats: str | None,
    cut: int | None,
    aircraft_file: Path | None,
    rule: Rule | None,
    target_system: int | None,
    marks: "tuple[Mark, ...]",
    no_marks: bool,
) -> int:
    """Write channels, manoeuvres, estimates and residuals for other tools, with names and units.

    The numbers are those of `advisor analyze`. The page of exports lists files, units and grid.

    \b
    Example:
      advisor export flight.tlog -o flight --format csv,parquet,mat,mcap
      advisor export flight.tlog -o maneuver-3.tlog --cut 3
    """
    inputs = [*logs, *([aircraft_file] if aircraft_file else [])]
    if cut is not None:
        _refuse_wrong_cut(formats, out, inputs)
    else:
        refuse_unwritable_folder("-o", out)
    chosen = () if cut is not None else parse_formats(formats or "csv")
    aircraft = read_aircraft(aircraft_file, rule)
    refuse_marks_on_several(marks, logs)
    from advisor.analysis.whole_flights import read_whole
    from advisor.exports.flights.reading import dataset

    flights = read_whole(logs, aircraft, target_system, marks, no_marks=no_marks)
    for note in flights.notes:
        click.echo(printable(note), err=True)
    if cut is not None:
        from advisor.exports.flights.maneuver_log import log_of_maneuver

        data = log_of_maneuver(flights, cut, aircraft, target_system)
        with staged(out.parent, inputs) as stage:
            (stage / out.name).write_bytes(data)
        click.echo(f"{printable(str(out))}: manoeuvre {cut}, {len(data)} bytes.")
        return 0
    with staged(out, inputs) as stage:
        write_formats(dataset(flights), stage, chosen)
    click.echo(
        f"{printable(str(out))}: manoeuvres: {len(flights.state.maneuvers)}; formats: {', '.join(chosen)}."
    )
    return 0


def _refuse_wrong_cut(formats: str | None, out: Path, inputs: Sequence[Path]) -> None:
    if formats is not None:
        raise ConfigurationError("--cut writes a tlog: leave out --format, or leave out --cut.")
    refuse_unwritable("-o", out)
    refuse_inputs([out], inputs)
