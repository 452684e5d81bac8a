"""Roles, travels and directions of servo outputs, from an autopilot's parameters."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from advisor.flight.vehicle.limits import assumed_limits
from advisor.flight.vehicle.mixers import Role
from advisor.flight.vehicle.surfaces import Scale
from advisor.words.problems import Problem

Parameters = Mapping[str, float]
"""Name to the value of each of the vehicle's parameters."""


@dataclass(frozen=True, slots=True)
class Words:
    """Names of the outputs' parameters for the users of an autopilot."""

    function: str
    """Parameter of the surface that an output moves."""
    elevator: str
    """Setting that makes an output the elevator."""
    limits: str
    """Parameters of the pulses at full travel."""
    trim: str
    """Parameter of the pulse at zero deflection."""
    sense: str
    """Parameter of an output's direction; ``{n}`` stands for its number."""
    unknown: str
    """Sentence with the reason for which no output is the elevator."""
    usual: str
    """Usual place of the elevator."""


@dataclass(frozen=True, slots=True)
class Wiring:
    """Known roles, scales and directions of the servo outputs."""

    words: Words
    roles: Mapping[int, Role] = field(default_factory=dict)
    """Output number, from 1, to its role where known. Outputs that move no surface have a role without a
    name."""
    scales: Mapping[int, Scale] = field(default_factory=dict)
    known_directions: frozenset[int] = frozenset()
    """Outputs whose direction the parameters give."""
    assumed: str = ""
    """Sentence on guesses among the roles."""
    doubts: Mapping[int, Problem] = field(default_factory=dict)
    """Output number to the problem of its limits, where some of them are assumed."""
    passed: Mapping[int, int] = field(default_factory=dict)
    """Output number to the radio channel that it passes through without a mixer."""

    def scale(self, n: int) -> Scale:
        """Return the scale of output ``n``, with ArduPilot's defaults for unknown parameters."""
        return self.scales.get(n, Scale())

    def doubt(self, n: int) -> Problem | None:
        """Return the problem of the assumed limits of output ``n``; None where parameters state them."""
        if n in self.scales:
            return self.doubts.get(n)
        return assumed_limits(n, self.scale(n))
