"""Flights of every generator, and those of the gate's autopilot, diagnosed once for their evidence."""

import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from advisor.aircraft_file.read import load_aircraft
from advisor.analysis.axes.side_comparison import compare_side_flown
from advisor.analysis.gap import compare_logs
from advisor.analysis.whole_flights import read_whole
from advisor.words.problems import UnusableInputError
from benchmarks.gap_draws import drawn
from benchmarks.gate_flights import GateFlight, gate_flights
from benchmarks.metamorphic.flights import unpacked
from sim.sealed.cases import AIRCRAFT, LOG, SealedCase, write_case

from .evidence import KeptFlight, evidence_rows

AUTOPILOT = "autopilot"
_KINDS = {"none": "none", "parameters": "parameters", "unknown": "outside"}

Asked = tuple[str, Callable[[], KeptFlight | None]]
"""Name of a flight, and the work that diagnoses it; None for a flight without a posterior."""


def asked(each: int, seed: int, generators: Sequence[str]) -> Iterator[Asked]:
    """Yield the flights of generators, and of the gate's autopilot where its cases are at hand."""
    if AUTOPILOT in generators:
        yield from _of_the_gate()
    for name, case in drawn(each, seed, [name for name in generators if name != AUTOPILOT]):
        yield name, lambda name=name, case=case: _of_a_case(name, case)  # type: ignore[misc]


def _of_a_case(name: str, case: SealedCase) -> KeptFlight | None:
    truth = case.truth
    right = {"none": ("none", *truth["background"]), "parameters": ("parameters",), "outside": ("unknown",)}
    names = right.get(truth["kind"], tuple(truth["effects"]))
    with tempfile.TemporaryDirectory() as folder:
        write_case(case, Path(folder) / "case")
        log, file = Path(folder) / "case" / LOG, Path(folder) / "case" / AIRCRAFT
        return _kept(name, truth["kind"], names, log, file, truth.get("axis", "pitch"))


def _of_the_gate() -> Iterator[Asked]:
    """Yield the gate's diagnoses of an autopilot whose logs are at hand."""
    for flown in gate_flights():
        if AUTOPILOT not in flown.name:
            continue

        def work(flown: GateFlight = flown) -> KeptFlight | None:
            kind = _KINDS.get(flown.right[0], "one")
            with unpacked(flown.log) as plain:
                name = f"{AUTOPILOT}/{flown.name}"
                return _kept(name, kind, flown.right, plain, flown.aircraft_file, flown.axis)

        yield f"{AUTOPILOT}/{flown.name}", work


def _kept(
    name: str, kind: str, right: Sequence[str], log: Path, aircraft_file: Path, axis: str
) -> KeptFlight | None:
    """Diagnose a log by the code of the command, and keep its evidence."""
    aircraft = load_aircraft(aircraft_file)

    def diagnose() -> object:
        if axis == "lateral":
            return compare_side_flown(read_whole([log], aircraft, axis="lateral").state, aircraft)
        return compare_logs([log], replace(aircraft, simulator=None))

    try:
        rows = evidence_rows(diagnose)
    except UnusableInputError:
        return None
    return KeptFlight(name.split("/")[0], name, kind, tuple(right), rows) if rows else None
