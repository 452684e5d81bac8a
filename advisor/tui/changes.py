"""What changed from one report to the next, to be sent from one process to another."""

from dataclasses import dataclass, fields, replace
from typing import Any

from advisor.tui.conducting import Report


@dataclass(frozen=True, slots=True)
class Changes:
    """Fields that hold another object than in the report before.

    The manoeuvres with all their samples are sent when one was judged, not ten times a second.
    And whoever receives the changes keeps the very objects that did not change: by these, panes
    know what need not be painted anew.
    """

    report: dict[str, Any]
    state: dict[str, Any]

    def applied_to(self, last: Report) -> Report:
        """The newer report."""
        return replace(last, **self.report, state=replace(last.state, **self.state))


def changes(last: Report, report: Report) -> Changes:
    """What must be known besides ``last`` to have ``report``; the state's notices are in its log."""
    return Changes(_changed(last, report, "state"), _changed(last.state, report.state, "notices"))


def _changed(old: Any, new: Any, without: str) -> dict[str, Any]:
    pairs = {f.name: (getattr(old, f.name), getattr(new, f.name)) for f in fields(new) if f.name != without}
    return {name: after for name, (before, after) in pairs.items() if after is not before}
