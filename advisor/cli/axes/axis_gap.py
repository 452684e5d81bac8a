"""``advisor gap`` of any axis, alone or together with the other axis: diagnosis, proof, files and print."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Generic, TypeVar

import click

from advisor.analysis.axes.side_comparison import SideCompared
from advisor.cli.gap_asked import AxisAnswer, GapAsked, Unanswered, write_figure
from advisor.cli.improvement_export import listed, write_exports
from advisor.cli.options import USAGE
from advisor.cli.proving import document as proof_document
from advisor.cli.proving import print_proof, proof_of
from advisor.cli.running import Stages
from advisor.exports.models.flown import FlownModel
from advisor.exports.models.proof import Proof, stays_of
from advisor.exports.models.write import ExportOutcome
from advisor.gap.result import Diagnosis
from advisor.report.gap_document import axis_document, gap_document
from advisor.report.gap_screen import GapScreen
from advisor.report.gap_steps import GapStep
from advisor.report.table import PlainConsole
from advisor.simulators.compare import Compared
from advisor.words.ascii_output import printable
from advisor.words.plain import plain

C = TypeVar("C", bound=Compared | SideCompared)
Tell = Callable[[str, float], None]
"""Function that receives the name of a stage, and the fraction of the stage that is done."""


class AxisGap(ABC, Generic[C]):
    """``advisor gap`` of one axis. The type parameter is the result of comparing a flight with a
    simulator.
    """

    name: str
    """Name of the axis for people."""
    part: str
    """Name of the axis in the names of parts that fail."""

    def __init__(self, asked: GapAsked) -> None:
        self.asked = asked
        self.beside: Sequence[Proved[Any]] | None = None
        """Other axes with an answer; None if no other axis was asked for."""

    @abstractmethod
    def compare(self, tell: Tell) -> C:
        """Read the logs and compare the flight with the simulator."""

    @abstractmethod
    def prove(self, compared: C, named: Sequence[Path], tell: Tell) -> Proof:
        """Fly the improved simulator on the manoeuvres of the logs, or without logs on the last third of the
        flight.
        """

    @abstractmethod
    def improved(self, compared: C, diagnosis: Diagnosis) -> FlownModel:
        """Return the model for the improved aircraft file."""

    def exported(self, compared: C, diagnosis: Diagnosis) -> FlownModel:
        return self.improved(compared, diagnosis)

    def improves(self, diagnosis: Diagnosis) -> bool:
        return diagnosis.improves

    @abstractmethod
    def steps(
        self, diagnosis: Diagnosis, written: Path | None, outcomes: Sequence[ExportOutcome]
    ) -> list[GapStep]:
        """Return the next steps after the files are written."""

    def diagnosed(self) -> C | Unanswered:
        """Return the comparison, or the reason why there is none."""
        with Stages() as tell:
            return self.asked.attempted(f"{self.part}, diagnosis", partial(self.compare, tell))

    def proved(self, compared: C) -> "Proved[C]":
        """Return the part of a diagnosis that the proof confirms, if a proof was asked for."""
        proof = proof_of(self.asked.proving, partial(self.prove, compared))
        stays = stays_of(proof, compared.diagnosis, compared.aircraft.model)
        return Proved(self, compared, stays, proof)


@dataclass(frozen=True)
class Proved(Generic[C]):
    """A diagnosis, and the proof if the user asked for one."""

    axis: AxisGap[C]
    compared: C
    diagnosis: Diagnosis
    proof: Proof | None

    def exported(self) -> FlownModel:
        return self.axis.exported(self.compared, self.diagnosis)

    def answer(self, asked: GapAsked, everything: bool, writes: bool) -> AxisAnswer:
        """Write the files that were asked for, and return the answer.

        Parameters
        ----------
        everything
            Whether details are printed as well.
        writes
            Whether this axis writes the model files.
        """
        axis, diagnosis, proof = self.axis, self.diagnosis, self.proof
        written, outcomes = None, []
        if writes:
            written = asked.improved(
                axis.improves(diagnosis), lambda: axis.improved(self.compared, diagnosis)
            )
            outcomes = write_exports(asked.orders, self.exported)
        if diagnosis.traces:
            write_figure(asked.figure, lambda: axis_document(diagnosis))
        steps = axis.steps(diagnosis, written, outcomes)
        document = gap_document(diagnosis) | {"exports": listed(outcomes)}
        place = document.get("lateral") or document
        place |= {"improved_model": written and str(written), "next": plain(steps), **proof_document(proof)}

        def show() -> None:
            name = None if written is None else printable(str(written))
            PlainConsole().print(GapScreen(diagnosis, name, asked.why, steps, everything))
            print_proof(proof)

        return AxisAnswer(document, show, USAGE if any(outcome.problem for outcome in outcomes) else 0)


def answered(axes: Sequence[AxisGap[Any]], everything: bool) -> int:
    """Diagnose axes, print the results and write the files. An axis without an answer prints the reason.

    The first axis with an answer writes the files.
    """
    asked = axes[0].asked
    diagnosed = [(axis, axis.diagnosed()) for axis in axes]
    silent = [(axis, reason) for axis, reason in diagnosed if isinstance(reason, Unanswered)]
    if len(silent) == len(axes):
        return asked.refused(*(reason for _, reason in silent))
    for axis, reason in silent:
        click.echo(f"{axis.name}: {reason.said}", err=True)
    first, *beside = (
        axis.proved(compared) for axis, compared in diagnosed if not isinstance(compared, Unanswered)
    )
    first.axis.beside = beside if len(axes) > 1 else None
    figure = asked.figure
    named = replace(asked, figure=figure and figure.with_stem(f"{figure.stem}-lateral"))
    answers = [first.answer(asked, everything, True), *(x.answer(named, everything, False) for x in beside)]
    main, *others = answers
    document: dict[str, Any] = {**main.document}
    for answer in others:
        document["lateral"] = answer.document["lateral"] | {"improved_model": document["improved_model"]}
    documents = [*(answer.document for answer in answers), *(reason.document for _, reason in silent)]
    document["problems"] = [problem for part in documents for problem in part["problems"]]
    shown = [
        replace(answer, show=partial(_show, proved.axis.name, answer))
        for proved, answer in zip(beside, others, strict=True)
    ]
    return asked.answered(replace(main, document=document), *shown)


def _show(name: str, answer: AxisAnswer) -> None:
    click.echo(f"\n{name}")
    answer.show()
