"""Options of ``advisor gap``, and the parts of an answer that all axes share."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeVar

import click

from advisor.aircraft.aircraft import Aircraft
from advisor.cli.options import UNUSABLE, LogsAsked, refuse_unwritable, writing
from advisor.exports.models.flown import FlownModel, write_file
from advisor.exports.models.write import ExportOrder
from advisor.gap.inference.prior import FieldPrior
from advisor.process.parts import FailedPart, attempt
from advisor.report.gap_document import gap_document
from advisor.words.problems import ConfigurationError, UnusableInputError, printable

Found = TypeVar("Found")


@dataclass(frozen=True)
class Unanswered:
    """An axis without a diagnosis."""

    said: str
    """Reason, with the next step."""
    document: Mapping[str, Any]
    code: int
    """Exit code of the command if no other axis answers."""


@dataclass(frozen=True)
class AxisAnswer:
    """The answer of one axis: its document, its printing, and its exit code."""

    document: dict[str, Any]
    show: Callable[[], None]
    """Print the answer for people."""
    code: int = 0


@dataclass(frozen=True)
class GapAsked:
    """The options of ``advisor gap`` that every axis has."""

    read: LogsAsked
    """Logs, aircraft file and marks."""
    aircraft: Aircraft
    prior: FieldPrior
    out: Path | None
    """File for the improved simulator."""
    figure: Path | None
    orders: list[ExportOrder]
    proving: Sequence[str]
    why: bool
    as_json: bool

    def attempted(self, part: str, compare: Callable[[], Found]) -> Found | Unanswered:
        """Return a comparison, or the reason why there is none."""
        try:
            comparison = attempt(part, compare)
        except UnusableInputError as error:
            return Unanswered(str(error), gap_document(None, error.problems), UNUSABLE)
        if isinstance(comparison, FailedPart):
            return Unanswered(comparison.sentence, gap_document(None, failed=(comparison,)), 0)
        return comparison

    def refused(self, *reasons: Unanswered) -> int:
        """Print why axes have no answer, and return the exit code of the first reason."""
        if self.as_json:
            problems = [problem for reason in reasons for problem in reason.document["problems"]]
            click.echo(json.dumps({**reasons[0].document, "problems": problems}, indent=1))
        for reason in reasons:
            click.echo(reason.said, err=True)
        return reasons[0].code

    def answered(self, *answers: AxisAnswer) -> int:
        """Print the answer of every axis, and return the largest exit code. The JSON document is that of the
        first axis.
        """
        if self.as_json:
            click.echo(json.dumps(answers[0].document, allow_nan=False, indent=1))
        else:
            for answer in answers:
                answer.show()
        return max(answer.code for answer in answers)

    def improved(self, improves: bool, make: Callable[[], FlownModel]) -> Path | None:
        """Write the improved aircraft file if the user asked for one, or print why not. Return the path of
        the file, or None if no file was written.
        """
        if self.out is None:
            return None
        if not improves:
            click.echo(
                f"{printable(str(self.out))} was not written: there is nothing to improve.",
                err=True,
            )
            return None
        with writing("--out", self.out):
            write_file(model := make(), self.out)
        if model.beyond_keys:
            click.echo(
                f"{printable(str(self.out))} has no key for: {', '.join(model.beyond_keys)}.", err=True
            )
        return self.out


_FORMATS = (".svg", ".png")


def refuse_figure(figure: Path | None, others: Sequence[Path | None]) -> None:
    """Refuse, before any work, a picture that could not be drawn or written.

    Raises
    ------
    ConfigurationError
        The ending names no picture, matplotlib is missing, or the file is also an input or output of the
        command.
    """
    if figure is None:
        return
    if figure.suffix.lower() not in _FORMATS:
        raise ConfigurationError(f"--figure: {figure} ends in neither .svg nor .png; name such a file.")
    if find_spec("matplotlib") is None:
        raise ConfigurationError("--figure needs matplotlib: pip install 'inflight-advisor[report]'.")
    refuse_unwritable("--figure", figure)
    if any(other is not None and other.resolve() == figure.resolve() for other in others):
        raise ConfigurationError(f"--figure: {figure} is another file of this command; name a new one.")


def write_figure(figure: Path | None, document: Callable[[], Mapping[str, Any]]) -> None:
    """Write the picture of an axis's document, if one is wanted.

    Raises
    ------
    ConfigurationError
        The file cannot be written.
    """
    if figure is None:
        return
    from advisor.report.page.gap import write_gap_picture

    with writing("--figure", figure):
        write_gap_picture(document(), figure)
