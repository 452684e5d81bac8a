"""Input of the rules: the manoeuvres of a campaign in the order flown, and nothing else.

Every rule is a function of the whole history, so that excluding a manoeuvre by hand decides anew on all later
ones. The cache between decisions (``course``) changes no decision.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

from advisor.decision.verdict import Reason
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.surface import Servo


@dataclass(frozen=True, slots=True)
class CandidateManeuver:
    """One manoeuvre before the rules judge it."""

    estimate: Estimate | NoEstimate
    reasons: tuple[Reason, ...] = ()
    """Objections to the manoeuvre itself (too gentle, banked, ...), the most important first."""
    cautions: tuple[str, ...] = ()
    """Remarks for the verdict that do not reject the manoeuvre."""
    excluded_because: str | None = None
    """Reason for which an engineer excluded the manoeuvre; None: the manoeuvre counts."""
    maneuver: Maneuver | None = None
    """Flown data, for advice on the next input."""
    air_moved: bool = False
    """Whether the manoeuvre's residuals show moving air."""
    servo: Servo = field(default_factory=Servo)
    """Servo between command and surface, as the estimate uses it."""

    responses: tuple[str, ...] = ("alpha", "q")
    """Outputs that show the response to the input."""

    @property
    def usable(self) -> Estimate | None:
        """Estimate of a manoeuvre that a rule may judge. None: the manoeuvre is excluded, rejected or not
        estimated."""
        if isinstance(self.estimate, Estimate) and not self.reasons and self.excluded_because is None:
            return self.estimate
        return None


def usable_ones(history: Sequence[CandidateManeuver]) -> list[CandidateManeuver]:
    """Return all usable manoeuvres, in the order flown."""
    return [flown for flown in history if flown.usable]


def nothing_tested(history: Sequence[CandidateManeuver]) -> str:
    """Return the sentence on a history without a usable manoeuvre; empty where one is usable."""
    if usable_ones(history):
        return ""
    if not history:
        return "No test input of the elevator has been flown."
    one = len(history) == 1
    which = "The one input" if one else f"None of the {len(history)} inputs"
    return f"{which} of the elevator can{'not' if one else ''} be used."


def is_named(flown: CandidateManeuver) -> bool:
    """Return whether a crew can repeat the input: its shape has a name."""
    return flown.maneuver is None or flown.maneuver.span.kind != "other"


def estimates_of(usable: Sequence[CandidateManeuver]) -> list[Estimate]:
    """Return the estimates of the usable manoeuvres, in the order flown."""
    return [estimate for flown in usable if (estimate := flown.usable)]
