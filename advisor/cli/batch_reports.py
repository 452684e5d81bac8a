"""``advisor batch --reports``: the page of each flight, to which the table of flights links."""

import shlex
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from advisor.cli.log_options import LogsAsked
from advisor.cli.running import Progress
from advisor.words.printable import printable

if TYPE_CHECKING:
    from advisor.batch.flight import BatchTask

    Run = Callable[[Sequence[BatchTask]], Iterator[tuple[BatchTask, str | Exception]]]

REPORTS = "reports"
"""Name of the folder for the pages. The key of a log's result names its page, so that a new result gets a new
page.
"""


def page_of(task: "BatchTask") -> str:
    """Return the page of one flight as HTML, as ``advisor report`` writes it."""
    from advisor.cli.page_content import gather
    from advisor.report.page.render import page

    aircraft = ["--aircraft", str(task.aircraft_path)] if task.aircraft_path else []
    command = shlex.join(["advisor", "report", str(task.log), *aircraft, "-o", "report.html"])
    content, _ = gather(LogsAsked((task.log,), task.aircraft_path), task.aircraft, False, command=command)
    return page(content, "html")


def write_reports(tasks: "Sequence[BatchTask]", out: Path, run: "Run") -> Mapping[Path, str]:
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
