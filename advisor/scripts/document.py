"""The table of a script as a document and as lines."""

from collections.abc import Sequence
from dataclasses import asdict
from math import degrees
from typing import Any

from advisor.scripts.inputs import Control
from advisor.scripts.table import Entry, ScriptTable
from advisor.words.problems import Problem

SCHEMA = "advisor.script/1"


def script_document(table: ScriptTable | None, file: str, problems: Sequence[Problem] = ()) -> dict[str, Any]:
    """Return the document of ``advisor script --json``; without a table, the problems alone."""
    document: dict[str, Any] = {
        "schema": SCHEMA,
        "usable": table is not None,
        "problems": [asdict(problem) for problem in problems],
        "file": file,
    }
    if table is None:
        return document
    pace = table.pace
    return document | {
        "autopilot": "ardupilot",
        "aircraft": table.aircraft.name,
        "hash": table.identity.calibration,
        "switch": table.switch,
        "period_s": pace.period_s,
        "roll_s": pace.roll_s,
        "dutch_roll_s": pace.dutch_roll_s,
        "why": dict(pace.why),
        "limits": asdict(table.limits),
        "inputs": [_input(number, entry) for number, entry in enumerate(table.entries, 1)],
    }


def _input(number: int, entry: Entry) -> dict[str, Any]:
    test = entry.test
    return {
        "number": number,
        "name": test.name,
        "held": list(test.held),
        "length_s": test.length_s,
        "rest_s": test.rest_s,
        "moves": {control: _moves(entry, control) for control in test.moved},
    }


def _moves(entry: Entry, control: Control) -> dict[str, Any]:
    """Return the motion of a control from the begin of an input, in s and rad, with the reason of
    its size.
    """
    test, size = entry.test, entry.sizes[control]
    moves: dict[str, Any] = {"size": size.rad, "why": size.why}
    if test.sines is not None:
        sines = test.sines[control]
        lines = zip(sines.harmonics, sines.phases_rad, strict=True)
        moves["sines"] = [
            {"hz": k / test.length_s, "amplitude": size.rad * sines.amplitude, "phase_rad": phase}
            for k, phase in lines
        ]
        return moves
    start, steps = 0.0, []
    for units, share in test.steps:
        end = start + units * test.unit_s
        steps.append({"start_s": round(start, 4), "end_s": round(end, 4), "deflection": share * size.rad})
        start = end
    return moves | {"steps": steps}


def lines_of(table: ScriptTable) -> list[str]:
    """Return one line for each input: name, time unit or length, and the size of each control."""
    lines = []
    for number, entry in enumerate(table.entries, 1):
        test = entry.test
        pace = f"{test.unit_s:.2f} s steps" if test.sines is None else f"{test.length_s:.0f} s"
        sizes = ", ".join(f"{c} {degrees(s.rad):.1f} deg ({s.why})" for c, s in entry.sizes.items())
        lines.append(f"{number}  {test.name}, {pace}, then {test.rest_s:g} s hands off: {sizes}")
    return lines
