"""``advisor batch --reports``: the page of each flight, to which the table of flights links."""

import shlex
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import click

from advisor.aircraft.aircraft import Aircraft
from advisor.cli.log_options import LogsAsked
from advisor.cli.running import Progress
from advisor.words.printable import printable

REPORTS = "reports"
"""Folder of the pages, by the key of the log."""


@dataclass(frozen=True, slots=True)
class ReportTask:
    """A log whose page is to be written."""

    log: Path
    aircraft: Aircraft
    aircraft_file: Path | None
    key: str
    """Key of the log's result, so that a page is written anew when the result changes."""

    @property
    def page(self) -> str:
        """Place of the page below the folder of the batch."""
        return f"{REPORTS}/{self.key}.html"


Run = Callable[[Sequence[ReportTask]], Iterator[tuple[ReportTask, str | Exception]]]


def page_of(task: ReportTask) -> str:
    """Return the page of one flight as HTML, as ``advisor report`` writes it."""
    from advisor.cli.page_content import gather
    from advisor.report.page.render import page

    aircraft = ["--aircraft", str(task.aircraft_file)] if task.aircraft_file else []
    command = shlex.join(["advisor", "report", str(task.log), *aircraft, "-o", "report.html"])
    content, _ = gather(LogsAsked((task.log,), task.aircraft_file), task.aircraft, False, command=command)
    return page(content, "html")


def write_reports(tasks: Sequence[ReportTask], out: Path, run: Run) -> Mapping[Path, str]:
    """Write the pages that are missing, and return each log's page, relative to ``out``.

    A page that fails is named on standard error, and the others are written.
    """
    from advisor.process.atomic_file import write_atomically

    (out / REPORTS).mkdir(parents=True, exist_ok=True)
    to_do = [task for task in tasks if not (out / task.page).exists()]
    progress = Progress(len(to_do), "reports")
    for task, written in run(to_do):
        if isinstance(written, Exception):
            click.echo(printable(f"{task.log} has no report: {written}"), err=True)
        else:
            write_atomically(out / task.page, written)
        progress.advance()
    return {task.log: task.page for task in tasks if (out / task.page).exists()}
