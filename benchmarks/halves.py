"""Do two halves of one flight get the same first cause?

    python -m benchmarks.halves /path/to/flights [--simulator SPEC]

Every log of the folder with an aircraft file next to it is diagnosed twice, from the first half of its
usable manoeuvres and from the second. The halves agree on the same answer, or where one of them is not sure.
The exit code is 1 where they do not agree.
"""

import sys
from dataclasses import dataclass, replace
from pathlib import Path

import click

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft_file.read import load_aircraft
from advisor.analysis.gap import compare_flown, opened_simulator
from advisor.analysis.gap_flights import GapFlights, maneuvers_of, without_refused
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.result import Diagnosis
from advisor.words.problems import ConfigurationError, UnusableInputError

SURE = 0.6
"""Least probability of an answer that counts as sure: the acceptance of the work on the gap states it."""
FEWEST = 4
"""Fewest manoeuvres for two halves: with one alone no cause is sought."""


@dataclass(frozen=True)
class Answer:
    """First answer of a diagnosis."""

    name: str
    """First cause, or the verdict where there is none."""
    probability: float | None
    """Probability of the answer; None where a diagnosis states none."""

    def __str__(self) -> str:
        return self.name if self.probability is None else f"{self.name} P {self.probability:.2f}"

    @property
    def is_sure(self) -> bool:
        """Whether the diagnosis states the answer without doubt."""
        return self.probability is None or self.probability >= SURE


def answer_of(diagnosis: Diagnosis) -> Answer:
    """Return the first cause of a diagnosis, or else its verdict, with its probability."""
    answer = diagnosis.answer
    if answer is None:
        return Answer(diagnosis.verdict, None)
    same = [one.probability for one in diagnosis.evidence if one.alternative.name == answer.name]
    return Answer(answer.name, sum(same))


def agree(one: Answer, other: Answer) -> bool:
    """Return whether two answers are the same, or one of them is not sure."""
    return one.name == other.name or not (one.is_sure and other.is_sure)


def halves_of(maneuvers: list[Maneuver]) -> tuple[list[Maneuver], list[Maneuver]]:
    """Return the first and the second half of the manoeuvres in order of flying."""
    middle = len(maneuvers) // 2
    return maneuvers[:middle], maneuvers[middle:]


def answers(log: Path, aircraft: Aircraft) -> list[Answer]:
    """Return the answers of both halves of a log; none where its manoeuvres are too few."""
    usable = without_refused(maneuvers_of([log], aircraft).maneuvers, aircraft).maneuvers
    if len(usable) < FEWEST:
        return []
    with opened_simulator(aircraft) as simulator:
        flown = (GapFlights(half, 0, ()) for half in halves_of(list(usable)))
        return [answer_of(compare_flown(half, aircraft, simulator).diagnosis) for half in flown]


@click.command
@click.argument("folder", type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.option("--simulator", help="Specification of a simulator, for every log.")
def main(folder: Path, simulator: str | None) -> None:
    """Diagnose both halves of every log in FOLDER."""
    apart = 0
    for file in sorted(folder.glob("*.yaml")):
        log = file.with_suffix(".tlog")
        try:
            found = answers(log, replace(load_aircraft(file), simulator=simulator)) if log.exists() else []
        except (UnusableInputError, ConfigurationError):
            found = []
        if not found:
            continue
        same = agree(*found)
        apart += not same
        click.echo(f"{file.stem:24s} {found[0]!s:32s} {found[1]!s:32s} {'agree' if same else 'DISAGREE'}")
    sys.exit(int(apart > 0))


if __name__ == "__main__":
    main()
