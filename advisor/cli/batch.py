"""``advisor batch``: many flights, each analyzed once, and the page of each, to which their table links."""

import shlex
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import click

from advisor.aircraft.aircraft import Aircraft
from advisor.cli.options import (
    UNUSABLE,
    LogsAsked,
    aircraft_option,
    read_aircraft,
    refuse_unwritable_folder,
    writing,
)
from advisor.cli.report import refuse_missing_libraries
from advisor.cli.running import Progress, runner_of, running_options
from advisor.words.problems import ConfigurationError, Problem, UnusableInputError, printable

if TYPE_CHECKING:
    from advisor.batch.flight import Analyzed, BatchTask

    Run = Callable[[Sequence[BatchTask]], Iterator[tuple[BatchTask, Analyzed | Exception]]]
    WriteRun = Callable[[Sequence[BatchTask]], Iterator[tuple[BatchTask, str | Exception]]]

INDEX = "index.html"
"""Name of the page of all flights."""
KEPT = "flights"
"""Name of the folder for the results, in which each log's file is named by the log's key."""

REPORTS = "reports"
"""Name of the folder for the pages. The key of a log's result names its page, so that a new result gets a new
page.
"""


@click.command
@click.argument(
    "places", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="LOGS-OR-FOLDERS..."
)
@click.option(
    "-o",
    "--out",
    required=True,
    type=click.Path(path_type=Path),
    metavar="DIR",
    help="Folder of the results.",
)
@aircraft_option
@click.option(
    "--aircraft-map",
    "map_file",
    type=click.Path(path_type=Path),
    metavar="MAP.yaml",
    help="File for several aircraft, with one line for each pattern of logs and its aircraft file.",
)
@click.option("--reports", "with_reports", is_flag=True, help="Write the page of each flight as well.")
@running_options
def command(
    places: tuple[Path, ...],
    out: Path,
    aircraft_file: Path | None,
    map_file: Path | None,
    with_reports: bool,
    workers: int | None,
    scheduler: str | None,
) -> int:
    """Analyze every log once. Write a table of flights, a table of manoeuvres, and the changes over the
    flights.

    Each log's result is kept in DIR/flights. The next run with equal logs, configuration and advisor analyzes
    only new logs.

    \b
    Example:
      advisor batch flights/ -o results --aircraft my-aircraft.yaml --workers 8
      advisor batch flights/ -o results --aircraft-map fleet.yaml --reports
      advisor batch /shared/flights -o results --scheduler tcp://10.0.0.5:8786
    """
    if aircraft_file is not None and map_file is not None:
        raise ConfigurationError("Give --aircraft for one aircraft, or --aircraft-map for several, not both.")
    refuse_unwritable_folder("-o", out)
    if with_reports:
        refuse_missing_libraries("advisor batch --reports")
    from advisor.batch.flight import analyze, analyze_shared, find_logs

    runner = runner_of(workers, scheduler)
    run = partial(runner, analyze if scheduler is None else analyze_shared)
    logs = find_logs(places if scheduler is None else [place.absolute() for place in places], out)
    tasks, results = _tasks(logs, aircraft_file, map_file)
    with writing("-o", out):
        (out / KEPT).mkdir(parents=True, exist_ok=True)
        results |= _analyzed(tasks, out, run)
        usable = [task for task in tasks if results[task.log].usable]
        pages = write_reports(usable, out, partial(runner, page_of)) if with_reports else {}
    return _told([results[log] for log in logs if log in results], out, pages)


def _tasks(
    logs: Sequence[Path], aircraft_file: Path | None, map_file: Path | None
) -> "tuple[list[BatchTask], dict[Path, Analyzed]]":
    """Return the logs to analyze without repetitions, and the results of logs that cannot be analyzed."""
    from advisor.batch.flight import BatchTask, failed, read_map, sha256_of

    chosen = read_map(map_file) if map_file is not None else None
    described: dict[Path | None, Aircraft] = {}
    tasks: dict[str, BatchTask] = {}
    results: dict[Path, Analyzed] = {}
    for log in logs:
        file = chosen.file_of(log) if chosen is not None else aircraft_file
        if file not in described:
            described[file] = read_aircraft(file)
        task = BatchTask(log, described[file], file.name if file else "", "", file)
        if chosen is not None and file is None:
            fix = "Add a line for the log, or a last line for all other logs ('*')."
            problem = Problem("no_aircraft", f"{log} matches no pattern in {map_file}.", fix)
            results[log] = failed(task, [problem])
            continue
        try:
            task = replace(task, sha256=sha256_of(log))
        except UnusableInputError as error:
            results[log] = failed(task, error.problems)
            continue
        first = tasks.setdefault(task.key, task)
        if first is not task:
            click.echo(printable(f"{log} is a copy of {first.log}: it counts once."), err=True)
    return list(tasks.values()), results


