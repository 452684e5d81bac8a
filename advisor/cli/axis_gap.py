"""``advisor gap`` of any axis, alone or together with the other axis: diagnosis, proof, files and print."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Any, Generic, TypeVar

import click

from advisor.analysis import gap as reading
from advisor.analysis.axis_flown import SideCompared, accepted_of, compare_side_flown
from advisor.analysis.gap_flights import GapFlights, maneuvers_of
from advisor.analysis.whole_flights import read_whole
from advisor.campaign.state import ByHand, CampaignState
from advisor.cli.gap_asked import AxisAnswer, GapAsked, Unanswered, write_figure
from advisor.cli.improvement_export import listed, write_exports
from advisor.cli.options import USAGE, decided_on
from advisor.cli.proving import document as proof_document
from advisor.cli.proving import print_proof, proof_of
from advisor.cli.running import Stages
from advisor.exports.models.axes.handed_over import improved_side, side_of_logs
from advisor.exports.models.axes.prove_pitch import prove
from advisor.exports.models.axes.prove_side import prove_side
from advisor.exports.models.flown import FlownModel, SideModel, improved_model
from advisor.exports.models.proof import Proof, stays_of
from advisor.exports.models.write import ExportOutcome
from advisor.gap.result import IMPROVING, Diagnosis
from advisor.report.gap_document import GapStep, axis_document, gap_document, next_steps, steps_to_decide
from advisor.report.gap_screen import GapScreen
from advisor.report.text import PlainConsole
from advisor.simulators.compare import Compared
from advisor.words.plain import plain
from advisor.words.problems import printable

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


class SideGap(AxisGap[SideCompared]):
    """``advisor gap`` of roll and yaw.

    Parameters
    ----------
    state
        State of the campaign with both axes; None before the logs are read.
    """

    name, part = "Roll and yaw", "lateral"

    def __init__(self, asked: GapAsked, state: CampaignState | None = None) -> None:
        super().__init__(asked)
        self._state = state

    def compare(self, tell: Tell) -> SideCompared:
        """Read the logs and compare the flight with the simulator."""
        asked, read = self.asked, self.asked.read
        state = self._state
        if state is None:
            tell("reading", 0.0)
            target, marks = read.target_system, read.marks
            whole = read_whole(
                read.logs, asked.aircraft, target, marks, no_marks=read.no_marks, axis="lateral"
            )
            state = whole.state
        return compare_side_flown(state, asked.aircraft, asked.prior, tell)

    def prove(self, compared: SideCompared, named: Sequence[Path], tell: Tell) -> Proof:
        """Fly the improved simulator of roll and yaw on the manoeuvres of the logs, or without logs on the
        last third.
        """
        tell("flying for the proof", 0.0)
        fresh = None
        if named:
            target, no_marks = self.asked.read.target_system, self.asked.read.no_marks
            read = read_whole(named, compared.aircraft, target, no_marks=no_marks, axis="lateral")
            fresh = accepted_of(read.state)
        return prove_side(compared, fresh, self.asked.prior, tell)

    def improved(self, compared: SideCompared, diagnosis: Diagnosis) -> FlownModel:
        return replace(self.exported(compared, diagnosis), pitch=None)

    def exported(self, compared: SideCompared, diagnosis: Diagnosis) -> FlownModel:
        return improved_side(replace(compared, diagnosis=diagnosis))

    def steps(
        self, diagnosis: Diagnosis, written: Path | None, outcomes: Sequence[ExportOutcome]
    ) -> list[GapStep]:
        """Return the flight that distinguishes the two likeliest answers."""
        return steps_to_decide(diagnosis)


class PitchGap(AxisGap[Compared]):
    """``advisor gap`` of pitch.

    Parameters
    ----------
    holdout
        Number of manoeuvres to hold out; with None the diagnosis chooses the number.
    flown
        Manoeuvres of the elevator; None before the logs are read.
    """

    name, part = "Pitch", "pitch"

    def __init__(
        self,
        asked: GapAsked,
        by_hand: Sequence[ByHand],
        holdout: int | None,
        flown: GapFlights | None = None,
    ) -> None:
        super().__init__(asked)
        self._by_hand, self._holdout, self._flown = by_hand, holdout, flown

    def compare(self, tell: Tell) -> Compared:
        """Read the logs and compare the flight with the simulator."""
        asked, read = self.asked, self.asked.read
        return reading.compare_logs(
            read.logs, asked.aircraft, self._holdout, read.target_system, tell,
            self._by_hand, asked.prior, self._flown,
        )  # fmt: skip

    def prove(self, compared: Compared, named: Sequence[Path], tell: Tell) -> Proof:
        """Fly the improved simulator on the manoeuvres of the logs, or without logs on the last third of the
        flight.
        """
        asked, read = self.asked, self.asked.read
        aircraft = asked.aircraft
        tell("reading for the proof", 0.0)
        flown = maneuvers_of(read.logs, aircraft, read.target_system, self._by_hand)
        decided = [decided_on(log, read.no_marks) for log in named]
        fresh = maneuvers_of(named, aircraft, read.target_system, decided) if named else None
        return prove(flown, fresh, aircraft, read.target_system, tell, asked.prior, compared)

    def improved(self, compared: Compared, diagnosis: Diagnosis) -> FlownModel:
        return FlownModel(compared.aircraft, None, self._side, diagnosis)

    def exported(self, compared: Compared, diagnosis: Diagnosis) -> FlownModel:
        """Return the model for other programs, without the simulator's own servo, which is no part of the
        improvement.
        """
        given = self.asked.aircraft
        as_given = replace(compared.aircraft, simulator=given.simulator, elevator=given.elevator)
        model = improved_model(diagnosis, as_given, self._side)
        return replace(model, unchanged=not self.improves(diagnosis))

    def improves(self, diagnosis: Diagnosis) -> bool:
        return diagnosis.improves or any(other.diagnosis.verdict in IMPROVING for other in self.beside or ())

    def steps(
        self, diagnosis: Diagnosis, written: Path | None, outcomes: Sequence[ExportOutcome]
    ) -> list[GapStep]:
        """Return the next steps after the files are written."""
        read, simulator = self.asked.read, self.asked.aircraft.simulator
        logs, flown = list(map(str, read.logs)), _flown_next(simulator, written, outcomes)
        return next_steps(diagnosis, logs, read.aircraft_text, simulator, read.reading, flown)

    @cached_property
    def _side(self) -> SideModel | None:
        """Roll and yaw for the files, from their diagnosis or from the estimate of the logs; None without
        both.
        """
        if self.beside is not None:
            return next((other.exported().side for other in self.beside), None)
        read = self.asked.read
        with Stages() as tell:
            tell("reading roll and yaw for the files", 0.0)
            return side_of_logs(
                read.logs, self.asked.aircraft, read.target_system, read.marks, no_marks=read.no_marks
            )


def _flown_next(
    simulator: str | None, improved: Path | None, outcomes: Sequence[ExportOutcome]
) -> str | None:
    """Return the written file of the improved simulator that the simulator of the diagnosis can fly."""
    kind, _, _ = (simulator or "linear").partition(":")
    files = [other.order.file for other in outcomes if other.order.format == kind and not other.problem]
    file = next(iter(files), None) if kind != "linear" else improved
    return None if file is None else str(file)
