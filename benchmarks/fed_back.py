"""Does a diagnosis with the improved file still find a cause?

    python -m benchmarks.fed_back [--each 10] [--seed 1] [--generator own ...]

Flights with one effect are diagnosed, and the improved file is written as ``advisor gap --out`` writes it.
Then each flight is diagnosed again with that file. For another flight of the same aircraft, a file that comes
from the first half of the manoeuvres is tried on the second half. The answer should be no gap or wrong
numbers: the file has the effect already.
"""

import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import click

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.gap import GapFlights, compare_flown, maneuvers_of
from advisor.analysis.refused import without_refused
from advisor.cli.options import read_aircraft
from advisor.exports.models.flown import FlownModel, write_file
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.result import Diagnosis
from advisor.simulators.compare import Compared
from advisor.words.problems import UnusableInputError
from benchmarks.gap_draws import DRAWS
from benchmarks.halves import halves_of
from sim.blind.natural import SHARE
from sim.sealed.cases import AIRCRAFT, LOG, SealedCase, write_case

CLOSED = ("none", "parameters")
"""Verdicts after which nothing is left to put into the file but numbers."""


@dataclass(frozen=True)
class FedBack:
    """The answers to one improved file."""

    first: Diagnosis
    again: Diagnosis | None
    """Diagnosis with the improved file; None where no file was written."""

    def __str__(self) -> str:
        return f"{_said(self.first)} -> {'no file' if self.again is None else _said(self.again)}"


def fed_back(flown: Sequence[Maneuver], fresh: Sequence[Maneuver], aircraft: Aircraft) -> FedBack:
    """Return the diagnosis of some manoeuvres, and that of fresh ones with the file that it improved.

    Both diagnoses are those of ``advisor gap``, and the file is that of its option ``--out``.
    """
    first = _compared(flown, aircraft)
    if not first.diagnosis.improves:
        return FedBack(first.diagnosis, None)
    with tempfile.TemporaryDirectory() as folder:
        improved = Path(folder) / "improved.yaml"
        write_file(FlownModel(first.aircraft, None, None, first.diagnosis), improved)
        better = read_aircraft(improved)
    return FedBack(first.diagnosis, _compared(fresh, better).diagnosis)


def _compared(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> Compared:
    return compare_flown(GapFlights(list(maneuvers), 0, ()), aircraft, None)


def _said(d: Diagnosis) -> str:
    present = [
        f"{c.effect}({', '.join(f'{v.value:.3g}' for v in c.parameters.values())})"
        for c in d.causes
        if c.present
    ]
    return " + ".join([d.where.block if d.verdict == "unknown" else d.verdict, *present])


def flights(generator: str, each: int, seed: int) -> Iterator[tuple[SealedCase, list[Maneuver], Aircraft]]:
    """Yield flights with one effect, their usable manoeuvres, and their aircraft."""
    ones = (case for case in DRAWS[generator](3 * each, seed, None, SHARE) if case.truth["kind"] == "one")
    for case, _ in zip(ones, range(each), strict=False):
        with tempfile.TemporaryDirectory() as folder:
            write_case(case, Path(folder))
            aircraft = read_aircraft(Path(folder) / AIRCRAFT)
            try:
                flown = maneuvers_of([Path(folder) / LOG], aircraft).maneuvers
                yield case, without_refused(flown, aircraft).maneuvers, aircraft
            except UnusableInputError:
                continue


@click.command
@click.option("--each", type=click.IntRange(1), default=10, show_default=True, help="Flights a generator.")
@click.option("--seed", type=int, default=1, show_default=True)
@click.option(
    "--generator", "generators", multiple=True, type=click.Choice(list(DRAWS)), default=("own", "third")
)
def main(each: int, seed: int, generators: Sequence[str]) -> None:
    """Feed the improved files of fresh flights back."""
    answers: dict[str, list[FedBack]] = {"same flight": [], "second half": []}
    for generator in generators:
        for case, maneuvers, aircraft in flights(generator, each, seed):
            click.echo(f"{generator} {case.name} truth {', '.join(case.truth['effects'])}")
            halves = halves_of(maneuvers)
            for name, (flown, fresh) in zip(answers, ((maneuvers, maneuvers), halves), strict=True):
                try:
                    found = fed_back(flown, fresh, aircraft)
                except UnusableInputError:
                    continue
                answers[name].append(found)
                click.echo(f"  {name}: {found}")
    for name, found in answers.items():
        files = [one.again for one in found if one.again is not None]
        closed = sum(again.verdict in CLOSED for again in files)
        click.echo(f"{name}: none or numbers after {closed} of {len(files)} improved files")


if __name__ == "__main__":
    main()
