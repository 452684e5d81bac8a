"""Pitch as a table of the engine against today's diagnosis, paired on the same flights.

    python -m benchmarks.pitch_table --each 4 --seed 7331     # fresh flights of every generator
    python -m benchmarks.pitch_table --gate                    # the gate's flights next to the checkout
    python -m benchmarks.pitch_table --seed 7331 --table       # the table of the answers kept so far

Each flight is read once, and both engines get the same manoeuvres and the same aircraft file. Today's engine
was developed on the gate's flights, so the fresh flights decide. Answers are kept in ``build/pitch-table``, a
line a flight: a run goes on where it stopped.
"""

import json
import lzma
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import click

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.gap_flights import maneuvers_of
from advisor.cli.options import read_aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.as_flown import as_flown
from advisor.gap.axis.comparison import compare_axis
from advisor.gap.diagnose import examine
from advisor.gap.effects import EFFECTS
from advisor.gap.result import Diagnosis, spelled
from advisor.model.axes.pitch import PITCH
from advisor.oem.estimate import NoEstimate
from advisor.words.problems import UnusableInputError
from benchmarks.gap_draws import DRAWS, drawn
from benchmarks.gap_score import SURE, is_alarm, is_right, log_score, stated
from benchmarks.gate_flights import gate_flights
from sim.sealed.cases import AIRCRAFT, LOG, write_case

FOLDER = Path("build") / "pitch-table"
ENGINES = ("today", "table")
_NAMES = {spelled(name).replace(" ", "_"): name for name in EFFECTS}
"""Name of each effect in the catalogue, by its name in sentences."""


