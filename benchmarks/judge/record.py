"""Flights of all three generators, diagnosed, with their evidence as rows.

A flight is drawn, diagnosed and written in turn, so that an interrupted run keeps what it has.
"""

import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from advisor.analysis.gap import compare_logs
from advisor.cli.options import read_aircraft
from advisor.gap.alternative import AlternativeEvidence
from advisor.gap.document import gap_document
from advisor.gap.evidence.rows import Row
from advisor.words.problems import UnusableInputError
from benchmarks.judge.flights import JudgedFlight, read, written
from benchmarks.second_generator.cases import cases as second
from benchmarks.third_generator.files import cases as third
from sim.blind.draw import GROUPS
from sim.blind.generate import draw
from sim.sealed.cases import AIRCRAFT, LOG, SealedCase, write_case

SEEDS = (64001, 64011, 64021, 64031)
"""Seeds of the flights. The corpus of ``benchmarks.corpus`` has others, so that it stays a test."""
_A_SEED = 60
DRAWS: Mapping[str, Callable[[int], Iterator[SealedCase]]] = {
    "own": lambda seed: draw(_A_SEED, seed, GROUPS),
    "second": lambda seed: second(_A_SEED, seed),
    "third": lambda seed: third(_A_SEED, seed),
}
"""Flights of each generator by seed. A real autopilot's flights and real records are never among them."""


def record(path: Path, each: int) -> None:
    """Append ``each`` flights of every generator to a file; flights that the file has are kept."""
    done = {flight.case for flight in read(path)} if path.exists() else set()
    path.parent.mkdir(parents=True, exist_ok=True)
    streams = [_named(generator, each) for generator in DRAWS]
    for together in zip(*streams, strict=True):
        for generator, name, case in together:
            if name not in done and (flight := flown(generator, name, case)) is not None:
                written([flight], path)
                print(name, case.truth["kind"], flight.answer["verdict"], file=sys.stderr)


def flown(generator: str, name: str, case: SealedCase) -> JudgedFlight | None:
    """Return the evidence of a case; None where its log cannot serve."""
    with tempfile.TemporaryDirectory() as folder:
        write_case(case, Path(folder) / "case")
        log, file = (Path(folder) / "case" / part for part in (LOG, AIRCRAFT))
        try:
            found = compare_logs([log], read_aircraft(file), None).diagnosis
        except UnusableInputError:
            return None
    document = gap_document(found)
    answer = {
        "verdict": document["verdict"],
        "causes": [{"effect": c["effect"]} for c in document["causes"]],
        "where": {"block": document["where"]["block"]},
    }
    keys = ("kind", "condition", "blocks", "background")
    truth = {key: case.truth[key] for key in keys} | {"effects": list(case.truth["effects"])}
    return JudgedFlight(generator, name, tuple(map(_row, found.evidence)), truth, answer)


def _named(generator: str, each: int) -> Iterator[tuple[str, str, SealedCase]]:
    drawn = ((seed, case) for seed in SEEDS for case in DRAWS[generator](seed))
    for _, (seed, case) in zip(range(each), drawn, strict=False):
        yield generator, f"{generator}/{seed}/{case.name}", case


def _row(one: AlternativeEvidence) -> Row:
    return Row(one.alternative, {column.name: column.value for column in one.columns if column.value})
