"""``advisor export``: a flight's data for other tools."""

from collections.abc import Sequence
from pathlib import Path

import click

from advisor.cli.log_options import LogsAsked, log_options
from advisor.cli.options import refuse_unwritable, refuse_unwritable_folder
from advisor.cli.stages import Stages
from advisor.exports.flights.formats import WRITERS, parse_formats, write_formats
from advisor.exports.flights.staging import refuse_inputs, staged
from advisor.exports.models.names import NAMES
from advisor.words.printable import printable
from advisor.words.problems import ConfigurationError


@click.command
@log_options("rule", "marks", "no_marks")
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
    help=f"Formats, separated by commas: {', '.join(WRITERS)}; of the model as flown: {', '.join(NAMES)}. "
    "Default: csv.",
)
@click.option(
    "--cut", type=click.IntRange(1), metavar="N", help="Write only the packets of manoeuvre N, as a tlog."
)
def command(asked: LogsAsked, out: Path, formats: str | None, cut: int | None) -> int:
    """Write channels, manoeuvres, estimates and residuals for other tools, with names and units.

    The numbers are those of `advisor analyze`. The documentation's page on exports lists the files, units and
    the time grid.

    \b
    Example:
      advisor export flight.tlog -o flight --format csv,parquet,mat,mcap
      advisor export flight.tlog -o flight --format ardupilot,matlab --aircraft my-aircraft.yaml
      advisor export flight.tlog -o maneuver-3.tlog --cut 3
    """
    inputs = asked.inputs
    if cut is not None:
        _refuse_wrong_cut(formats, out, inputs)
    else:
        refuse_unwritable_folder("-o", out)
    chosen = () if cut is not None else parse_formats(formats or "csv")
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
            axis="pitch" if cut is not None else "both",
        )  # fmt: skip
    for note in flights.notes:
        click.echo(printable(note), err=True)
    if cut is not None:
        from advisor.exports.flights.cut import log_of_maneuver

        data = log_of_maneuver(flights, cut, aircraft, asked.target_system)
        with staged(out.parent, inputs) as stage:
            (stage / out.name).write_bytes(data)
        click.echo(f"Wrote {printable(str(out))}: manoeuvre {cut}, {len(data)} bytes.")
        return 0
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


def _refuse_wrong_cut(formats: str | None, out: Path, inputs: Sequence[Path]) -> None:
    if formats is not None:
        raise ConfigurationError("--cut writes a tlog: leave out --format, or leave out --cut.")
    refuse_unwritable("-o", out)
    refuse_inputs([out], inputs)
