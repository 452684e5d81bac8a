"""Differences between two reports, for sending from one process to another."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

from advisor.campaign.state import JudgedManeuver
from advisor.decision.verdict import ManeuverVerdict
from advisor.session.conducting import SessionReport


@dataclass(frozen=True, slots=True)
class Again:
    """A manoeuvre that was sent earlier, with a new verdict. Samples and estimate stay."""

    index: int
    verdict: ManeuverVerdict
    excluded_because: str | None
    notes: tuple[str, ...]

    @classmethod
    def of(cls, index: int, judged: JudgedManeuver) -> "Again":
        """Return the new judgement of the manoeuvre."""
        return cls(index, judged.verdict, judged.excluded_because, judged.notes)

    def applied_to(self, maneuvers: Sequence[JudgedManeuver]) -> JudgedManeuver:
        """Return the manoeuvre with the new judgement; the identical object where nothing changed."""
        last = maneuvers[self.index]
        if self == Again.of(self.index, last):
            return last
        return replace(last, verdict=self.verdict, excluded_because=self.excluded_because, notes=self.notes)


@dataclass(frozen=True, slots=True)
class Changes:
    """Fields whose object differs from the earlier report's.

    The samples of a manoeuvre are sent once, not with every verdict and ten times a second. The receiver
    keeps the identical objects of unchanged fields. By their identity, panes know what needs no painting.
    """

    report: dict[str, Any]
    state: dict[str, Any]
    maneuvers: tuple[JudgedManeuver | Again, ...] | None = None
    """The manoeuvres. None where none was judged."""

    def applied_to(self, last: SessionReport) -> SessionReport:
        """Return the newer report."""
        state = dict(self.state)
        if self.maneuvers is not None:
            known = last.state.maneuvers
            state["maneuvers"] = tuple(
                sent.applied_to(known) if isinstance(sent, Again) else sent for sent in self.maneuvers
            )
        return replace(last, **self.report, state=replace(last.state, **state))


def changes(last: SessionReport, report: SessionReport) -> Changes:
    """Return the changes that turn ``last`` into ``report``. The state's notices are in its log."""
    before, now = last.state.maneuvers, report.state.maneuvers
    return Changes(
        _changed(last, report, {"state"}),
        _changed(last.state, report.state, {"notices", "maneuvers"}),
        None if now is before else tuple(_sent(before, k, judged) for k, judged in enumerate(now)),
    )


def _sent(before: Sequence[JudgedManeuver], index: int, judged: JudgedManeuver) -> JudgedManeuver | Again:
    if index < len(before):
        last = before[index]
        if judged.maneuver is last.maneuver and judged.estimate is last.estimate:
            return Again.of(index, judged)
    return judged


def _changed(old: Any, new: Any, without: set[str]) -> dict[str, Any]:
    pairs = {
        f.name: (getattr(old, f.name), getattr(new, f.name)) for f in fields(new) if f.name not in without
    }
    return {name: after for name, (before, after) in pairs.items() if after is not before}
