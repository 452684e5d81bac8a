"""Verdict and reason of each manoeuvre."""

from collections.abc import Mapping
from typing import Any

from advisor.report.page.blocks import Content, Section, listing
from advisor.report.table import Table
from advisor.report.text import caution_lines
from advisor.words.digits import CLOCK, clock

_HYPHEN, _SPACE = "\N{NON-BREAKING HYPHEN}", "\N{NO-BREAK SPACE}"
ANCHORS = {"": "maneuver-list", "R": "lateral-maneuvers"}
"""Table that lists a manoeuvre, by the letter before its number: R for roll and yaw."""
HEAD = ("no.", "start", "input", "mode", "verdict", "why")


def maneuvers(content: Content) -> Section:
    """Return a table with a row for each manoeuvre, then cautions that reject no manoeuvre."""
    listed = content.analysis["maneuvers"]
    rows = tuple(maneuver_row(maneuver, several=len(content.names) > 1) for maneuver in listed)
    table = Table(
        ANCHORS[""], f"Every manoeuvre in the order flown; times are {CLOCK}.", HEAD, rows,
        frozenset({0, 1}), anchored=True,
    )  # fmt: skip
    return Section("maneuvers", "Manoeuvres", (table, *listing(caution_lines(content.state.maneuvers))))


def maneuver_row(maneuver: Mapping[str, Any], *, several: bool) -> tuple[str, ...]:
    """Return number, start, input, mode, verdict and sentence of a manoeuvre. With several logs, add the name
    of its log.
    """
    accepted = maneuver["verdict"] == "accepted"
    why = [maneuver["sentence"], *(f"note: {note}" for note in maneuver.get("notes", ()))]
    if maneuver.get("excluded_because") is not None:
        why.append(f"excluded by hand: {maneuver['excluded_because']}")
    if several and "log" in maneuver:
        why.append(f"({maneuver['log']})")
    return (
        str(maneuver["number"]),
        clock(maneuver["start_boot_s"]),
        maneuver["input"].replace("-", _HYPHEN).replace(" ", _SPACE),
        maneuver["mode"],
        f"✓{_SPACE}accepted" if accepted else f"✗{_SPACE}rejected",
        " ".join(why),
    )
