"""What an autopilot's parameters say of its servo outputs: what each moves, and how far and which way."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from advisor.flight.surfaces import Part, Scale, Surface, in_shares

Parameters = Mapping[str, float]
"""PARAM_VALUEs of the vehicle by name."""


@dataclass(frozen=True, slots=True)
class Role:
    """What an output moves."""

    surface: str
    """``elevator``, ``aileron``, ``rudder``, or a mixed pair: ``elevon``, ``V-tail``, ``A-tail``,
    ``differential spoiler``."""
    side: Literal["", "left", "right"] = ""
    """Which half of a mixed pair; empty for a plain surface."""


ELEVATOR, AILERON, RUDDER = Role("elevator"), Role("aileron"), Role("rudder")


@dataclass(frozen=True, slots=True)
class Words:
    """What the users of an autopilot call the parameters of its outputs."""

    function: str
    """What an output moves."""
    elevator: str
    """What makes an output the elevator."""
    limits: str
    """Pulses of the full strokes."""
    trim: str
    """Pulse of no deflection."""
    sense: str
    """Which way an output moves; ``{n}`` stands for its number."""
    unknown: str
    """Why no output is the elevator: a sentence."""
    usual: str
    """Where the elevator usually is."""


@dataclass(frozen=True, slots=True)
class Wiring:
    """The outputs, as far as they are known."""

    words: Words
    roles: Mapping[int, Role] = field(default_factory=dict)
    """Outputs 1.. whose function is known; those that move no surface have a role without a name."""
    scales: Mapping[int, Scale] = field(default_factory=dict)
    told: frozenset[int] = frozenset()
    """Outputs of which the parameters say which way they move."""
    assumed: str = ""
    """What of the roles is a guess, in a sentence."""

    def scale(self, n: int) -> Scale:
        """Return the scale of output ``n``; where no parameter tells, that of ArduPilot's defaults."""
        return self.scales.get(n, Scale())

    def outputs_of(self, role: Role) -> list[int]:
        """Return outputs that have this role, rising."""
        return sorted(n for n, mine in self.roles.items() if mine == role)

    def surface(self, role: Role) -> Surface | None:
        """Return the surface of the outputs with this role; None when no parameter says, or in two banks."""
        outputs = self.outputs_of(role)
        surface = Surface(in_shares([Part(n, self.scale(n)) for n in outputs]), False, "")
        return surface if len(surface.ports) == 1 else None
