"""Fit the judge of the gap diagnosis, and score it on generators that it has not seen.

    python -m benchmarks.judge                 # record, fit, score: what `make judge` runs
    python -m benchmarks.judge --each 100      # flights of every generator (seven seconds each)
    python -m benchmarks.judge --score         # the table of the recorded flights alone

Rows of evidence are kept in ``build/judge/rows.jsonl``, a line a flight. Delete the file after a change of
the diagnosis. The weights go to ``advisor/gap/judge/weights.py``.
"""

from pathlib import Path

import click

from benchmarks.judge.fit import fitted, write_weights
from benchmarks.judge.flights import read
from benchmarks.judge.record import record
from benchmarks.judge.score import table

ROWS = Path("build") / "judge" / "rows.jsonl"


@click.command
@click.option("--each", type=click.IntRange(20), default=100, show_default=True, help="Flights a generator.")
@click.option(
    "--rows", type=click.Path(path_type=Path), default=ROWS, show_default=True, help="Recorded rows."
)
@click.option("--score", is_flag=True, help="Print the table of the recorded rows; draw and write nothing.")
def main(each: int, rows: Path, score: bool) -> None:
    """Record flights, fit the weights, and print the scores."""
    if not score:
        record(rows, each)
    flights = read(rows)
    if not score:
        write_weights(fitted(flights), flights)
    click.echo(table(flights))


if __name__ == "__main__":
    main()
