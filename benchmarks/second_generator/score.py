"""Score the diagnosis' answers against a key."""

import hashlib
import json
import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from typing import Any

from .case_files import key_file

# Parameters that the contract gives a name and a unit.
COMPARED = (
    "delay_s",
    "lag_s",
    "half_width_rad",
    "rate_rad_s",
    "scale",
    "bias_rad",
    "bias_rad_s",
    "arm_m",
    "skew_s",
    "rms_m_s",
)
# The contract does not say which way a late stream counts.
SIGNLESS = ("skew_s",)
FAST_S = 5.0
NORMAL_95 = 1.96

Document = dict[str, Any]


@dataclass
class Row:
    """Hits among trials."""

    hits: int = 0
    trials: int = 0

    def add(self, hit: bool) -> None:
        """One trial more."""
        self.hits += hit
        self.trials += 1

    def text(self) -> str:
        """Share, its Wilson interval, and the counts."""
        if self.trials == 0:
            return "no such case"
        low, high = wilson(self.hits, self.trials)
        share = 100.0 * self.hits / self.trials
        return f"{share:5.1f} %   [{100 * low:5.1f}, {100 * high:5.1f}]   {self.hits:>4d} of {self.trials}"


@dataclass
class Table:
    """Rows by title, and a line about everything that was wrong."""

    rows: dict[str, Row] = field(default_factory=dict)
    wrong: list[str] = field(default_factory=list)

    def add(self, title: str, hit: bool) -> None:
        """Count one trial in a row."""
        self.rows.setdefault(title, Row()).add(hit)


def wilson(hits: int, trials: int, z: float = NORMAL_95) -> tuple[float, float]:
    """Wilson's score interval of a share (Wilson, 1927)."""
    share, n = hits / trials, float(trials)
    centre = share + z * z / (2.0 * n)
    half = z * math.sqrt(share * (1.0 - share) / n + z * z / (4.0 * n * n))
    return (centre - half) / (1.0 + z * z / n), (centre + half) / (1.0 + z * z / n)


def condition(case: Document) -> str:
    """Pre-filtered records form a group of their own, whatever the air was."""
    if case["condition"]["pre_filtered_hz"] is not None:
        return "pre-filtered"
    return str(case["condition"]["name"])


def causes(answer: Document) -> list[str]:
    """Names of an answer's causes, best first."""
    return [str(cause["effect"]) for cause in answer.get("causes") or []]


def named(answer: Document) -> str | None:
    """The effect that the verdict stands for, if it is `effect`."""
    found = causes(answer)
    return found[0] if answer.get("verdict") == "effect" and found else None


def quiet(case: Document, answer: Document) -> bool:
    """Nothing is claimed that is not there; background turbulence may be called by its name."""
    if answer.get("verdict") == "none":
        return True
    return "turbulence" in case["condition"]["troubles"] and named(answer) == "turbulence"


def both_found(case: Document, answer: Document) -> bool:
    """Both effects are among the causes or in the waterfall of a verdict `effect`."""
    steps = [str(step["effect"]) for step in answer.get("waterfall") or []]
    true = {effect["effect"] for effect in case["effects"]}
    return answer.get("verdict") == "effect" and true <= {*causes(answer), *steps}


def _inside(name: str, true: float, value: float, std: float) -> bool:
    candidates = [(true, value)]
    if name in SIGNLESS:
        candidates = [(abs(true), abs(value))]
    if name == "scale":
        # Some give the factor itself, others its departure from one.
        candidates.append((1.0 + true, value))
    return any(abs(one - other) <= NORMAL_95 * std for one, other in candidates)


def size_checks(case: Document, answer: Document) -> list[tuple[str, float, float, float, bool]]:
    """For a right single cause: each parameter of the same name as name, truth, value, std, inside."""
    true = case["effects"][0]["parameters"]
    told = answer["causes"][0].get("parameters") or {}
    checks = []
    for name in COMPARED:
        if name in true and name in told and told[name].get("std") is not None:
            value, std = float(told[name]["value"]), float(told[name]["std"])
            checks.append((name, float(true[name]), value, std, _inside(name, float(true[name]), value, std)))
    return checks


def _score_one(table: Table, name: str, case: Document, answer: Document) -> None:
    effect = case["effects"][0]
    right = named(answer) == effect["effect"]
    table.add("one named effect: right cause first", right)
    table.add(f"one named effect, {condition(case)}", right)
    if not effect["dynamic"]:
        table.add("one named effect, constant offsets only", right)
    if right:
        for parameter, true, value, std, inside in size_checks(case, answer):
            table.add("size inside value +- 1.96 std", inside)
            if not inside:
                table.wrong.append(
                    f"{name}  {effect['effect']}  {parameter} {value:.4g} +- {std:.2g}, true {true:.4g}"
                )


