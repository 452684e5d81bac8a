"""Options that several commands share, with one text and one behaviour in all commands."""

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import wraps
from itertools import combinations
from math import isfinite, nan
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from advisor.aircraft.aircraft import Aircraft, Rule
from advisor.words.problems import ConfigurationError

if TYPE_CHECKING:
    from advisor.campaign.state import ByHand
    from advisor.flight.maneuvers.marks import Mark


UNMET, USAGE, UNUSABLE, INTERNAL = 1, 2, 3, 70
"""Exit codes for an expectation that does not hold, wrong usage or configuration, unusable input, and a fault
of the advisor.
"""
NEWEST = "the newest"
"""Value of ``--resume`` without a recording."""
RULES = ("continuous", "separate", "information")


aircraft_option = click.option(
    "--aircraft",
    "aircraft_file",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Aircraft file (YAML): elevator calibration, servo lag, limits, prior model.",
)
"""Adds the option ``--aircraft FILE``, which the command receives as ``aircraft_file``."""
json_option = click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON document on stdout, and nothing else there."
)
"""Adds the option ``--json``, which the command receives as ``as_json``."""
rule_option = click.option(
    "--rule", type=click.Choice(RULES), help="Rule that decides; the others are shown."
)
"""Adds the option ``--rule``, which overrides the aircraft file's rule."""
target_system_option = click.option(
    "--target-system",
    type=click.IntRange(1, 255),
    metavar="N",
    help="System id of the vehicle, needed if several vehicles are on the link.",
)
"""Adds the option ``--target-system N``, named as in MAVProxy."""
maneuver_option = click.option(
    "--maneuver",
    "marks",
    multiple=True,
    metavar="START:END",
    callback=lambda ctx, parameter, texts: parse_marks(texts),
    help="Mark this stretch as a manoeuvre, in seconds since power-on, or with + since the log's first "
    "ATTITUDE (+12:+24). Minutes and seconds are valid too (1:20.4:1:33). Repeatable.",
)
"""Adds the option ``--maneuver START:END``, which the command receives as ``marks``."""
no_marks_option = click.option(
    "--no-marks", is_flag=True, help="Ignore earlier decisions by hand (LOG.maneuvers.yaml)."
)
"""Adds the option ``--no-marks``, which the command receives as ``no_marks``."""

fix_option = click.option(
    "--fix",
    "fixes",
    multiple=True,
    metavar="NAME[=VALUE]",
    help="Hold a parameter, such as M_q=-2.0, instead of estimating it. Without a value, the aircraft "
    "file's model gives the value. Repeatable.",
)
"""Adds the option ``--fix NAME[=VALUE]``, which the command receives as ``fixes``."""
term_option = click.option(
    "--term",
    "terms",
    multiple=True,
    metavar="EQUATION:EXPRESSION",
    help="Estimate one more term, such as M:q*abs(q), Z:alpha**2 or L:beta**3, and print its gain in log "
    "likelihood. "
    "Angle of attack, pitch angle, controls and thrust are measured from their means. Repeatable.",
)
"""Adds the option ``--term EQUATION:EXPRESSION``, which the command receives as ``terms``."""


def parse_marks(texts: Sequence[str]) -> "tuple[Mark, ...]":
    """Read several stretches ``START:END`` that do not overlap.

    Raises
    ------
    ConfigurationError
        A stretch is wrong, as in :func:`parse_mark`, or two stretches overlap.
    """
    marks = tuple(map(parse_mark, texts))
    for a, b in combinations(marks, 2):
        if a.from_log_start == b.from_log_start and a.overlaps(b.start_s, b.end_s):
            raise ConfigurationError(f"{b.name} overlaps {a.name}: make one mark of both, or separate them.")
    return marks


