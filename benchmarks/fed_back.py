"""Does a diagnosis with the improved file still find a cause?

    python -m benchmarks.fed_back [--each 6] [--seed 1] [--generator own ...] [--gate]

Flights with a cause are diagnosed on their axis, and the improved file is written as ``advisor gap --out``
writes it. Then each flight is diagnosed again with that file. The answer should be no gap or wrong numbers:
the file has the cause already. Flights are those of the generators, ArduPlane where its simulator lies next
to the checkout, and recorded flights of the gate. ``benchmarks.proof`` flies improved files on manoeuvres
that no fit has used.
"""

import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import click

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.axis_flown import compare_side_flown
from advisor.analysis.gap import compare_logs
from advisor.analysis.whole_flights import read_whole
from advisor.cli.options import read_aircraft
from advisor.exports.models.axes.handed_over import improved_side
from advisor.exports.models.flown import FlownModel, write_file
from advisor.gap.candidates.known import AIR
from advisor.gap.result import Diagnosis
from advisor.words.axes import AxisName
from advisor.words.problems import UnusableInputError
from benchmarks.gap_draws import DRAWS
from benchmarks.gate_flights import gate_flights
from benchmarks.metamorphic.flights import answer_of, unpacked
from sim.blind.natural import SHARE
from sim.sealed.cases import AIRCRAFT, LOG, SealedCase, write_case

CLOSED = ("none", "parameters")
"""Verdicts after which nothing is left to put into the file but numbers."""
WITH_CAUSE = ("one", "two", "parameters")
"""Kinds of flights whose cause a file can state."""


@dataclass(frozen=True)
class Flight:
    """A flight with a cause that is known."""

    name: str
    log: Path
    aircraft_file: Path
    axis: AxisName
    cause: str


@dataclass(frozen=True)
class FedBack:
    """The answers to a flight, and to its improved file."""

    first: Diagnosis
    again: Diagnosis | None
    """Diagnosis with the improved file; None where no file was written."""

    @property
    def is_closed(self) -> bool:
        """Whether the improved file leaves no cause."""
        return self.again is not None and self.again.verdict in CLOSED

    def __str__(self) -> str:
        return f"{_said(self.first)} -> {'no file' if self.again is None else _said(self.again)}"


def fed_back(log: Path, aircraft: Aircraft, axis: AxisName, improved: Path) -> FedBack:
    """Return the diagnosis of a flight, and that of the same flight with the file that it improved."""
    first, model = _diagnosed(log, aircraft, axis)
    if not first.improves:
        return FedBack(first, None)
    write_file(model, improved)
    return FedBack(first, _diagnosed(log, read_aircraft(improved), axis)[0])


def _diagnosed(log: Path, aircraft: Aircraft, axis: AxisName) -> tuple[Diagnosis, FlownModel]:
    """Return the answer of ``advisor gap``, and the model that its option ``--out`` writes."""
    if axis == "lateral":
        beside = compare_side_flown(read_whole([log], aircraft, axis="lateral").state, aircraft)
        return beside.diagnosis, replace(improved_side(beside), pitch=None)
    compared = compare_logs([log], aircraft)
    return compared.diagnosis, FlownModel(compared.aircraft, None, None, compared.diagnosis)


def _said(d: Diagnosis) -> str:
    present = [
        f"{c.name}({', '.join(f'{v.value:.3g}' for v in c.parameters.values())})"
        for c in d.causes
        if c.present
    ]
    told = answer_of(d)
    verdict = f"unknown in {d.where.block}" if d.verdict == "unknown" else d.verdict
    return f"{' + '.join([verdict, *present])} P {told.of(told.name):.2f}, gap {d.gap.before:.2f}"


def drawn(generator: str, each: int, seed: int) -> Iterator[tuple[str, SealedCase]]:
    """Yield flights of a generator with a cause that a file can state."""
    every = DRAWS[generator](4 * each, seed, None, SHARE)
    chosen = (case for case in every if _has_cause(case.truth))
    for case, _ in zip(chosen, range(each), strict=False):
        yield f"{generator} {case.name}", case


def _has_cause(truth: Mapping[str, Any]) -> bool:
    """Return whether a file can state the cause of a flight; no file states the air of another flight."""
    return truth["kind"] in WITH_CAUSE and (truth["kind"] == "parameters" or not set(truth["effects"]) <= AIR)


@contextmanager
def _written(name: str, case: SealedCase) -> Iterator[Flight]:
    truth = case.truth
    with tempfile.TemporaryDirectory() as folder:
        write_case(case, Path(folder))
        cause = ", ".join(truth["effects"]) or truth["kind"]
        yield Flight(name, Path(folder) / LOG, Path(folder) / AIRCRAFT, truth.get("axis", "pitch"), cause)


def _flights(generators: Sequence[str], each: int, seed: int, gate: bool) -> Iterator[Flight]:
    """Yield the flights; the log of each lasts until the next one is asked for."""
    for generator in generators:
        for name, case in drawn(generator, each, seed):
            with _written(name, case) as flight:
                yield flight
    for flown in gate_flights() if gate else ():
        if not {"none", "unknown"} & set(flown.right):
            with unpacked(flown.log) as log:
                yield Flight(flown.name, log, flown.aircraft_file, flown.axis, " or ".join(flown.right))


@click.command
@click.option("--each", type=click.IntRange(1), default=6, show_default=True, help="Flights a generator.")
@click.option("--seed", type=int, default=1, show_default=True)
@click.option(
    "--generator", "generators", multiple=True, type=click.Choice(list(DRAWS)), help="Default: all."
)
@click.option("--gate/--no-gate", default=False, help="Feed the files of the gate's flights back as well.")
def main(each: int, seed: int, generators: Sequence[str], gate: bool) -> None:
    """Feed the improved files of fresh flights back."""
    files = []
    for flight in _flights(generators or (() if gate else tuple(DRAWS)), each, seed, gate):
        with tempfile.TemporaryDirectory() as folder:
            try:
                told = fed_back(
                    flight.log,
                    read_aircraft(flight.aircraft_file),
                    flight.axis,
                    Path(folder) / "improved.yaml",
                )
            except UnusableInputError as error:
                click.echo(f"{flight.name} has no answer: {error}")
                continue
        mark = "no file" if told.again is None else ("closed" if told.is_closed else "OPEN")
        click.echo(f"{mark:8s}{flight.name} {flight.axis}, truth {flight.cause}: {told}")
        files += [told.is_closed] if told.again is not None else []
    click.echo(f"None or numbers after {sum(files)} of {len(files)} improved files (goal 95 %).")


if __name__ == "__main__":
    main()
