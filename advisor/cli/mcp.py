"""``advisor mcp``: read-only tools for an assistant."""

from importlib.util import find_spec
from pathlib import Path

import click

from advisor.words.problems import ConfigurationError


@click.command
@click.argument(
    "folders", nargs=-1, required=True, type=click.Path(exists=True, file_okay=False, path_type=Path)
)
@click.option(
    "--most-mb",
    type=click.FloatRange(0.0, min_open=True),
    default=1000.0,
    show_default=True,
    help="Largest file that is read, MB.",
)
@click.option(
    "--limit-s",
    type=click.FloatRange(0.0, min_open=True),
    default=300.0,
    show_default=True,
    help="Longest time for one answer, s.",
)
def command(folders: tuple[Path, ...], most_mb: float, limit_s: float) -> None:
    """Serve doctor, analyze, gap and report to an assistant over the Model Context Protocol (stdio).

    The tools only read, and only files inside FOLDERS. The tools answer with the commands' JSON documents. An
    assistant starts this command itself; its configuration names the command and the folders.

    \b
    Example:
      advisor mcp ~/flights
      advisor mcp ~/flights ~/aircraft --limit-s 120
    """
    if find_spec("mcp") is None:
        raise ConfigurationError("advisor mcp needs mcp: pip install 'inflight-advisor[mcp]'.")
    from advisor.assistant.server import Calls, folders_of, server_of

    try:
        server_of(folders_of(folders, round(1e6 * most_mb)), Calls(limit_s)).run("stdio")
    except* (BrokenPipeError, ConnectionError):
        pass  # the client has gone, and its answer with it
