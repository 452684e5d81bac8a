"""Where the tasks of a command run (``--workers``, ``--scheduler``), and its progress on the terminal."""

import os
import sys
import time
from collections.abc import Callable
from datetime import datetime, timedelta
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

import click

from advisor.words.problems import ConfigurationError

_TELLS = 0.1
"""Fraction of the work after which the expected end is shown."""


class Stages:
    """Stages of a command's work, printed on standard error only on a terminal.

    Leaving the context erases the line, so that only results remain.
    """

    def __init__(self, clock: Callable[[], float] = time.time) -> None:
        self._watched = sys.stderr.isatty()
        self._clock, self._began, self._done = clock, clock(), 0.0

    def __enter__(self) -> "Stages":
        return self

    def __exit__(self, *error: object) -> None:
        self._write("")

    def __call__(self, what: str, share: float) -> None:
        """Show the present stage, the fraction of the work that is done, and when the work ends.

        A fraction below the last one begins another piece of work.
        """
        now = self._clock()
        if share < self._done:
            self._began = now
        self._done, ends = share, ""
        if share >= _TELLS:
            end = time.localtime(self._began + (now - self._began) / share)
            ends = f", ends at about {time.strftime('%H:%M:%S', end)}"
        self._write(f"{100.0 * share:3.0f} %  {what}{ends}")

    def _write(self, text: str) -> None:
        if self._watched:
            click.echo(f"\r\033[K{text}", nl=False, err=True)


if TYPE_CHECKING:
    from advisor.process.tasks.processes import Runner

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
    from advisor.process.tasks.processes import run_here, run_in_processes

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
