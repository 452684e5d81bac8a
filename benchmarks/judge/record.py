"""Flights of all three generators, diagnosed, with their evidence as rows.

A flight is drawn, diagnosed and written in turn, so that an interrupted run keeps what it has.
"""

import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from itertools import chain, zip_longest
from pathlib import Path
from typing import cast

from advisor.analysis.gap import maneuvers_of, with_true_reference
from advisor.analysis.refused import without_refused
from advisor.cli.options import read_aircraft
from advisor.flight.signals.true_airspeed import true_over_read
from advisor.gap.alternative import AlternativeEvidence
from advisor.gap.diagnose import diagnose
from advisor.gap.document import gap_document
from advisor.gap.evidence.rows import Row
from advisor.words.problems import UnusableInputError
from benchmarks.judge.flights import JudgedFlight, read, written
from benchmarks.second_generator.cases import cases as second
from benchmarks.third_generator.files import cases as third
from sim.blind.draw import GROUPS, Group
from sim.blind.generate import draw
from sim.sealed.cases import AIRCRAFT, LOG, SealedCase, write_case

SEED = 94011
"""Seed of the flights. The corpus of ``benchmarks.corpus`` has others, so that it stays a test."""
DRAWS: Mapping[str, Callable[[int, int, str | None], Iterator[SealedCase]]] = {
    "own": lambda count, seed, only: draw(count, seed, GROUPS if only is None else (cast(Group, only),)),
    "second": second,
    "third": third,
}
"""Flights of each generator by number, seed, and kind. A real autopilot's flights and real records are never
among them."""
STRATA = ((None, 1.0), ("outside", 0.4), ("none", 0.2))
"""Kinds that are drawn, None for all in the generator's mixture, with their numbers relative to the first.
Rare kinds teach the judge more; the field prior corrects for their number."""


def record(path: Path, each: int) -> None:
    """Append flights of every generator to a file in turns; flights that the file has are kept.

    ``each`` is the number of flights of a generator in its own mixture; more come from ``STRATA``.
    """
    done = {flight.case for flight in read(path)} if path.exists() else set()
    path.parent.mkdir(parents=True, exist_ok=True)
    streams = [_named(generator, n, each) for n in range(len(STRATA)) for generator in DRAWS]
    for generator, name, case in filter(None, chain.from_iterable(zip_longest(*streams))):
        if name not in done and (flight := flown(generator, name, case)) is not None:
            written([flight], path)
            print(name, case.truth["kind"], flight.answer["verdict"], file=sys.stderr)


def _named(generator: str, stratum: int, each: int) -> Iterator[tuple[str, str, SealedCase]]:
    """Yield the flights of one generator and stratum with their names."""
    (only, share), seed = STRATA[stratum], SEED + stratum
    for case in DRAWS[generator](max(round(share * each), 1), seed, only):
        yield generator, f"{generator}/{seed}/{case.name}", case


def flown(generator: str, name: str, case: SealedCase) -> JudgedFlight | None:
    """Return the evidence of a case; None where its log cannot serve."""
    with tempfile.TemporaryDirectory() as folder:
        write_case(case, Path(folder) / "case")
        log, aircraft = Path(folder) / "case" / LOG, read_aircraft(Path(folder) / "case" / AIRCRAFT)
        try:
            chosen = without_refused(maneuvers_of([log], aircraft).maneuvers, aircraft)
            gain = true_over_read(m.channels for m in chosen.maneuvers)
            found = diagnose(chosen.maneuvers, with_true_reference(aircraft, gain))
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


def _row(one: AlternativeEvidence) -> Row:
    return Row(one.alternative, {column.name: column.value for column in one.columns if column.value})
