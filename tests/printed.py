"""Command lines that the program prints, taken as a shell and the program take them."""

import shlex
from collections.abc import Mapping
from importlib import import_module
from io import StringIO
from typing import Any

import click
from rich.console import Console


def taken(line: str) -> Mapping[str, Any]:
    """Return the parameters that ``advisor`` reads from a command line; nothing is run.

    Raises
    ------
    click.UsageError
        The program does not take the line.
    """
    program, name, *words = shlex.split(line.replace("\\\n", ""))
    assert program == "advisor"
    command = import_module(f"advisor.cli.{name}").command
    if isinstance(command, click.Group):
        command, words = command.commands[words[0]], words[1:]
    parameters: Mapping[str, Any] = command.make_context(name, words, resilient_parsing=False).params
    return parameters


def printed_lines(shown: Any, columns: int = 160) -> list[str]:
    """Return the lines that a terminal of a width shows."""
    out = StringIO()
    Console(file=out, width=columns, color_system=None, highlight=False).print(shown)
    return out.getvalue().splitlines()
