"""Flights with known causes, as rows of evidence: what the judge is fitted on."""

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from advisor.gap.alternative import Alternative
from advisor.gap.evidence.rows import Row, stated_as


@dataclass(frozen=True)
class JudgedFlight:
    """One flight: its evidence, its truth, and the answer of the rules."""

    generator: str
    case: str
    rows: tuple[Row, ...]
    truth: Mapping[str, Any]
    answer: Mapping[str, Any]
    """Verdict, causes and block of the document."""

    @property
    def is_right(self) -> np.ndarray:
        """Return which rows are right, shape (rows,), bool."""
        return np.array([is_true(row.alternative, self.truth) for row in self.rows])

    @property
    def rules_are_right(self) -> bool:
        """Whether the first answer of the rules is right, by the measure of the rows."""
        return is_true(answered(self.answer), self.truth)

    @property
    def kind(self) -> str:
        """Kind of the right answer: none, parameters, effect or unknown."""
        kind = str(self.truth["kind"])
        return {"one": "effect", "two": "effect", "outside": "unknown"}.get(kind, kind)


def is_true(alternative: Alternative, truth: Mapping[str, Any]) -> bool:
    """Return whether an alternative is a right first answer.

    Of two effects either is right, alone or as the main effect of a set. Without an effect the air, where it
    moved, is right, too. Without a name the block must be one in which the cause lies.
    """
    kind, effects = truth["kind"], tuple(truth["effects"])
    if kind == "outside":
        return alternative.kind == "unknown" and alternative.block in truth["blocks"]
    if kind in ("one", "two"):
        return alternative.name in effects
    if alternative.name == kind:
        return True
    return kind == "none" and alternative.name in truth["background"]


def answered(document: Mapping[str, Any]) -> Alternative:
    """Return the first answer of a document as an alternative."""
    verdict = document.get("verdict") or "none"
    if verdict == "effect":
        return stated_as(document["causes"][0]["effect"])
    block = document["where"]["block"] if verdict == "unknown" else ""
    return Alternative(verdict, verdict, block)


def written(flights: Iterable[JudgedFlight], path: Path) -> None:
    """Append flights to a file, a line each."""
    with path.open("a", encoding="utf-8") as out:
        for flight in flights:
            rows = [
                [r.alternative.kind, r.alternative.name, r.alternative.block,
                 {name: float(f"{value:.6g}") for name, value in r.values.items() if value},
                 *filter(None, [r.alternative.second])]
                for r in flight.rows
            ]  # fmt: skip
            line = {
                "generator": flight.generator, "case": flight.case, "rows": rows,
                "truth": dict(flight.truth), "answer": dict(flight.answer),
            }  # fmt: skip
            out.write(json.dumps(line, separators=(",", ":")) + "\n")


def read(path: Path) -> list[JudgedFlight]:
    """Read the flights of a file."""
    return list(_read(path.read_text(encoding="utf-8").splitlines()))


def _read(lines: Sequence[str]) -> Iterator[JudgedFlight]:
    for text in lines:
        line = json.loads(text)
        rows = tuple(
            Row(Alternative(kind, name, block, *second), values)
            for kind, name, block, values, *second in line["rows"]
        )
        yield JudgedFlight(line["generator"], line["case"], rows, line["truth"], line["answer"])
