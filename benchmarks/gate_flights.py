"""Recorded flights of the gate next to the checkout, with the answers that count as right."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from advisor.words.axes import AxisName

GATE = Path("../shared/gate")
"""Folder of the gate's cases, next to a checkout."""


@dataclass(frozen=True)
class GateFlight:
    """A flight that the gate diagnoses."""

    name: str
    log: Path
    """Log of the flight; a suffix ``.xz`` marks a packed one."""
    aircraft_file: Path
    axis: AxisName
    right: tuple[str, ...]
    """Answers that count as right, the best first."""


def gate_flights() -> Iterator[GateFlight]:
    """Yield the gate's diagnoses whose logs are at hand; none without the gate."""
    listed = GATE / "cases.json"
    for name, case in json.loads(listed.read_text(encoding="utf-8")).items() if listed.is_file() else ():
        log = GATE / str(case.get("log", ""))
        if case.get("command") == "gap" and log.is_file():
            axis: AxisName = "lateral" if "lateral" in case.get("options", ()) else "pitch"
            yield GateFlight(name, log, GATE / case["aircraft"], axis, tuple(case["answer"]))