def _score_outside(table: Table, case: Document, answer: Document) -> bool:
    unknown = answer.get("verdict") == "unknown"
    block = (answer.get("where") or {}).get("block") == case["effects"][0]["block"]
    table.add("outside the catalogue: verdict unknown", unknown)
    table.add("outside the catalogue: block right", block)
    table.add("outside the catalogue: unknown and block right", unknown and block)
    return unknown and block


def score_case(table: Table, name: str, case: Document, answer: Document) -> bool:
    """Count one case in the table; return whether its answer is right."""
    kind = case["class"]
    table.add("usable", bool(answer.get("usable", False)))
    if kind == "one":
        _score_one(table, name, case, answer)
        good = named(answer) == case["effects"][0]["effect"]
    elif kind == "two":
        good = both_found(case, answer)
        table.add("two named effects: both found", good)
    elif kind == "none":
        good = quiet(case, answer)
        table.add("nothing there: false alarm", not good)
        table.add(f"nothing there, {condition(case)}: false alarm", not good)
    elif kind == "parameters":
        good = answer.get("verdict") == "parameters"
        table.add("parameters told as parameters", good)
    else:
        good = _score_outside(table, case, answer)
    if not good:
        table.wrong.append(_wrong_line(name, case, answer))
    return good


def _wrong_line(name: str, case: Document, answer: Document) -> str:
    true = " + ".join(f"{e['effect']} ({e['largest_dynamic_ratio']:.1f})" for e in case["effects"])
    block = (answer.get("where") or {}).get("block")
    told = f"{answer.get('verdict')} {', '.join(causes(answer)[:3])} @ {block}"
    where = f"{case['aircraft']['name']}, {condition(case)}"
    return f"{name}  {case['class']}: {true or 'nothing'}  [{where}]  told: {told}"


def _speed_lines(seconds: list[float]) -> Iterable[str]:
    if seconds:
        fast = Row(sum(value <= FAST_S for value in seconds), len(seconds))
        yield f"{'CPU seconds, median':<52}{median(seconds):5.2f}"
        yield f"{f'CPU seconds at most {FAST_S:.0f}':<52}{fast.text()}"


@dataclass(frozen=True)
class Scored:
    """A set and its answers laid side by side."""

    seed: int | None
    cases: int
    answered: int
    table: Table
    seconds: list[float]
    """CPU time of each answer that says it."""


def scored(folder: Path, answers: Path) -> Scored:
    """Score a set. A case without an answer is unusable."""
    key = json.loads(key_file(folder).read_text())
    cases = key["cases"]
    lines = [json.loads(line) for line in answers.read_text().splitlines() if line.strip()]
    given = {str(line["case"]): line for line in lines}
    table = Table()
    for name, case in cases.items():
        score_case(table, name, case, given.get(name, {}).get("answer") or {})
    seconds = [float(line["cpu_s"]) for line in lines if line.get("cpu_s") is not None]
    return Scored(key.get("seed"), len(cases), len(given), table, seconds)


def report(folder: Path, answers: Path, details: bool = False) -> str:
    """The table as text; `details` adds a line a wrong case."""
    found = scored(folder, answers)
    table, width = found.table, 52
    out = [f"{found.cases} cases, {found.answered} answers; shares with Wilson 95 % intervals", ""]
    out += [f"{title:<{width}}{table.rows[title].text()}" for title in sorted(table.rows)]
    out += _speed_lines(found.seconds)
    if details:
        out += ["", *table.wrong]
    return "\n".join(out)


def score_document(folder: Path, answers: Path) -> Document:
    """The table as one JSON document, with the seed of the set and the hash of the answers."""
    found = scored(folder, answers)
    fast = Row(sum(value <= FAST_S for value in found.seconds), len(found.seconds))
    rows = {**found.table.rows, f"CPU seconds at most {FAST_S:.0f}": fast}
    return {
        "schema": "score/1",
        "seed": found.seed,
        "cases": found.cases,
        "answered": found.answered,
        "answers_sha256": hashlib.sha256(answers.read_bytes()).hexdigest(),
        "figures": [{"name": title, "hits": row.hits, "trials": row.trials} for title, row in rows.items()],
    }
