"""What the rules look at: the manoeuvres of a campaign in the order flown, nothing else.

Every rule is a function of the whole history, so that excluding a manoeuvre by hand decides anew all that
followed it. What is kept from one decision to the next (``course``) changes no decision.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

from advisor.decision.verdict import Reason
from advisor.flight.maneuver import Maneuver
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.surface import Servo


@dataclass(frozen=True, slots=True)
class Flown:
    """One manoeuvre before the rules judge it."""

    estimate: Estimate | NoEstimate
    reasons: tuple[Reason, ...] = ()
    """What speaks against the manoeuvre itself (too gentle, banked, ...), the most telling first."""
    cautions: tuple[str, ...] = ()
    """What does not speak against it but belongs on its verdict."""
    excluded_because: str | None = None
    """Set when an engineer took it out by hand."""
    maneuver: Maneuver | None = None
    """What was flown, for advice on what to fly next."""
    air_moved: bool = False
    """Whether its residuals bear the mark of moving air."""
    servo: Servo = field(default_factory=Servo)
    """What lies between command and surface, as the estimate takes it."""

    @property
    def usable(self) -> Estimate | None:
        """Its estimate, if the manoeuvre may be held against any rule at all."""
        if isinstance(self.estimate, Estimate) and not self.reasons and self.excluded_because is None:
            return self.estimate
        return None


def usable_ones(history: Sequence[Flown]) -> list[Flown]:
    """Return all usable manoeuvres, in the order flown."""
    return [flown for flown in history if flown.usable]


def estimates_of(usable: Sequence[Flown]) -> list[Estimate]:
    """Return the estimates of manoeuvres, in the order flown; those that are not usable have none."""
    return [estimate for flown in usable if (estimate := flown.usable)]
