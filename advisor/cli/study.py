"""``advisor study``: the paper's simulated campaign, many times."""

import json
from collections.abc import Callable
from concurrent.futures import BrokenExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from advisor.cli.options import json_option, refuse_unwritable, writing
from advisor.cli.running import Progress, runner_of, running_options
from advisor.words.problems import ConfigurationError

if TYPE_CHECKING:
    from advisor.bundled.study.campaigns import NoiseReading
    from advisor.bundled.study.run import Study, StudyReport
    from advisor.process.tasks.processes import Runner


F = TypeVar("F", bound=Callable[..., Any])


def campaign_options(command: F) -> F:
    """Add the options ``--campaigns N`` and ``--seed N``."""
    campaigns = click.option(
        "--campaigns",
        type=click.IntRange(10, 20000),
        default=500,
        show_default=True,
        help="Number of simulated campaigns.",
    )
    seed = click.option(
        "--seed", type=click.IntRange(0), default=1, show_default=True, help="Seed of the noise."
    )
    return campaigns(seed(command))


@click.command
@campaign_options
@click.option(
    "--noise-reading",
    type=click.Choice(["std", "peak", "rms", "sample"]),
    default="std",
    show_default=True,
    help="Quantity to which the noise's percentage refers: the response's standard deviation, its peak, ...",
)
@click.option(
    "--figure", type=click.Path(path_type=Path), metavar="FILE", help="File for Figure 5, .png or .svg."
)
@running_options
@json_option
def command(
    campaigns: int,
    seed: int,
    noise_reading: "NoiseReading",
    figure: Path | None,
    workers: int | None,
    scheduler: str | None,
    as_json: bool,
) -> int:
    """Print Table 1 and Figure 5 of the paper, as medians and spread over many simulated campaigns.

    Equal seeds give equal studies for any --workers and --scheduler.

    \b
    Example:
      advisor study
      advisor study --campaigns 2000 --figure figure5.png
      advisor study --json > study.json
    """
    if figure is not None:
        from advisor.bundled.study.figure import refuse_undrawable

        refuse_unwritable("--figure", figure)
        refuse_undrawable(figure)
    run = runner_of(workers, scheduler, guarded=False)
    from advisor.bundled.study.run import table_1

    report = fly(table_1(campaigns, seed, noise_reading), run)
    if figure is not None:
        from advisor.bundled.study.figure import draw

        with writing("--figure", figure):
            draw(report.curves, figure)
    tell(report, as_json)
    return 0


def fly(study: "Study[Any, Any]", run: "Runner") -> "StudyReport":
    """Fly all campaigns, and print the progress.

    Raises
    ------
    ConfigurationError
        A process ended every time.
    """
    from advisor.process.tasks.processes import results_in_order

    progress = Progress(sum(task.campaigns for task in study.tasks), "campaigns")
    try:
        results = results_in_order(
            run, study.work, study.tasks, lambda place: progress.advance(study.tasks[place].campaigns)
        )
    except BrokenExecutor:
        raise ConfigurationError(
            "A process of the study ended early every time, possibly because memory was short. Repeat with "
            "fewer --workers."
        ) from None
    return study.report(results)


def tell(report: "StudyReport", as_json: bool) -> None:
    """Print a report, as lines or as one JSON document."""
    if as_json:
        click.echo(json.dumps(report.document, allow_nan=False))
    else:
        click.echo("\n".join(report.lines).rstrip())
