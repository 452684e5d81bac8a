"""``advisor gap`` of pitch: the simulator against the manoeuvres of the elevator."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path

from advisor.analysis import gap as reading
from advisor.analysis.gap_flights import GapFlights, maneuvers_of
from advisor.campaign.hand_decisions import ByHand
from advisor.cli.axes.axis_gap import AxisGap, Tell
from advisor.cli.gap_asked import GapAsked
from advisor.cli.options import decided_on
from advisor.cli.running import Stages
from advisor.exports.models.axes.handed_over import side_of_logs
from advisor.exports.models.axes.prove_pitch import prove
from advisor.exports.models.flown import FlownModel, SideModel, improved_model
from advisor.exports.models.proof import Proof
from advisor.exports.models.write import ExportOutcome
from advisor.gap.result import IMPROVING, Diagnosis
from advisor.report.gap_steps import GapStep, next_steps
from advisor.simulators.compare import Compared


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
