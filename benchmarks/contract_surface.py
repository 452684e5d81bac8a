"""What the program promises: commands, options, and the key paths of its JSON documents, as JSON.

Run the script on two states of the program, by PYTHONPATH, and compare the two outputs: what is missing in
the second is a capability lost..
"""

import json
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import click

LOGS = Path(__file__).resolve().parents[1] / "logs"
_CALM = [str(LOGS / "arduplane-calm.tlog"), "--aircraft", str(LOGS / "arduplane-calm.yaml")]
DOCUMENTS = {
    "analyze": ["analyze", *_CALM],
    "analyze, wind": ["analyze", str(LOGS / "arduplane-turbulent.tlog")],
    "doctor": ["doctor", *_CALM],
    "doctor, slow": ["doctor", str(LOGS / "arduplane-default-rates.tlog")],
    "gap": ["gap", *_CALM],
    "study": ["study", "--campaigns", "10", "--workers", "1"],
    "aircraft check": ["aircraft", "check", _CALM[2]],
}
"""Name of a document to the command that prints it, without ``--json``."""


def _group() -> click.Group:
    for name in ("advisor.cli.group", "advisor.cli"):
        try:
            found = getattr(import_module(name), "advisor", None)
        except ModuleNotFoundError:
            continue
        if isinstance(found, click.Group):
            return found
    raise SystemExit("No group of commands is found: set PYTHONPATH to the program.")


def commands(group: click.Group, path: str = "advisor") -> Iterator[tuple[str, list[dict[str, Any]]]]:
    """Yield each command with its parameters."""
    context = click.Context(group)
    for name in group.list_commands(context):
        command = group.get_command(context, name)
        assert command is not None
        yield f"{path} {name}", sorted(map(_parameter, command.params), key=lambda one: str(one["name"]))
        if isinstance(command, click.Group):
            yield from commands(command, f"{path} {name}")


def _parameter(one: click.Parameter) -> dict[str, Any]:
    return {
        "name": [one.name, *one.opts],
        "type": re.sub(r" at 0x\w+", "", repr(one.type)),
        "default": repr(one.to_info_dict().get("default")),
        "help": getattr(one, "help", None),
    }


def key_paths(value: Any, path: str = "") -> Iterator[str]:
    """Yield the path of every key of a document; the places of a list share one path."""
    if isinstance(value, dict):
        for key, inside in value.items():
            yield f"{path}.{key}"
            yield from key_paths(inside, f"{path}.{key}")
    elif isinstance(value, list):
        for inside in value:
            yield from key_paths(inside, f"{path}[]")


def _document(arguments: list[str]) -> list[str]:
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run(
            [sys.executable, "-m", "advisor", *arguments, "--json"],
            cwd=folder, capture_output=True, text=True, check=False,
        )  # fmt: skip
    return sorted(set(key_paths(json.loads(run.stdout)))) if run.stdout.strip() else [run.stderr]


if __name__ == "__main__":
    surface = {
        "commands": dict(commands(_group())),
        "documents": {name: _document(arguments) for name, arguments in DOCUMENTS.items()},
    }
    json.dump(surface, sys.stdout, indent=1, ensure_ascii=False)