def parse_mark(text: str) -> "Mark":
    """Read ``START:END``.

    Raises
    ------
    ConfigurationError
        The text is not a stretch of time, or the stretch is too long for a manoeuvre.
    """
    from advisor.flight.maneuvers.marks import LONGEST_S, Mark

    parts = text.split(":")
    half = len(parts) // 2 if len(parts) in (2, 4) else len(parts)
    relative = [part.strip().startswith("+") for part in (parts[0], parts[-half])]
    start_s, end_s = _seconds(parts[:half]), _seconds(parts[half:])
    if not (isfinite(start_s) and isfinite(end_s) and start_s >= 0.0 and relative[0] == relative[1]):
        raise ConfigurationError(
            f"--maneuver {text}: give START:END in seconds since power-on, or both with + from the start "
            "of the log, e.g. --maneuver +12:+24; minutes:seconds are valid too, e.g. --maneuver "
            "1:20.4:1:33."
        )
    if end_s <= start_s:
        raise ConfigurationError(f"--maneuver {text}: END must be later than START; correct the two times.")
    if end_s - start_s > LONGEST_S:
        raise ConfigurationError(
            f"--maneuver {text}: a manoeuvre lasts {LONGEST_S:.0f} s at most; mark each input separately."
        )
    return Mark(start_s, end_s, from_log_start=relative[0], name=f"--maneuver {text}")


def _seconds(parts: Sequence[str]) -> float:
    """Read seconds, ``["80.4"]``, or minutes and seconds, ``["1", "20.4"]``; return NaN for any
    other text.
    """
    try:
        *minutes, seconds = map(float, parts)
    except ValueError:
        return nan
    if len(minutes) > 1 or (minutes and not 0.0 <= seconds < 60.0):
        return nan
    return 60.0 * sum(minutes) + seconds


def refuse_marks_on_several(marks: "Sequence[Mark]", logs: Sequence[Path]) -> None:
    """Refuse marks of the command line on several logs.

    Raises
    ------
    ConfigurationError
        There are marks, and more than one log.
    """
    if marks and len(logs) > 1:
        raise ConfigurationError(
            "--maneuver does not say in which of several logs: write the marks into LOG.maneuvers.yaml "
            "next to each log."
        )


def decided_on(log: Path, no_marks: bool) -> "ByHand":
    """Return the decisions by hand on a log, from the file next to the log.

    Raises
    ------
    ConfigurationError
        As :func:`advisor.analysis.marks_file.read_by_hand`.
    """
    from advisor.analysis.marks_file import read_by_hand
    from advisor.campaign.state import NOTHING

    return NOTHING if no_marks else read_by_hand(log)


def read_aircraft(aircraft_file: Path | None, rule: Rule | None = None) -> Aircraft:
    """Read the aircraft file, and let the rule of the command line override the file's.

    Raises
    ------
    ConfigurationError
        As :func:`advisor.aircraft_file.read.load_aircraft`.
    """
    aircraft = Aircraft()
    if aircraft_file is not None:
        from advisor.aircraft_file.read import load_aircraft

        aircraft = load_aircraft(aircraft_file)
    if rule is None:
        return aircraft
    return replace(aircraft, campaign=replace(aircraft.campaign, rule=rule))


def refuse_unwritable(option: str, path: Path) -> None:
    """Refuse, before any work, a path that could not be written after the work.

    Raises
    ------
    ConfigurationError
        The path is a folder, its folder does not exist, or the user may not write there.
    """
    if path.is_dir():
        raise ConfigurationError(f"{option}: {path} is a folder; name a file in it.")
    if not path.parent.is_dir():
        raise ConfigurationError(
            f"{option}: there is no folder {path.parent}; make the folder, or name a file elsewhere."
        )
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise ConfigurationError(f"{option}: {path} cannot be written to; name a file elsewhere.")


def refuse_unwritable_folder(option: str, folder: Path) -> None:
    """Refuse, before any work, a path that is no folder, or a folder that could not be made or written to.

    Raises
    ------
    ConfigurationError
        The path is a file, lies below a file, or may not be written.
    """
    if folder.exists() and not folder.is_dir():
        raise ConfigurationError(f"{option}: {folder} is a file; name a folder.")
    there = next((path for path in (folder, *folder.absolute().parents) if path.exists()), Path("/"))
    if not there.is_dir():
        raise ConfigurationError(f"{option}: {folder} lies below the file {there}; name a folder elsewhere.")
    if not os.access(there, os.W_OK | os.X_OK):
        raise ConfigurationError(f"{option}: {folder} cannot be written to; name a folder elsewhere.")


@contextmanager
def writing(option: str, path: Path) -> Iterator[None]:
    """Turn a failed write, such as one on a full disk, into one sentence that names the option and the file.

    Raises
    ------
    ConfigurationError
        The block ended with an OSError.
    """
    try:
        yield
    except OSError as error:
        raise ConfigurationError(
            f"{option}: {path} cannot be written to: {error.strerror or error}."
            " Make room or name another place."
        ) from None


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
