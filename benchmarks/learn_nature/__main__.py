"""Learn the natural widths of the diagnosis by log score, leaving one generator out.

    python -m benchmarks.learn_nature --each 10 --seed 2911801     # diagnoses, keeps the evidence, learns
    python -m benchmarks.learn_nature --seed 2911801 --table       # learns from the evidence kept so far

Learnt are the residual of a right model and of one that lacks a law (``inference/residual.py``), and the
natural size of effects (``inference/sizes.py``, in pitch). The flights have nothing withheld, and something.
Each row has the mean log score of one generator: with the widths in use, with those of data sheets, with the
widths set on all generators, and with those set on the others. A width whose score does not carry over to the
generator left out was learnt by heart. ``build/learn-nature`` keeps the evidence, a line a flight.
"""

import json
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import click
import numpy as np

from benchmarks.gap_draws import DRAWS

from .evidence import KeptFlight
from .flights import AUTOPILOT, asked
from .learning import LeftOut, learnt, left_out_each
from .weighing import Widths

FOLDER = Path("build") / "learn-nature"
GENERATORS = (*DRAWS, AUTOPILOT)
GENERALISES_NATS = 0.05
"""Goal: largest loss of log score, nats a flight, on a generator that was left out."""


def read(kept: Path) -> list[KeptFlight]:
    """Return the flights of a file with evidence; a file that is missing has none."""
    lines = kept.read_text(encoding="utf-8").splitlines() if kept.exists() else []
    return [KeptFlight.of(json.loads(line)) for line in lines]


def gather(kept: Path, each: int, seed: int, generators: Sequence[str]) -> None:
    """Diagnose the flights that have no evidence yet, and keep it."""
    done = {flight.case for flight in read(kept)}
    kept.parent.mkdir(parents=True, exist_ok=True)
    for name, work in asked(each, seed, generators):
        if name in done or (flight := work()) is None:
            continue
        with kept.open("a", encoding="utf-8") as out:
            out.write(json.dumps(flight.document()) + "\n")
        print(name, flight.kind, len(flight.rows), file=sys.stderr, flush=True)


def table(flights: Sequence[KeptFlight]) -> Iterator[str]:
    """Yield the learnt widths, and the scores of each generator left out."""
    in_use = Widths.in_use()
    sheets, on_all = replace(in_use, by_data_sheets=True), learnt(flights, in_use)
    yield f"{'widths':20s} {'residual':>9s} {'right':>6s} {'lacking':>14s} {'effects':>8s}"
    for name, w in (("in use", in_use), ("set on all", on_all)):
        lacking = f"{w.lacking_mean:.2f} ± {w.lacking_std:.2f}"
        yield f"{name:20s} {100 * w.natural:7.2f} % {w.right_std:6.2f} {lacking:>14s} {w.effects:8.2f}"
    yield ""
    heads = ("flights", "in use", "sheets", "on all", "left out")
    yield f"{'log score, nats':20s} " + " ".join(f"{head:>8s}" for head in heads)
    rows = list(left_out_each(flights, in_use, on_all, sheets))
    for row in rows:
        yield _line(row)
    if len(rows) > 1:
        lost = float(np.mean([row.lost for row in rows]))
        yield f"mean loss on the generator left out: {lost:.3f} nats a flight (goal {GENERALISES_NATS})"


def _line(row: LeftOut) -> str:
    return (
        f"{row.generator:20s} {row.flights:8d} {row.in_use:8.3f} {row.by_data_sheets:8.3f} "
        f"{row.on_all:8.3f} {row.on_others:8.3f}"
    )


@click.command
@click.option("--each", type=click.IntRange(1), default=10, show_default=True, help="Flights a generator.")
@click.option("--seed", type=click.IntRange(0), required=True, help="Equal seeds give equal flights.")
@click.option("--generator", "generators", multiple=True, type=click.Choice(GENERATORS), help="Default: all.")
@click.option("--table", "only_table", is_flag=True, help="Learn from kept evidence, and diagnose nothing.")
def main(each: int, seed: int, generators: Sequence[str], only_table: bool) -> None:
    """Gather evidence, learn the widths and print the scores."""
    kept = FOLDER / f"{seed}.jsonl"
    if not only_table:
        gather(kept, each, seed, generators or GENERATORS)
    flights = read(kept)
    if not flights:
        raise click.UsageError(
            f"{kept} has no evidence: leave out --table, or give the seed of an earlier run."
        )
    for line in table(flights):
        click.echo(line)


if __name__ == "__main__":
    main()
