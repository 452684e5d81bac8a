"""What the product says of records of real aircraft, against what is known of them.

    python -m benchmarks.real FOLDER [--write docs/data/real.json]

``real_records.yaml`` holds what was flown and what is published; the records themselves stay where they
are. Each record runs through ``advisor analyze --json`` with the aircraft file of the same name, as a user
runs it. A figure holds when it lies within its tolerance, or when the stated 95 % interval contains the
known value. The interval must be narrower than the figure: a wider one does not tell even the sign.
"""

import argparse
import json
import platform
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import date
from math import inf
from pathlib import Path
from typing import Any

import yaml

from advisor.aircraft.reference import SPEED_EXPONENTS
from advisor.words.quantities import symbol

RECORDS = Path(__file__).with_name("real_records.yaml")
NEAR_S = 1.5
"""A found input is the one that was flown when it begins this close to it, s."""
NORMAL_95 = 1.96
_OUTSIDE = " (published value outside)"
"""Words behind a figure within its tolerance, and outside the stated interval."""


@dataclass(frozen=True)
class Row:
    """One record: what was asked of it and what came out."""

    log: str
    what: str
    asked: str
    got: str
    holds: bool

    @property
    def word(self) -> str:
        """Whether the record holds, as tables say it."""
        if not self.holds:
            return "**no**"
        return "by tolerance" if _OUTSIDE in self.got else "yes"


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; 0 also where the records are not here, 1 where something does not hold."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--write", type=Path, help="keep the rows in this JSON file")
    given = parser.parse_args(arguments)
    if not given.folder.is_dir():
        print(f"No flight records at {given.folder}: nothing was measured. Say where: make real FLIGHTS=DIR")
        return 0
    records = yaml.safe_load(RECORDS.read_text(encoding="utf-8"))
    rows = [row for record in records for row in judged(record, given.folder)]
    measured = f"{date.today().isoformat()}, commit {commit()}, Python {platform.python_version()}"
    print(in_markdown(rows, measured))
    if given.write:
        write(given.write, rows, measured)
    return 0 if all(row.holds for row in rows) else 1


def commit() -> str:
    """Return the short name of the commit that is measured; ``unknown`` outside a repository."""
    asked = ["git", "-C", str(RECORDS.parent), "rev-parse", "--short", "HEAD"]
    return subprocess.run(asked, capture_output=True, text=True, check=False).stdout.strip() or "unknown"


def judged(record: Mapping[str, Any], folder: Path) -> Iterator[Row]:
    """The row of a record; none where the folder does not hold the log."""
    log = folder / record["log"]
    if not log.exists():
        return
    document = analyzed(log)
    claims = [*_found(record, document), *_accepted(record, document), *_stopped(record, document)]
    claims += _figures(record, document)
    asked, got, holds = zip(*claims, strict=True)
    yield Row(record["log"], record["what"], "; ".join(asked), "; ".join(got), all(holds))


