"""The logs of a command, and the options that say how to read the logs. All commands share this module."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from advisor.aircraft.aircraft import Aircraft, Rule
from advisor.cli.options import (
    aircraft_option,
    fix_option,
    maneuver_option,
    no_marks_option,
    read_aircraft,
    refuse_marks_on_several,
    rule_option,
    target_system_option,
    term_option,
)

if TYPE_CHECKING:
    from advisor.flight.maneuvers.marks import Mark

_OPTIONS = {
    "rule": rule_option, "marks": maneuver_option, "no_marks": no_marks_option, "fixes": fix_option,
    "terms": term_option,
}  # fmt: skip
"""Decorator that adds each option that only some commands have, by the option's name."""


@dataclass(frozen=True, slots=True)
class LogsAsked:
    """Logs of the command line, and how to read them."""

    logs: tuple[Path, ...] = ()
    aircraft_file: Path | None = None
    target_system: int | None = None
    rule: Rule | None = None
    """Rule that overrides the aircraft file's."""
    marks: "tuple[Mark, ...]" = ()
    no_marks: bool = False
    """Whether earlier decisions by hand are ignored."""
    fixes: tuple[str, ...] = ()
    """Parameters to hold, each ``NAME[=VALUE]``."""
    terms: tuple[str, ...] = ()
    """Terms to add, each ``EQUATION:EXPRESSION``."""

    @property
    def aircraft_text(self) -> str | None:
        """Aircraft file as given; None without one."""
        return str(self.aircraft_file) if self.aircraft_file else None

    @property
    def inputs(self) -> list[Path]:
        """Every file that the command reads."""
        return [*self.logs, *([self.aircraft_file] if self.aircraft_file else [])]

    @property
    def reading(self) -> list[str]:
        """Options other than the aircraft file that say how to read the logs, as words of a command line."""
        words = [] if self.target_system is None else ["--target-system", str(self.target_system)]
        words += ["--no-marks"] if self.no_marks else []
        for mark in self.marks:
            sign = "+" if mark.from_log_start else ""
            words += ["--maneuver", f"{sign}{mark.start_s:.10g}:{sign}{mark.end_s:.10g}"]
        words += [word for text in self.fixes for word in ("--fix", text)]
        words += [word for text in self.terms for word in ("--term", text)]
        return words

    def read_aircraft(self) -> Aircraft:
        """Read the aircraft file.

        Raises
        ------
        ConfigurationError
            As :func:`advisor.cli.options.read_aircraft`.
        """
        aircraft = read_aircraft(self.aircraft_file, self.rule)
        if self.fixes or self.terms:
            from advisor.aircraft_file.estimation import structure_of

            structure = structure_of(self.fixes, self.terms, aircraft.estimation, aircraft.model)
            aircraft = replace(aircraft, estimation=structure)
        if not self.logs:
            return aircraft
        from advisor.analysis.gap import as_in_tables

        return as_in_tables(aircraft, self.logs)


def log_options(
    *names: str, logs: bool = True, required: bool = True
) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Add LOG..., ``--aircraft`` and ``--target-system``, which the command receives as one `LogsAsked`.

    Parameters
    ----------
    names
        Further options: ``rule``, ``marks``, ``no_marks``, ``fixes``, ``terms``.
    logs, required
        Whether the command has the argument LOG..., and whether at least one log is needed.
    """

    def add(command: Callable[..., Any]) -> Callable[..., Any]:
        @wraps(command)
        def call(
            logs: tuple[Path, ...] = (),
            aircraft_file: Path | None = None,
            target_system: int | None = None,
            rule: Rule | None = None,
            marks: "tuple[Mark, ...]" = (),
            no_marks: bool = False,
            fixes: tuple[str, ...] = (),
            terms: tuple[str, ...] = (),
            **options: Any,
        ) -> Any:
            refuse_marks_on_several(marks, logs)
            asked = LogsAsked(tuple(logs), aircraft_file, target_system, rule, marks, no_marks, fixes, terms)
            return command(asked, **options)

        for name in reversed(names):
            call = _OPTIONS[name](call)
        call = aircraft_option(target_system_option(call))
        if not logs:
            return call
        return click.argument("logs", nargs=-1, required=required, type=click.Path(path_type=Path))(call)

    return add
