"""Progress of a command on the terminal, as one line that each stage replaces."""

import sys
import time
from collections.abc import Callable

import click

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
