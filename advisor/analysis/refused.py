"""Manoeuvres that ``advisor analyze`` refuses by their data alone, which the gap does not use either."""

from collections.abc import Sequence
from dataclasses import dataclass

from advisor.aircraft.aircraft import Aircraft
from advisor.decision.envelope import incomplete, outside
from advisor.decision.quality import natural_period
from advisor.decision.verdict import Reason
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import NoEstimate
from advisor.simulators.speed_kind import SpeedKind

_KNOWN = frozenset({"throttle", "rate"})
"""Reasons that do not apply here. The gap's model knows the throttle, and the gap says itself which effects a
slow channel hides."""
LEAST = 3
"""Least number of manoeuvres that must remain: two for a search, and one kept apart from it."""


@dataclass(frozen=True)
class Chosen:
    """The manoeuvres in use, and a sentence on each of the others."""

    maneuvers: list[Maneuver]
    notes: tuple[str, ...]

    def with_speed(self, kind: SpeedKind) -> "Chosen":
        """Return the choice with the kind of air speed that the motion shows."""
        return Chosen(kind.maneuvers, (kind.note, *self.notes) if kind.note else self.notes)


def without_refused(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> Chosen:
    """Return the manoeuvres without those outside the limits or with incomplete data.

    Where fewer than ``LEAST`` would remain, all are used, and the sentences say what is wrong.
    """
    reasons = {m.number: reason for m in maneuvers if (reason := _reason(m, aircraft)) is not None}
    good = [m for m in maneuvers if m.number not in reasons]
    enough = len(good) >= LEAST
    verb = "is not used" if enough else "is used, although analyze refuses it"
    notes = tuple(f"Manoeuvre {number} {verb}: {reason.text}." for number, reason in reasons.items())
    return Chosen(good if enough else list(maneuvers), notes)


def _reason(maneuver: Maneuver, aircraft: Aircraft) -> Reason | None:
    """Return the first reason for which ``advisor analyze`` refuses a manoeuvre, whatever its estimate."""
    period_s = natural_period(maneuver, NoEstimate("not_asked", "no estimate was asked for"))
    found = [*incomplete(maneuver, period_s, ("alpha",)), *outside(maneuver, aircraft)]
    return next((reason for reason in found if reason.code not in _KNOWN), None)
