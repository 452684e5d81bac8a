"""Options of ``advisor gap`` for one axis, and the parts of an answer that all axes share."""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import click

from advisor.aircraft.aircraft import Aircraft
from advisor.cli.log_options import LogsAsked
from advisor.cli.options import UNUSABLE, writing
from advisor.exports.models.flown import FlownModel, write_file
from advisor.exports.models.write import ExportOrder
from advisor.gap.inference.prior import FieldPrior
from advisor.process.parts import FailedPart, attempt
from advisor.report.gap_document import gap_document
from advisor.words.printable import printable
from advisor.words.problems import UnusableInputError

Found = TypeVar("Found")


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

    def compared(self, part: str, compare: Callable[[], Found]) -> Found | int:
        """Return a comparison. Without one, print the answer that remains and return its exit code."""
        try:
            found = attempt(part, compare)
        except UnusableInputError as error:
            told, document, code = str(error), gap_document(None, error.problems), UNUSABLE
        else:
            if not isinstance(found, FailedPart):
                return found
            told, document, code = found.sentence, gap_document(None, failed=(found,)), 0
        if self.as_json:
            click.echo(json.dumps(document, indent=1))
        click.echo(told, err=True)
        return code

    def improved(self, improves: bool, make: Callable[[], FlownModel]) -> Path | None:
        """Write the improved aircraft file that was asked for, or say why not; return the written file."""
        if self.out is None:
            return None
        if not improves:
            click.echo(f"{printable(str(self.out))} was not written: there is nothing to improve.", err=True)
            return None
        with writing("--out", self.out):
            write_file(make(), self.out)
        return self.out
