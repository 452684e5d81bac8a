"""Options that commands share, so that they read and behave the same everywhere."""

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

import click

from advisor.aircraft import Aircraft, Rule
from advisor.problems import ConfigurationError

F = TypeVar("F", bound=Callable[..., Any])

USAGE, UNUSABLE, INTERNAL = 2, 3, 70
"""Exit codes: wrong usage or configuration, input that cannot serve, a fault of the advisor itself."""
RULES = ("continuous", "separate", "information")


def aircraft_option(command: F) -> F:
    """``--aircraft FILE``, given to the command as ``aircraft_file``."""
    return click.option(
        "--aircraft",
        "aircraft_file",
        type=click.Path(path_type=Path),
        metavar="FILE",
        help="Aircraft file (YAML): elevator calibration, servo lag, limits, prior model.",
    )(command)


def json_option(command: F) -> F:
    """``--json``, given to the command as ``as_json``."""
    return click.option(
        "--json", "as_json", is_flag=True, help="One JSON document on stdout, and nothing else there."
    )(command)


def rule_option(command: F) -> F:
    """``--rule``, overriding the aircraft file's."""
    return click.option("--rule", type=click.Choice(RULES), help="Rule that decides (all are shown).")(
        command
    )


def target_system_option(command: F) -> F:
    """``--target-system N``, MAVProxy's name."""
    return click.option(
        "--target-system",
        type=click.IntRange(1, 255),
        metavar="N",
        help="System id of the vehicle when several are heard.",
    )(command)


def read_aircraft(aircraft_file: Path | None, rule: Rule | None = None) -> Aircraft:
    """Read the aircraft file and put the command line's rule over its own.

    Raises
    ------
    ConfigurationError
        As :func:`advisor.config.load_aircraft`.
    """
    aircraft = Aircraft()
    if aircraft_file is not None:
        from advisor.config import load_aircraft

        aircraft = load_aircraft(aircraft_file)
    if rule is None:
        return aircraft
    return replace(aircraft, campaign=replace(aircraft.campaign, rule=rule))


def refuse_unwritable(option: str, path: Path) -> None:
    """Refuse before the work what could not be written after it.

    Raises
    ------
    ConfigurationError
        The path is a folder, or lies in none, or may not be written.
    """
    if path.is_dir():
        raise ConfigurationError(f"{option}: {path} is a folder; name a file in it.")
    if not path.parent.is_dir():
        raise ConfigurationError(
            f"{option}: there is no folder {path.parent}; make it, or name a file elsewhere."
        )
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise ConfigurationError(f"{option}: {path} cannot be written to; name a file elsewhere.")
