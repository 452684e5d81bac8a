"""``--workers`` and ``--scheduler``, which choose where tasks run, and the progress of the tasks."""

import os
import sys
import time
from collections.abc import Callable
from datetime import datetime, timedelta
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

import click

from advisor.words.problems import ConfigurationError

if TYPE_CHECKING:
    from advisor.process.tasks.runner import Runner

F = TypeVar("F", bound=Callable[..., Any])

_TELL_EVERY_S = 10.0
"""Time between two lines of progress without a terminal, s."""


def running_options(command: F) -> F:
    """Add the options ``--workers N`` and ``--scheduler ADDRESS``, which the command receives by name."""
    workers = click.option(
        "--workers", type=click.IntRange(1), help="Number of processes. Default: one for each core."
    )
    scheduler = click.option(
        "--scheduler", metavar="ADDRESS", help="Work on the Dask cluster at tcp://host:8786."
    )
    return workers(scheduler(command))


def runner_of(workers: int | None, scheduler: str | None, guarded: bool = True) -> "Runner":
    """Return the function that runs tasks as the options say.

    Parameters
    ----------
    guarded
        Whether a single worker also gets its own process, so that its death loses only one task.

    Raises
    ------
    ConfigurationError
        Both options are given, or the scheduler's address cannot be used.
    """
    if scheduler is not None:
        from advisor.process.tasks.cluster import check_address, run_on_cluster

        if workers is not None:
            raise ConfigurationError(
                "Give --workers for this computer, or --scheduler for a cluster, not both."
            )
        check_address(scheduler)
        return partial(run_on_cluster, address=scheduler, tell=partial(click.echo, err=True))
    from advisor.process.tasks.processes import run_in_processes
    from advisor.process.tasks.runner import run_here

    count = workers or os.cpu_count() or 1
    return run_here if count == 1 and not guarded else partial(run_in_processes, workers=count)


class Progress:
    """Progress of the work on standard error: tasks done, rate and expected end."""

    def __init__(self, total: int, things: str) -> None:
        self._total, self._things, self._done = total, things, 0
        self._began_s = self._told_s = time.monotonic()

    def advance(self, more: int = 1) -> None:
        """Count ``more`` tasks as done."""
        self._done += more
        now, last, watched = time.monotonic(), self._done >= self._total, sys.stderr.isatty()
        if not (watched or last or now - self._told_s > _TELL_EVERY_S):
            return
        self._told_s = now
        took_s = now - self._began_s
        rate = 60.0 * self._done / took_s
        line = f"{self._done} of {self._total} {self._things}, {rate:.{0 if rate > 10.0 else 1}f} a minute"
        if not last:
            ends = datetime.now() + timedelta(seconds=took_s / self._done * (self._total - self._done))
            line += f", ends about {ends:%H:%M}"
        click.echo(f"\r\033[K{line}" if watched else line, nl=last or not watched, err=True)
