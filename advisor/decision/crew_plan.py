"""The crew's plan of both axes: which axis is done, which is open, and the input to fly next."""

from dataclasses import dataclass
from math import inf

from advisor.decision.verdict import FlightTestVerdict, NextInput

_IS = {"pitch": "is", "roll and yaw": "are"}
"""Axis to the verb of a sentence about that axis."""


@dataclass(frozen=True, slots=True)
class CrewPlan:
    """One plan of a flight on which the elevator and the aileron or the rudder are tested."""

    done: tuple[str, ...]
    """Axes whose test is complete, ``pitch`` or ``roll and yaw``."""
    open: tuple[str, ...]
    """Other axes, the axis farthest from its limit first."""
    next: NextInput | None
    """Input of the first open axis, which brings most to what is open; None where no input is advised."""

    @property
    def sentence(self) -> str:
        """The plan in one sentence: ``Pitch is complete, roll and yaw are open.``."""
        told = [f"{axis} {_IS[axis]} complete" for axis in self.done]
        told += [f"{axis} {_IS[axis]} open" for axis in self.open]
        said = ", ".join(told)
        return f"{said[0].upper()}{said[1:]}."

    @property
    def advice(self) -> str:
        """The next input as a pilot hears it; empty where no input is advised."""
        return self.next.advice if self.next is not None else ""

    @property
    def announced(self) -> str:
        """The plan as a ground station hears it; empty while no axis is complete."""
        if not self.done:
            return ""
        return f"TEST COMPLETE: {self.sentence}" if self.is_complete else self.sentence

    @property
    def is_complete(self) -> bool:
        """Whether no axis is open."""
        return not self.open


def crew_plan(pitch: FlightTestVerdict, roll_and_yaw: FlightTestVerdict) -> CrewPlan:
    """Return the plan of a flight on which both axes are tested."""
    verdicts = {"pitch": pitch, "roll and yaw": roll_and_yaw}
    going_on = {axis: one for axis, one in verdicts.items() if one.decision != "stop"}
    still = sorted(going_on, key=lambda axis: -_share_of_limit(going_on[axis]))
    return CrewPlan(
        done=tuple(axis for axis in verdicts if axis not in going_on),
        open=tuple(still),
        next=going_on[still[0]].next if still else pitch.next,
    )


def _share_of_limit(verdict: FlightTestVerdict) -> float:
    """Return the criterion over its limit; infinite where nothing is known."""
    now = verdict.criterion_percent
    return inf if now is None else now / verdict.limit_percent
