"""``advisor gap`` of roll and yaw: the simulator against the manoeuvres of aileron and rudder."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from advisor.analysis.axes.side_comparison import (
    SideCompared,
    accepted_of,
    compare_side_flown,
)
from advisor.analysis.whole_flights import read_whole
from advisor.campaign.state import CampaignState
from advisor.cli.axes.axis_gap import AxisGap, Tell
from advisor.cli.gap_asked import GapAsked
from advisor.exports.models.axes.handed_over import improved_side
from advisor.exports.models.axes.prove_side import prove_side
from advisor.exports.models.flown import FlownModel
from advisor.exports.models.proof import Proof
from advisor.exports.models.write import ExportOutcome
from advisor.gap.result import Diagnosis
from advisor.report.gap_steps import GapStep, steps_to_decide


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