def analyzed(log: Path) -> dict[str, Any]:
    """The document of ``advisor analyze``."""
    aircraft = log.with_suffix(".yaml")
    options = ["--aircraft", str(aircraft)] if aircraft.exists() else []
    command = [sys.executable, "-m", "advisor", "analyze", str(log), *options, "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def write(path: Path, rows: Sequence[Row], measured: str) -> None:
    """Keep the rows, one a line, so that a change shows as one."""
    lines = ",\n".join(f"  {json.dumps(asdict(row), ensure_ascii=False)}" for row in rows)
    path.write_text(
        f'{{\n "measured": {json.dumps(measured)},\n "records": [\n{lines}\n ]\n}}\n', encoding="utf-8"
    )


def read(path: Path) -> tuple[list[Row], str]:
    """The rows of a file that ``write`` has made, and when and where they were measured."""
    kept = json.loads(path.read_text(encoding="utf-8"))
    return [Row(**row) for row in kept["records"]], kept["measured"]


def in_markdown(rows: Sequence[Row], measured: str) -> str:
    """The table, with its date and machine."""
    lines = ["| record | flown | asked | got | holds |", "|---|---|---|---|---|"]
    lines += [f"| `{r.log}` | {r.what} | {symbol(r.asked)} | {symbol(r.got)} | {r.word} |" for r in rows]
    held = sum(row.holds for row in rows)
    return "\n".join([*lines, "", f"{held} of {len(rows)} hold. Measured {measured}."])


Claim = tuple[str, str, bool]


def _found(record: Mapping[str, Any], document: Mapping[str, Any]) -> Iterator[Claim]:
    flown = record["flown"]
    if isinstance(flown, int):
        found = len(document["maneuvers"])
        yield f"{flown} found", f"{found} found", found == flown
        return
    hits = sum(_at(document, start_s) is not None for start_s in flown)
    yield f"{len(flown)} found", f"{hits} found", hits == len(flown)


def _accepted(record: Mapping[str, Any], document: Mapping[str, Any]) -> Iterator[Claim]:
    flown = record["flown"]
    mine = document["maneuvers"] if isinstance(flown, int) else [_at(document, s) for s in flown]
    among = [m for m in mine if m is not None]
    accepted = sum(m["verdict"] == "accepted" for m in among)
    if record["accepted"] == 0:
        reasons = ", ".join(sorted({r["code"] for m in among for r in m["reasons"][:1]}))
        yield "refused", f"refused for {reasons}" if accepted == 0 else "accepted", accepted == 0
    else:
        yield (
            f"at least {record['accepted']} accepted",
            f"{accepted} accepted",
            accepted >= record["accepted"],
        )


def _stopped(record: Mapping[str, Any], document: Mapping[str, Any]) -> Iterator[Claim]:
    if "stop" in record:
        stopped = document["flight_test"]["stopped_at"]
        said = f"stop after {stopped}" if stopped else "no stop"
        yield f"stop by {record['stop']}", said, stopped is not None and stopped <= record["stop"]


def _figures(record: Mapping[str, Any], document: Mapping[str, Any]) -> Iterator[Claim]:
    for name, known in record.get("figures", {}).items():
        value, half = _figure(name, document)
        truth = _truth(name, known, record, document["model"]["reference_airspeed_m_s"])
        margin = known["within"] * abs(truth) if "within" in known else known["absolute"]
        off = inf if value is None else abs(value - truth)
        shown = "none" if value is None else f"{value:.3g} ± {half:.2g}"
        outside = _OUTSIDE if half < off <= margin else ""
        # An interval that reaches across zero does not tell the sign.
        holds = value is not None and off <= max(margin, half) and half < abs(value)
        yield f"{name} {truth:.3g} ± {margin:.2g}", f"{name} {shown}{outside}", bool(holds)
    for name, excluded in record.get("outside", {}).items():
        value, half = _figure(name, document)
        holds = value is not None and abs(value - excluded) > half
        yield f"{name} {excluded:g} outside the interval", "outside" if holds else "inside", holds


def _truth(name: str, known: Mapping[str, float], record: Mapping[str, Any], speed_m_s: float) -> float:
    """Return a known figure at the air speed of the estimate, m/s.

    A record's ``at_true_m_s`` is the true air speed of its figures. A derivative grows with a power of the
    speed.
    """
    at_m_s = record.get("at_true_m_s")
    if at_m_s is None:
        return known["value"]
    speed_m_s *= record.get("true_over_standard", 1.0)
    return float(known["value"] * (speed_m_s / at_m_s) ** SPEED_EXPONENTS.get(name, 0))


def _figure(name: str, document: Mapping[str, Any]) -> tuple[float | None, float]:
    """A figure of the joint estimate and the half-width of its 95 % interval."""
    model = document["model"] or {}
    instruments = model.get("instruments", {})
    if name == "servo_lateness_s":
        # A servo's lag and a delay look nearly alike, and fits without a delay give their sum as the lag.
        parts = [instruments[n] for n in ("servo_lag_s", "command_delay_s") if n in instruments]
        value = float(sum(part["value"] for part in parts)) if parts else None
        return value, NORMAL_95 * float(sum(part["std"] ** 2 for part in parts)) ** 0.5
    if name in ("servo_lag_s", "vane_arm_m"):
        entry = instruments.get(name, {})
    elif name.startswith("C_"):
        entry = document["coefficients"].get(name, {})
    else:
        entry = model.get(name, {})
    if entry.get("value") is None:
        return None, 0.0
    return float(entry["value"]), NORMAL_95 * float(entry["std"])


def _at(document: Mapping[str, Any], start_s: float) -> Mapping[str, Any] | None:
    near = [m for m in document["maneuvers"] if abs(m["start_boot_s"] - start_s) <= NEAR_S]
    return near[0] if near else None


if __name__ == "__main__":
    sys.exit(main())
