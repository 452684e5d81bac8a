"""The diagnosis of the gap in a separate process, so that the screens and the estimates continue.

    python -m advisor.session.diagnosis

The process reads a pickled `GapTask` and writes the pickled document of the diagnosis.
"""

import os
import pickle
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from advisor.aircraft.aircraft import Aircraft
from advisor.process import interrupt
from advisor.session.remote import start_child
from advisor.words.axes import AxisName
from advisor.words.problems import Problem

if TYPE_CHECKING:
    from advisor.campaign.state import ByHand
    from advisor.gap.result import Diagnosis

_GIVES_WAY = 10
"""Niceness of the diagnosis process. A diagnosis may wait for the estimates of a manoeuvre in flight."""

Document = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class GapTask:
    """Logs of a flight test and its aircraft, for one diagnosis of the gap."""

    logs: tuple[Path, ...]
    aircraft: Aircraft
    aircraft_file: Path | None = None
    """Path of the aircraft file, for the commands of the next steps; None without a file."""
    sideways: bool = False
    """Whether roll and yaw are diagnosed instead of pitch."""

    def done(self) -> Document:
        """Diagnose in this process, and return ``advisor.gap/1`` with the next steps."""
        from advisor.analysis.marks_file import read_by_hand

        if self.sideways:
            from advisor.analysis.axis_flown import compare_side_flown
            from advisor.analysis.whole_flights import read_whole

            def sideways() -> "Diagnosis":
                state = read_whole(self.logs, self.aircraft, axis="lateral").state
                return compare_side_flown(state, self.aircraft).diagnosis

            return document_of("lateral", sideways)
        by_hand = [read_by_hand(log) for log in self.logs]
        return diagnosed(self.logs, self.aircraft, by_hand, self.aircraft_file)


def diagnosed(
    logs: Sequence[Path],
    aircraft: Aircraft,
    by_hand: "Sequence[ByHand]",
    aircraft_file: Path | None = None,
    reading: Sequence[str] = (),
    target_system: int | None = None,
    tell: Callable[[str, float], None] = lambda *_: None,
) -> Document:
    """Diagnose logs against the aircraft file's simulator; return ``advisor.gap/1`` with the next steps."""
    from advisor.analysis.gap import compare_logs
    from advisor.report.gap_document import next_steps
    from advisor.words.plain import plain

    file = str(aircraft_file) if aircraft_file else None

    def following(diagnosis: "Diagnosis") -> Document:
        steps = next_steps(diagnosis, list(map(str, logs)), file, aircraft.simulator, reading)
        return {"next": plain(steps)}

    def diagnose() -> "Diagnosis":
        return compare_logs(logs, aircraft, None, target_system, tell, by_hand).diagnosis

    return document_of("pitch", diagnose, following)


def document_of(
    axis: AxisName,
    diagnose: "Callable[[], Diagnosis]",
    following: "Callable[[Diagnosis], Document]" = lambda _: {},
) -> Document:
    """Return ``advisor.gap/1`` of one axis, with the reason where there is no diagnosis."""
    from advisor.process.parts import FailedPart, attempt
    from advisor.report.gap_document import gap_document
    from advisor.words.problems import UnusableInputError

    try:
        made = attempt(f"{axis}, diagnosis", diagnose)
    except UnusableInputError as error:
        return gap_document(None, error.problems)
    if isinstance(made, FailedPart):
        return gap_document(None, failed=(made,))
    return {**gap_document(made), **following(made)}


def diagnose_elsewhere(task: GapTask) -> Document:
    """Diagnose the gap in another process. The call returns when the process has ended."""
    with start_child("advisor.session.diagnosis") as process:
        answer, _ = process.communicate(pickle.dumps(task))
    if process.returncode or not answer:
        from advisor.report.gap_document import gap_document

        said = f"The process of the diagnosis ended with exit code {process.returncode}."
        return gap_document(None, [Problem("diagnosis", said, "Run advisor gap in another terminal.")])
    document: Document = pickle.loads(answer)
    return document


def main() -> None:
    """Diagnose one task in this process. The output of a library must not enter the document."""
    os.nice(_GIVES_WAY)
    interrupt.ignore()
    with os.fdopen(os.dup(sys.stdout.fileno()), "wb") as out:
        os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
        task: GapTask = pickle.load(sys.stdin.buffer)
        pickle.dump(task.done(), out, pickle.HIGHEST_PROTOCOL)


if __name__ == "__main__":
    # Pickles name the module, and not the name under which it runs.
    from advisor.session.diagnosis import main as run

    run()
