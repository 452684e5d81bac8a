"""Input of the rules, which consists of the manoeuvres of a campaign in the order flown.

Every rule depends on the whole history, so the exclusion of a manoeuvre changes later decisions. The cache
between decisions (``course``) changes no decision.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

from advisor.decision.verdict import Reason
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.surface import Servo


@dataclass(frozen=True, slots=True)
class CandidateManeuver:
    """One manoeuvre before any rule judges it."""

    estimate: Estimate | NoEstimate
    reasons: tuple[Reason, ...] = ()
    """Objections to the manoeuvre itself (too gentle, banked, ...), the most important first."""
    cautions: tuple[str, ...] = ()
    """Remarks for the verdict that do not reject the manoeuvre."""
    excluded_because: str | None = None
    """Reason why an engineer excluded the manoeuvre; None for an included one."""
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
        """Estimate of a manoeuvre for the rules. None if the manoeuvre is excluded, rejected or without an
        estimate."""
        if isinstance(self.estimate, Estimate) and not self.reasons and self.excluded_because is None:
            return self.estimate
        return None


def usable_ones(history: Sequence[CandidateManeuver]) -> list[CandidateManeuver]:
    """Return all usable manoeuvres, in the order flown."""
    return [flown for flown in history if flown.usable]


def nothing_tested(history: Sequence[CandidateManeuver]) -> str:
    """Return the sentence about a history without a usable manoeuvre; empty if one is usable."""
    if usable_ones(history):
        return ""
    if not has_begun(history):
        return "No test input of the elevator has been flown."
    single = len(history) == 1
    which = "The one input" if single else f"None of the {len(history)} inputs"
    return f"{which} of the elevator can{'not' if single else ''} be used."


def has_begun(history: Sequence[CandidateManeuver]) -> bool:
    """Return whether the test of an axis has begun: by a named or marked input, or by a usable movement."""
    return any(
        flown.maneuver is None or flown.maneuver.span.is_test_input or flown.usable for flown in history
    )


def is_named(flown: CandidateManeuver) -> bool:
    """Return whether a crew can repeat the input, because its shape has a name."""
    return flown.maneuver is None or flown.maneuver.span.kind != "other"


def estimates_of(usable: Sequence[CandidateManeuver]) -> list[Estimate]:
    """Return the estimates of the usable manoeuvres, in the order flown."""
    return [estimate for flown in usable if (estimate := flown.usable)]
