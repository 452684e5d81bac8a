"""The file of decisions by hand: ``flight.maneuvers.yaml`` next to ``flight.tlog``.

Times are seconds since power-on. Every command that reads the log also reads this file.
"""

import os
from collections.abc import Sequence
from math import isfinite
from pathlib import Path
from typing import Any

import yaml

from advisor.campaign.hand_decisions import ByHand, Remark
from advisor.flight.maneuvers.marks import LONGEST_S, Mark
from advisor.process.atomic_file import write_atomically
from advisor.process.yaml_file import read_yaml
from advisor.words.printable import printable
from advisor.words.problems import ConfigurationError
from advisor.words.vehicle_time import stretch

SUFFIX = ".maneuvers.yaml"
_TEXT_KEYS = {"excluded": "because", "notes": "text", "remarks": "text"}
"""Key of the sentence in each section of the file, by the section's name. Sections have the names of the
fields of ``ByHand``."""
_SECTIONS = ("maneuvers", *_TEXT_KEYS)
_MEND = "Fix the file, move it away, or give --no-marks."
_HEADING = (
    "# Decided by hand; times in vehicle seconds since power-on. `advisor` reads this file with its log.\n"
)


def path_beside(log: Path) -> Path:
    """Return the path of the file of decisions on a log."""
    return log.parent / f"{log.stem}{SUFFIX}"


def read_by_hand(log: Path) -> ByHand:
    """Read the decisions by hand on a log. Without such a file there are no decisions by hand.

    Raises
    ------
    ConfigurationError
        The file cannot be read, is not YAML, or holds unknown keys or unusable values.
    """
    path = path_beside(log)
    if not os.path.exists(path):  # no path at all counts, too: the log itself is refused later
        return ByHand()
    content = read_yaml(path, _MEND)
    if content is None:
        return ByHand()
    if not isinstance(content, dict):
        raise _mistake(path, f"holds no sections; the sections are {', '.join(_SECTIONS)}")
    for section in content:
        if section not in _SECTIONS:
            raise _mistake(path, f"{section}: unknown key, the sections are {', '.join(_SECTIONS)}")
    marks = tuple(
        _mark(path, f"maneuvers[{i}]", entry) for i, entry in enumerate(_entries(path, content, "maneuvers"))
    )
    remarks = {
        section: tuple(
            _remark(path, f"{section}[{i}]", entry, key)
            for i, entry in enumerate(_entries(path, content, section))
        )
        for section, key in _TEXT_KEYS.items()
    }
    return ByHand(marks, **remarks)


def write_by_hand(log: Path, by_hand: ByHand) -> None:
    """Write the decisions next to a log. The file is always complete, with the old or the new content, even
    after a power failure.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    path = path_beside(log)
    sections: dict[str, list[dict[str, Any]]] = {
        "maneuvers": [
            {"start_s": mark.start_s, "end_s": mark.end_s, **_boot(mark.boot)} for mark in by_hand.marks
        ]
    }
    for section, key in _TEXT_KEYS.items():
        remarks: Sequence[Remark] = getattr(by_hand, section)
        sections[section] = [{"at_s": r.at_s, key: r.text, **_boot(r.boot)} for r in remarks]
    filled = {name: entries for name, entries in sections.items() if entries}
    text = _HEADING + (yaml.safe_dump(filled, sort_keys=False, allow_unicode=True) if filled else "")
    write_atomically(path, text)


def keep_by_hand(log: Path, by_hand: ByHand) -> str:
    """Write the decisions next to a log; return a sentence with the file's path or the failure's reason."""
    path = printable(str(path_beside(log)))
    try:
        write_by_hand(log, by_hand)
    except OSError as error:
        return (
            f"decisions by hand cannot be kept in {path}: {error.strerror or error}; they hold until you quit"
        )
    return f"decisions by hand are kept in {path}"


def keep_on_all(logs: Sequence[Path], before: ByHand, by_hand: ByHand) -> str:
    """Write the decisions on a campaign, each next to its log, if they differ from ``before``."""
    flights = [n for n in range(len(logs)) if by_hand.on_flight(n) != before.on_flight(n)]
    return "; ".join(keep_by_hand(logs[n], by_hand.on_flight(n)) for n in flights)


def _boot(boot: int | None) -> dict[str, int]:
    return {"boot": boot} if boot else {}


def _entries(path: Path, content: dict[str, Any], section: str) -> list[dict[str, Any]]:
    entries = content.get(section) or []
    if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        raise _mistake(path, f"{section}: must be a list of entries with keys")
    return entries


def _mark(path: Path, where: str, entry: dict[str, Any]) -> Mark:
    _refuse_unknown(path, where, entry, ("start_s", "end_s", "boot"))
    start_s, end_s = (_number(path, where, entry, key) for key in ("start_s", "end_s"))
    if not 0.0 < end_s - start_s <= LONGEST_S:
        raise _mistake(path, f"{where}: end_s must lie after start_s, by at most {LONGEST_S:.0f} s")
    name = f"{path.name}: the mark from {stretch(start_s, end_s)}"
    # Whoever edits the file need not know of power-ons: the first power-on that holds the stretch is meant.
    return Mark(start_s, end_s, _power_on(path, where, entry) if "boot" in entry else None, name=name)


def _remark(path: Path, where: str, entry: dict[str, Any], key: str) -> Remark:
    _refuse_unknown(path, where, entry, ("at_s", key, "boot"))
    at_s, text = _number(path, where, entry, "at_s"), entry.get(key)
    if not isinstance(text, str) or not text:
        raise _mistake(path, f"{where}.{key}: must be a text")
    return Remark(at_s, text, _power_on(path, where, entry))


def _refuse_unknown(path: Path, where: str, entry: dict[str, Any], keys: Sequence[str]) -> None:
    for key in entry:
        if key not in keys:
            raise _mistake(path, f"{where}.{key}: unknown key, the keys are {', '.join(keys)}")


def _number(path: Path, where: str, entry: dict[str, Any], key: str) -> float:
    value = entry.get(key)
    if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
        raise _mistake(path, f"{where}.{key}: must be a number of seconds since power-on")
    return float(value)


def _power_on(path: Path, where: str, entry: dict[str, Any]) -> int:
    boot = entry.get("boot", 0)
    if isinstance(boot, bool) or not isinstance(boot, int) or boot < 0:
        raise _mistake(path, f"{where}.boot: must be the number of a power-on, 0 for the first")
    return boot


def _mistake(path: Path, what: str) -> ConfigurationError:
    return ConfigurationError(f"{path}: {what}. {_MEND}")
