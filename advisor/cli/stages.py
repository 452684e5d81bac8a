"""Progress of a command on the terminal: one line that the next stage replaces."""

import sys
import time
from collections.abc import Callable

import click

_TELLS = 0.1
"""Least share of the work that is done before the time of its end is shown."""


class Stages:
    """Stages of a command's work on standard error, seen on a terminal only.

    The line is erased when the context is left, so that the results stand alone.
    """

    def __init__(self, clock: Callable[[], float] = time.time) -> None:
        self._watched = sys.stderr.isatty()
        self._clock, self._began, self._done = clock, clock(), 0.0

    def __enter__(self) -> "Stages":
        return self

    def __exit__(self, *error: object) -> None:
        self._write("")

    def __call__(self, what: str, share: float) -> None:
        """Show what is done now, the share of the work that is done, 0 to 1, and when the work ends.

        A share below the last one begins another piece of work.
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