def _analyzed(tasks: "Sequence[BatchTask]", out: Path, run: "Run") -> "dict[Path, Analyzed]":
    """Return the result of every task. A result of an earlier run is read, and a new result is kept."""
    from advisor.batch.flight import failed, keep, kept
    from advisor.batch.tables import is_whole

    places = {task.log: out / KEPT / f"{task.key}.json" for task in tasks}
    results = {task.log: old for task in tasks if (old := kept(places[task.log])) and is_whole(old)}
    to_do = [task for task in tasks if task.log not in results]
    if results:
        click.echo(f"{len(results)} of {len(tasks)} logs were analyzed before.", err=True)
    progress = Progress(len(to_do), "logs")
    for task, result in run(to_do):
        if isinstance(result, Exception):
            results[task.log] = failed(task, [_fault(task, result)])
        else:
            results[task.log] = result
            keep(result, places[task.log])
        progress.advance()
    return results


def _fault(task: "BatchTask", error: Exception) -> Problem:
    """Return the problem of a log whose analysis ended with an error."""
    from concurrent.futures import BrokenExecutor

    if isinstance(error, ConfigurationError):
        return Problem("configuration", str(error), "")
    if isinstance(error, BrokenExecutor):
        return Problem(
            "worker_died",
            f"The process that analyzed {task.log} ended early every time, possibly because memory was "
            f"short.",
            "Repeat with fewer --workers, or analyze the log alone.",
        )
    return Problem(
        "fault",
        f"A fault of the advisor in {task.log}: {type(error).__name__}: {error}.",
        "Please report it.",
    )


def _told(results: "Sequence[Analyzed]", out: Path, pages: Mapping[Path, str]) -> int:
    """Write the tables, and print failures and changes."""
    from advisor.batch.index import index_page
    from advisor.batch.tables import changes_of, in_order, mixed_up, not_told_apart, tables_of
    from advisor.exports.flights.formats import staged, write_formats

    flights = in_order(results)
    form = "parquet" if find_spec("pyarrow") else "csv"
    with staged(out) as stage:
        write_formats(tables_of(flights), stage, [form])
        (stage / INDEX).write_text(index_page(flights, pages), encoding="utf-8")
    failures = [flight for flight in flights if not flight.usable]
    for flight in failures:
        click.echo(printable(f"{flight.log}: {' '.join(flight.reasons)}"), err=True)
    for sentence in mixed_up(flights):
        click.echo(printable(sentence), err=True)
    for sentence in not_told_apart(flights).values():
        click.echo(printable(sentence))
    for name, change in changes_of(flights).items():
        click.echo(printable(f"{name}: {change.sentence}"))
    maneuvers = sum(len(flight.maneuvers) for flight in flights)
    click.echo(
        f"{printable(str(out))}: flights: {len(flights)}; manoeuvres: {maneuvers}; logs that cannot be used:"
        f" {len(failures)}; tables: flights.{form}, maneuvers.{form}, changes.{form}; page: {INDEX}."
    )
    return UNUSABLE if len(failures) == len(flights) else 0


def page_of(task: "BatchTask") -> str:
    """Return the page of one flight as HTML, as ``advisor report`` writes it."""
    from advisor.cli.page_content import gather
    from advisor.report.page.render import page

    aircraft = ["--aircraft", str(task.aircraft_path)] if task.aircraft_path else []
    command = shlex.join(["advisor", "report", str(task.log), *aircraft, "-o", "report.html"])
    content, _ = gather(LogsAsked((task.log,), task.aircraft_path), task.aircraft, False, command=command)
    return page(content, "html")


def write_reports(tasks: "Sequence[BatchTask]", out: Path, run: "WriteRun") -> Mapping[Path, str]:
    """Write the pages that are missing, and return each log's page, relative to ``out``.

    A page that fails is named on standard error, and the others are written.
    """
    from advisor.process.atomic_file import write_atomically

    (out / REPORTS).mkdir(parents=True, exist_ok=True)
    pages = {task.log: f"{REPORTS}/{task.key}.html" for task in tasks}
    to_do = [task for task in tasks if not (out / pages[task.log]).exists()]
    progress = Progress(len(to_do), "reports")
    for task, written in run(to_do):
        if isinstance(written, Exception):
            click.echo(printable(f"{task.log} has no report: {written}"), err=True)
        else:
            write_atomically(out / pages[task.log], written)
        progress.advance()
    return {log: page for log, page in pages.items() if (out / page).exists()}
