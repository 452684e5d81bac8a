"""``advisor study``: the paper's simulated campaign, many times."""

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from advisor.commands.options import json_option, refuse_unwritable
from advisor.problems import ConfigurationError

if TYPE_CHECKING:
    from advisor.study.flying import NoiseReading


@click.command
@click.option(
    "--campaigns",
    type=click.IntRange(10, 20000),
    default=500,
    show_default=True,
    help="Number of simulated campaigns.",
)
@click.option("--seed", type=click.IntRange(0), default=1, show_default=True, help="Seed of the noise.")
@click.option(
    "--noise-reading",
    type=click.Choice(["std", "peak", "rms", "sample"]),
    default="std",
    show_default=True,
    help="Reference of the noise's percentage: the response's standard deviation, its peak, ...",
)
@click.option(
    "--figure", type=click.Path(path_type=Path), metavar="FILE", help="File for Figure 5, .png or .svg."
)
@click.option("--readings", is_flag=True, help="Compare other readings of the paper's rules as well.")
@click.option(
    "--advice", is_flag=True, help="Instead: measure the manoeuvres that the advice saves, on two aircraft."
)
@click.option("--change", is_flag=True, help="Instead: measure how soon a change of the aircraft is noticed.")
@click.option(
    "--stops", is_flag=True, help="Instead: measure how often the rule information stops too early."
)
@json_option
def command(
    campaigns: int,
    seed: int,
    noise_reading: "NoiseReading",
    figure: Path | None,
    readings: bool,
    advice: bool,
    change: bool,
    stops: bool,
    as_json: bool,
) -> int:
    """Print Table 1 and Figure 5 of the paper, as medians and spread over many simulated campaigns.

    \b
    Example:
      advisor study
      advisor study --campaigns 2000 --figure figure5.png
      advisor study --json > study.json
    """
    from rich.console import Console
    from rich.progress import Progress

    from advisor.study import run
    from advisor.study.figure import refuse_undrawable

    if figure is not None:
        if advice or change or stops:
            raise ConfigurationError(
                "--figure draws the campaigns: leave out --advice, --change and --stops."
            )
        refuse_unwritable("--figure", figure)
        refuse_undrawable(figure)
    with Progress(console=Console(stderr=True), transient=True, disable=not sys.stderr.isatty()) as progress:
        task = progress.add_task("flying campaigns", total=None)

        def advance(done: int, total: int) -> None:
            progress.update(task, completed=done, total=total)

        if advice:
            report = run.advice(campaigns, seed, advance)
        elif change:
            report = run.change(campaigns, seed, advance)
        elif stops:
            report = run.early_stops(campaigns, seed, advance)
        else:
            report = run.table_1(campaigns, seed, noise_reading, figure, readings, advance)
    if as_json:
        click.echo(json.dumps(report.document, allow_nan=False))
    else:
        click.echo("\n".join(report.lines).rstrip())
    return 0
