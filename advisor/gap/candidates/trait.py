"""Properties of an effect in the table of effects, apart from its parameters in a fit."""

from collections.abc import Mapping
from dataclasses import dataclass, field

Said = str | tuple[str, str]
"""Sentence about an effect. A second sentence holds for a negative first parameter, and shows sizes
without sign. Sizes are written as ``{parameter:.0f}``; ``_ms``, ``_deg``, ``_percent``, ``_power`` may
follow a name."""


@dataclass(frozen=True, slots=True)
class Need:
    """Why an effect cannot be seen, and what would make it visible."""

    parameter: str
    """The effect's first parameter, in the spelling of the aircraft file."""
    because: str
    add: str


@dataclass(frozen=True, slots=True)
class Trait:
    """An effect of the catalogue, without its parameters."""

    block: str
    """Block of the simulator that the effect belongs to."""
    said: Said = ""
    said_or: str = ""
    """Words for the effect as the second of two that look alike; empty: it is only listed."""
    said_with: Mapping[str, Said] = field(default_factory=dict)
    """Sentence by a parameter that only some variants of the effect have."""
    said_beyond: Said = ""
    """Sentence where the simulator has some of the effect already; empty: ``said`` serves."""
    channel: str = ""
    """Output without which the effect cannot be tried; empty where any will do."""
    stated: tuple[str, str] | None = None
    """Section and key of the aircraft file that state the effect's size in the simulator."""
    of_one_flight: bool = False
    """Whether the effect belongs to one flight and says nothing about another."""
    by_nature: bool = False
    """Whether every aircraft has some of the effect, or an effect of similar shape: a small amount is no
    finding."""
    of_one_imu: bool = False
    """Whether an α that an autopilot computes from its own pitch rate and accelerations cannot show the
    effect."""
    of_the_stick: bool = True
    """Whether the elevator alone can show the effect; if not, another input must vary."""
    takes: bool = False
    """Whether the size states a loss: a gain of the same size is no such effect."""
    left_open: bool = False
    """Whether the effect is a position to be measured. Where the aircraft file does not state it, it is named
    last."""
    need: Need | None = None
    """Requirement for seeing the effect, where its channel or its cause may be missing."""
    unrecorded: tuple[str, str, str] | None = None
    """Slow channel that shows the effect, and reason and remedy where that channel was not recorded."""
    imitated_by: tuple[str, str] | None = None
    """Cause outside the catalogue that looks the same, and what distinguishes the two."""
    imitated_without: tuple[str, str, str] | None = None
    """Output, cause that looks the same where that output is missing, and what distinguishes the two."""
    distinguished_by: Mapping[str, str] = field(default_factory=dict)
    """Effects further down the table that look alike, each with what distinguishes it."""
    twin: str = ""
    """The one of these effects that differs by a small rest only."""
