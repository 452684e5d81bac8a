"""``reference/commands.md``: every command's own ``--help``."""

import importlib
from collections.abc import Iterator

import click

_HEAD = """# Commands

This page is what each command prints for `--help`.

LOG is a `.tlog`, a `.bin` of ArduPilot or a `.ulg` of PX4, packed or not ([logs](logs.md)). CONN is an
address of a link ([links](links.md)).

| exit code | meaning |
|---|---|
| 0 | done |
| 2 | the call or a file of yours is wrong |
| 3 | the input cannot serve; one sentence says why and how to mend it |
| 70 | a fault of the advisor or of the system, such as a full disk |
| 129, 143 | ended by SIGHUP or SIGTERM while a link is heard or a screen is shown |
| 130 | stopped by Ctrl-C |
"""
_PROGRAMS = {"advisor": ("advisor.cli.group", "advisor"), "python -m sim": ("sim.__main__", "main")}
"""Name on the command line to the module of the program, and the name of its command there."""
_WIDTH = 90


def page() -> str:
    """The page as Markdown."""
    parts = [_HEAD]
    for program, (module, name) in _PROGRAMS.items():
        command = getattr(importlib.import_module(module), name)
        parts += [_section(*told) for told in _helps(program, command, None)]
    return "\n".join(parts)


def _helps(name: str, command: click.Command, parent: click.Context | None) -> Iterator[tuple[str, str, int]]:
    """Yield name, help and depth of a command and of those below."""
    depth = 0
    above = parent
    while above is not None:
        depth, above = depth + 1, above.parent
    with click.Context(
        command, info_name=name, parent=parent, terminal_width=_WIDTH, max_content_width=_WIDTH
    ) as context:
        yield context.command_path, command.get_help(context), depth
        if isinstance(command, click.Group):
            for below in command.list_commands(context):
                found = command.get_command(context, below)
                if found is not None and not found.hidden:
                    yield from _helps(below, found, context)


def _section(path: str, text: str, depth: int) -> str:
    return f"{'#' * (min(depth, 1) + 2)} {path}\n\n```text\n{text}\n```\n"
