"""Plan of both axes for the crew: complete axes, open axes, and the next input."""

from dataclasses import dataclass
from math import inf

from advisor.decision.verdict import FlightTestVerdict, NextInput

_IS = {"pitch": "is", "roll and yaw": "are"}
"""Verb that follows the name of each axis in a sentence."""


@dataclass(frozen=True, slots=True)
class CrewPlan:
    """Plan of a flight that tests the elevator and also the aileron or the rudder."""

    done: tuple[str, ...]
    """Axes with a complete test, ``pitch`` or ``roll and yaw``."""
    open: tuple[str, ...]
    """Axes with an open test, the one farthest from its limit first."""
    next: NextInput | None
    """Next input of the first open axis; None without advice."""

    @property
    def sentence(self) -> str:
        """Sentence about the plan: ``Pitch is complete, roll and yaw are open.``."""
        clauses = [f"{axis} {_IS[axis]} complete" for axis in self.done]
        clauses += [f"{axis} {_IS[axis]} open" for axis in self.open]
        said = ", ".join(clauses)
        return f"{said[0].upper()}{said[1:]}."

    @property
    def advice(self) -> str:
        """Next input as spoken to a pilot; empty without advice."""
        return self.next.advice if self.next is not None else ""

    @property
    def announced(self) -> str:
        """Text of the plan for a ground station; empty until an axis is complete."""
        if not self.done:
            return ""
        return f"TEST COMPLETE: {self.sentence}" if self.is_complete else self.sentence

    @property
    def is_complete(self) -> bool:
        return not self.open


def crew_plan(pitch: FlightTestVerdict, roll_and_yaw: FlightTestVerdict) -> CrewPlan:
    """Return the plan of a flight on which both axes are tested."""
    verdicts = {"pitch": pitch, "roll and yaw": roll_and_yaw}
    going_on = {axis: verdict for axis, verdict in verdicts.items() if verdict.decision != "stop"}
    still = sorted(going_on, key=lambda axis: -_share_of_limit(going_on[axis]))
    return CrewPlan(
        done=tuple(axis for axis in verdicts if axis not in going_on),
        open=tuple(still),
        next=going_on[still[0]].next if still else pitch.next,
    )


def _share_of_limit(verdict: FlightTestVerdict) -> float:
    """Return the criterion over its limit; infinite without a criterion."""
    now = verdict.criterion_percent
    return inf if now is None else now / verdict.limit_percent
