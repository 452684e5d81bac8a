"""``advisor export``: a flight's data for other tools."""

from pathlib import Path

import click

from advisor.cli.options import LogsAsked, log_options, refuse_unwritable_folder
from advisor.cli.running import Stages
from advisor.exports.flights.formats import WRITERS, parse_formats, staged, write_formats
from advisor.exports.models.names import NAMES
from advisor.words.problems import printable


@click.command
@log_options("rule", "marks", "no_marks")
@click.option(
    "-o",
    "--out",
    "out",
    required=True,
    type=click.Path(path_type=Path),
    metavar="DIR",
    help="Folder to write to.",
)
@click.option(
    "--format",
    "formats",
    metavar="NAMES",
    help=f"Formats, separated by commas: {', '.join(WRITERS)}; of the model as flown: {', '.join(NAMES)}. "
    "Default: csv.",
)
def command(asked: LogsAsked, out: Path, formats: str | None) -> int:
    """Write channels, manoeuvres, estimates and residuals for other tools, with names and units.

    The numbers are those of `advisor analyze`. The documentation's page on exports lists the files, units and
    the time grid.

    \b
    Example:
      advisor export flight.tlog -o flight --format csv,parquet,mat,mcap
      advisor export flight.tlog -o flight --format ardupilot,matlab --aircraft my-aircraft.yaml
    """
    inputs = asked.inputs
    refuse_unwritable_folder("-o", out)
    chosen = parse_formats(formats or "csv")
    aircraft = asked.read_aircraft()
    models = tuple(name for name in chosen if name in NAMES)
    if models:
        from advisor.exports.models.write import refuse_models

        refuse_models(models, out, aircraft)
    from advisor.analysis.whole_flights import read_whole
    from advisor.exports.flights.reading import dataset

    with Stages() as tell:
        tell("reading and judging", 0.0)
        flights = read_whole(
            asked.logs, aircraft, asked.target_system, asked.marks, no_marks=asked.no_marks,
            axis="both",
        )  # fmt: skip
    for note in flights.notes:
        click.echo(printable(note), err=True)
    with staged(out, inputs) as stage:
        tables = tuple(name for name in chosen if name not in models)
        said = [part.sentence for part in (write_formats(dataset(flights), stage, tables) if tables else ())]
        if models:
            from advisor.exports.models.write import write_models

            said += write_models(models, stage, flights.state, aircraft)
    for sentence in said:
        click.echo(sentence, err=True)
    side = flights.state.lateral
    count = len(flights.state.maneuvers) + (len(side.maneuvers) if side is not None else 0)
    click.echo(f"Wrote {printable(str(out))}; manoeuvres: {count}; formats: {', '.join(chosen)}.")
    return 0
