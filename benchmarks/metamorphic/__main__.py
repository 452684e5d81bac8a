"""Diagnose recorded flights again after natural changes of their telemetry; no truth is needed.

    python -m benchmarks.metamorphic                       # every log with an aircraft file next to it
    python -m benchmarks.metamorphic flight.tlog --axis pitch --change "command stamps + 16 ms"
    python -m benchmarks.metamorphic --table               # the table of the answers kept so far

A change shifts, scales or offsets channels of all manoeuvres in memory, or removes the last manoeuvre. The
answer must stay, and its probability may move by as much as the prior of the changed quantity allows.
Answers are kept in ``build/metamorphic``, a line a diagnosis: a run goes on where it stopped.
"""

import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import click
import numpy as np

from advisor.words.problems import ConfigurationError
from benchmarks.metamorphic.changes import CHANGES, Change
from benchmarks.metamorphic.flights import Answer, flights_of, logs_of

FOLDER = Path("build") / "metamorphic"
AS_FLOWN = "as flown"
_SURE_ENOUGH = 1e-3
"""Numerical: distance of a probability from 0 and from 1 within which its log odds are not compared."""


@dataclass(frozen=True)
class Moved:
    """The answer to a changed flight next to the answer to the flight as recorded."""

    flight: str
    change: str
    before: Answer
    after: Answer
    allowed_nats: float

    @classmethod
    def of(cls, rows: Mapping[str, Any], change: Change, flight: str) -> Self:
        """Return the pair of answers from kept rows, by the name of the change."""
        each = (Answer(rows[name]["shares"], rows[name]["because"]) for name in (AS_FLOWN, change.name))
        return cls(flight, change.name, *each, change.allowed_nats)

    @property
    def stays(self) -> bool:
        """Whether the changed flight has the same first answer."""
        return self.before.name == self.after.name

    @property
    def moved_nats(self) -> float:
        """Change of the log odds of the first answer, nats."""
        odds = (log_odds(answer.of(self.before.name)) for answer in (self.before, self.after))
        return abs(float(np.subtract(*odds)))

    @property
    def is_allowed(self) -> bool:
        """Whether the log odds moved by no more than the prior of the changed quantity allows."""
        return self.moved_nats <= self.allowed_nats

    def __str__(self) -> str:
        name = self.before.name
        first = f"{name} {self.before.of(name):.2f} -> {self.after.of(name):.2f}"
        other = "" if self.stays else f", now {self.after.name} {self.after.of(self.after.name):.2f}"
        return f"{self.flight:32s} {self.change:24s} {first}, {self.moved_nats:.1f} nats{other}"


def log_odds(probability: float) -> float:
    """Return the log odds of a probability, nats, limited to probabilities of .001 to .999."""
    p = float(np.clip(probability, _SURE_ENOUGH, 1.0 - _SURE_ENOUGH))
    return float(np.log(p / (1.0 - p)))


def table(pairs: Sequence[Moved]) -> Iterator[str]:
    """Yield a row for each change with the numbers of answers that stay, and a row of all changes."""
    yield f"{'change':24s} {'stays':>10s} {'P as allowed':>14s} {'median nats':>12s}"
    for name in [change.name for change in CHANGES] + ["all"]:
        mine = [pair for pair in pairs if name in (pair.change, "all")]
        if mine:
            stays, allowed = sum(p.stays for p in mine), sum(p.is_allowed for p in mine)
            nats = np.median([p.moved_nats for p in mine])
            yield f"{name:24s} {stays:4d} of {len(mine):<3d} {allowed:6d} of {len(mine):<3d} {nats:12.2f}"


class Kept:
    """Answers of earlier runs, by flight and change, in a file."""

    def __init__(self, file: Path) -> None:
        self._file = file
        self.rows: dict[str, dict[str, Any]] = {}
        for line in file.read_text(encoding="utf-8").splitlines() if file.exists() else []:
            row = json.loads(line)
            self.rows.setdefault(row["flight"], {})[row["change"]] = row

    def add(self, flight: str, change: str, answer: Answer) -> None:
        """Keep an answer."""
        row = {"flight": flight, "change": change, "shares": answer.shares, "because": answer.because}
        self.rows.setdefault(flight, {})[change] = row
        self._file.parent.mkdir(parents=True, exist_ok=True)
        with self._file.open("a", encoding="utf-8") as out:
            out.write(json.dumps(row) + "\n")

    def pairs(self) -> list[Moved]:
        """Return all changed flights whose flight as recorded has an answer."""
        return [
            Moved.of(rows, change, flight)
            for flight, rows in self.rows.items()
            for change in CHANGES
            if change.name in rows and rows.get(AS_FLOWN, {}).get("shares")
        ]


def answer_all(log: Path, axes: Sequence[str], changes: Sequence[Change], kept: Kept) -> None:
    """Answer a log as recorded and after each change; kept answers are not computed again."""
    wanted = {AS_FLOWN, *(change.name for change in changes)}
    label = f"{log.resolve().parent.name}/{log.name.split('.')[0]}"
    unread = [axis for axis in axes if wanted - set(kept.rows.get(f"{label} {axis}", {}))]
    for axis, flight in flights_of(log, unread):
        name = f"{label} {axis}"
        done = kept.rows.get(name, {})
        if AS_FLOWN not in done:
            kept.add(name, AS_FLOWN, flight.answered(flight.maneuvers))
        if not kept.rows[name][AS_FLOWN]["shares"]:
            print(f"{name}: {kept.rows[name][AS_FLOWN]['because']}", file=sys.stderr)
            continue
        for change in changes:
            if change.name in done or not change.changes(flight.maneuvers):
                continue
            kept.add(name, change.name, flight.answered(change.apply(flight.maneuvers)))
            print(Moved.of(kept.rows[name], change, name), file=sys.stderr, flush=True)


@click.command
@click.argument("logs", nargs=-1, type=click.Path(path_type=Path, exists=True))
@click.option("--axis", "axes", multiple=True, type=click.Choice(["pitch", "lateral"]), help="Default: both.")
@click.option(
    "--change", "names", multiple=True, type=click.Choice([change.name for change in CHANGES]),
    help="Changes to make. Default: all.",
)  # fmt: skip
@click.option("--label", default="answers", help="Name of the answers' file, to compare states of the code.")
@click.option("--table", "only_table", is_flag=True, help="Print the table and diagnose nothing.")
def main(
    logs: Sequence[Path], axes: Sequence[str], names: Sequence[str], label: str, only_table: bool
) -> None:
    """Diagnose LOGS, files or folders, as recorded and after natural changes of the telemetry."""
    kept = Kept(FOLDER / f"{label}.jsonl")
    changes = [change for change in CHANGES if not names or change.name in names]
    for log in [] if only_table else logs_of(logs):
        try:
            answer_all(log, axes or ("pitch", "lateral"), changes, kept)
        except ConfigurationError as error:
            print(f"{log.name}: {error}", file=sys.stderr)
    pairs = kept.pairs()
    for pair in pairs:
        if not (pair.stays and pair.is_allowed):
            click.echo(pair)
    for row in table(pairs):
        click.echo(row)


if __name__ == "__main__":
    main()