def by_table(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> Diagnosis | NoEstimate:
    """Return the diagnosis of pitch by the engine that roll and yaw have."""
    flown = as_flown(maneuvers, aircraft)
    return compare_axis(PITCH, flown.usable, flown.aircraft, kinematics=flown.kinematics)


def by_today(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> Diagnosis | NoEstimate:
    """Return the diagnosis of pitch by its own engine."""
    return examine(maneuvers, aircraft).diagnosis


def answered(name: str, log: Path, aircraft_file: Path, truth: Mapping[str, Any]) -> dict[str, Any]:
    """Return the answers of both engines to one flight, with its key."""
    aircraft = read_aircraft(aircraft_file)
    maneuvers = maneuvers_of([log], aircraft).maneuvers
    answers = {}
    for engine, work in zip(ENGINES, (by_today, by_table), strict=True):
        began = time.process_time()
        try:
            diagnosis = work(maneuvers, aircraft)
        except UnusableInputError as error:
            diagnosis = NoEstimate(error.code, str(error))
        answers[engine] = {**_said(diagnosis), "seconds": time.process_time() - began}
    return {"case": name, "truth": json.loads(json.dumps(truth, default=float)), "answers": answers}


def _said(diagnosis: Diagnosis | NoEstimate) -> dict[str, Any]:
    """Return probabilities, first answer and sizes, as ``gap_score`` reads them."""
    if isinstance(diagnosis, NoEstimate):
        return {"probabilities": None, "first": {"name": "none", "sizes": {}}, "gap": None}
    told: dict[str, Any] = {"none": 0.0, "parameters": 0.0, "unknown": {}, "effects": {}}
    for row in diagnosis.evidence:
        a, p = row.alternative, float(row.probability)
        if a.kind == "unknown":
            told["unknown"][a.block] = told["unknown"].get(a.block, 0.0) + p
        elif a.is_effect:
            effect = _NAMES.get(a.name, a.name)
            told["effects"][effect] = told["effects"].get(effect, 0.0) + p
        else:
            told[a.kind] += p
    first: dict[str, Any] = {"name": diagnosis.verdict, "sizes": {}}
    if diagnosis.verdict == "effect" and diagnosis.causes:
        cause = diagnosis.causes[0]
        sizes = {name: {"value": v.value, "std": v.std} for name, v in cause.parameters.items()}
        first = {"name": cause.effect, "sizes": sizes}
    elif diagnosis.verdict == "untested":
        first["name"] = "none"
    gap = {"before": diagnosis.gap.before, "after": diagnosis.gap.after}
    return {"probabilities": told, "first": first, "gap": gap}


def table(flights: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Yield the rows of the table: a figure for both engines, and the flights on which they differ."""
    yield f"{'':44s}{'today':>12s}{'table':>12s}"
    of = {e: [{**f, "answer": f["answers"][e]} for f in flights] for e in ENGINES}

    def row(name: str, hits: Mapping[str, Sequence[bool]]) -> str:
        return f"{name:44s}" + "".join(f"{sum(hits[e]):6d} of {len(hits[e]):<3d}" for e in ENGINES)

    yield row("first answer right", {e: [is_right(f) for f in of[e]] for e in ENGINES})
    for generator in DRAWS:
        mine = {e: [is_right(f) for f in of[e] if f["case"].startswith(generator)] for e in ENGINES}
        if mine["today"]:
            yield row(f"  {generator}", mine)
    none = {e: [f for f in of[e] if f["truth"]["kind"] == "none"] for e in ENGINES}
    yield row("false alarms, nothing withheld", {e: [is_alarm(f) for f in none[e]] for e in ENGINES})
    sure = {e: [is_right(f) for f in of[e] if stated(f) >= SURE] for e in ENGINES}
    yield row("right where P is at least .9", sure)
    score = {e: sum(map(log_score, of[e])) / max(len(flights), 1) for e in ENGINES}
    yield f"{'log score of the truth, nats a flight':44s}" + "".join(f"{score[e]:12.2f}" for e in ENGINES)
    seconds = {e: sorted(f["answer"]["seconds"] for f in of[e]) for e in ENGINES}
    middle = (f"{seconds[e][len(flights) // 2]:12.1f}" for e in ENGINES)
    yield f"{'processor time, median, s':44s}" + "".join(middle)
    for today, new in zip(*of.values(), strict=True):
        if is_right(today) != is_right(new):
            names = [f"{f['answer']['first']['name']} {stated(f):.2f}" for f in (today, new)]
            truth = today["truth"]
            effects = "+".join(truth.get("effects") or ()) or truth["kind"]
            yield f"{today['case']:34s} {effects:34s} {names[0]:34s} {names[1]}"


def _gate() -> Iterator[dict[str, Any]]:
    """Yield the answers to the gate's flights of pitch."""
    for flight in (f for f in gate_flights() if f.axis == "pitch"):
        with tempfile.TemporaryDirectory() as folder:
            log = flight.log
            if log.suffix == ".xz":
                log = Path(folder) / log.stem
                log.write_bytes(lzma.decompress(flight.log.read_bytes()))
            kinds = [name for name in flight.right if name in ("none", "parameters", "unknown")]
            kind = (
                {"unknown": "outside"}.get(kinds[0], kinds[0]) if kinds[:1] == [*flight.right[:1]] else "one"
            )
            truth = {"kind": kind, "effects": {name: {} for name in flight.right}, "background": flight.right}
            yield answered(f"gate/{flight.name}", log, flight.aircraft_file, truth)


def _fresh(each: int, seed: int, done: set[str]) -> Iterator[dict[str, Any]]:
    """Yield the answers to fresh flights of every generator."""
    for name, case in drawn(each, seed):
        if name not in done and case.truth.get("axis", "pitch") == "pitch":
            with tempfile.TemporaryDirectory() as folder:
                place = Path(folder) / "case"
                write_case(case, place)
                yield answered(name, place / LOG, place / AIRCRAFT, case.truth)


@click.command
@click.option("--each", type=click.IntRange(1), default=4, show_default=True, help="Flights a generator.")
@click.option("--seed", type=click.IntRange(0), default=0, help="Equal seeds give equal flights.")
@click.option("--gate", is_flag=True, help="Diagnose the gate's flights.")
@click.option("--table", "only_table", is_flag=True, help="Print the table and fly nothing.")
def main(each: int, seed: int, gate: bool, only_table: bool) -> None:
    """Fly, answer by both engines, and compare."""
    kept = FOLDER / ("gate.jsonl" if gate else f"{seed}.jsonl")
    kept.parent.mkdir(parents=True, exist_ok=True)
    lines = kept.read_text(encoding="utf-8").splitlines() if kept.exists() else []
    flights = [json.loads(line) for line in lines]
    if not only_table:
        done = {flight["case"] for flight in flights}
        with kept.open("a", encoding="utf-8") as out:
            for flight in _gate() if gate else _fresh(each, seed, done):
                out.write(json.dumps(flight) + "\n")
                out.flush()
                flights.append(flight)
                names = [flight["answers"][e]["first"]["name"] for e in ENGINES]
                print(flight["case"], *names, file=sys.stderr)
    click.echo("\n".join(table(flights)))


if __name__ == "__main__":
    main()
