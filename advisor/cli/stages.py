"""Progress of a command on the terminal: one line that the next stage replaces."""

import sys
from types import TracebackType

import click


class Stages:
    """Stages of a command's work on standard error, seen on a terminal only.

    The line is erased when the context is left, so that the results stand alone.
    """

    def __init__(self) -> None:
        self._watched = sys.stderr.isatty()

    def __enter__(self) -> "Stages":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._write("")

    def __call__(self, what: str, share: float) -> None:
        """Show what is done now, and the share of the work that is done, 0 to 1."""
        self._write(f"{100.0 * share:3.0f} %  {what}")

    def _write(self, text: str) -> None:
        if self._watched:
            click.echo(f"\r\033[K{text}", nl=False, err=True)
