"""The file of decisions by hand: ``flight.maneuvers.yaml`` next to ``flight.tlog``.

Times are seconds since power-on. Every command that reads the log also reads this file.
"""

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import yaml
from pydantic import StringConstraints

from advisor.campaign.hand_decisions import ByHand, Remark
from advisor.flight.maneuvers.marks import LONGEST_S, Mark
from advisor.process.atomic_file import write_atomically
from advisor.process.settings_file import must, read_settings, strict
from advisor.words.ascii_output import printable
from advisor.words.digits import stretch

SUFFIX = ".maneuvers.yaml"
_TEXT_KEYS = {"excluded": "because", "notes": "text", "remarks": "text"}
"""Key of the sentence in each section of the file, by the section's name. Sections have the names of the
fields of ``ByHand``."""
_MEND = "Fix the file, move it away, or give --no-marks."
_HEADING = (
    "# Decided by hand; times in vehicle seconds since power-on. `advisor` reads this file with its log.\n"
)


_Seconds = Annotated[float, must("a number of seconds since power-on")]
_PowerOn = Annotated[int, must("the number of a power-on, 0 for the first", lambda x: x >= 0 and x == int(x))]
_Text = Annotated[str, StringConstraints(min_length=1)]


@strict
@dataclass(frozen=True)
class _Stretch:
    start_s: _Seconds
    end_s: _Seconds
    # Whoever edits the file need not know of power-ons: the first power-on that holds the stretch is meant.
    boot: _PowerOn | None = None


@strict
@dataclass(frozen=True)
class _Excluded:
    at_s: _Seconds
    because: _Text
    boot: _PowerOn = 0


@strict
@dataclass(frozen=True)
class _Noted:
    at_s: _Seconds
    text: _Text
    boot: _PowerOn = 0


@strict
@dataclass(frozen=True)
class _Decided:
    maneuvers: list[_Stretch] = field(default_factory=list)
    excluded: list[_Excluded] = field(default_factory=list)
    notes: list[_Noted] = field(default_factory=list)
    remarks: list[_Noted] = field(default_factory=list)


def _out_of_order(decided: _Decided) -> Iterator[str]:
    for i, mark in enumerate(decided.maneuvers):
        if not 0.0 < mark.end_s - mark.start_s <= LONGEST_S:
            yield f"maneuvers[{i}]: end_s must lie after start_s, by at most {LONGEST_S:.0f} s"


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
    decided = read_settings(path, _Decided, _MEND, _out_of_order)
    marks = tuple(
        Mark(m.start_s, m.end_s, m.boot, name=f"{path.name}: the mark from {stretch(m.start_s, m.end_s)}")
        for m in decided.maneuvers
    )
    remarks = {
        section: tuple(Remark(r.at_s, getattr(r, key), r.boot) for r in getattr(decided, section))
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
