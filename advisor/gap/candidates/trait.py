"""What the table of effects says of each effect beside the numbers that a fit frees."""

from collections.abc import Mapping
from dataclasses import dataclass, field

Said = str | tuple[str, str]
"""How an effect is put. Of two ways the second is for a first number below zero, sizes without their sign.
Sizes are written as ``{parameter:.0f}``; ``_ms``, ``_deg``, ``_percent``, ``_power`` may follow a name."""


@dataclass(frozen=True, slots=True)
class Need:
    """Why an effect cannot be seen, and what would change that."""

    parameter: str
    """Its size, as the aircraft file spells it."""
    because: str
    add: str


@dataclass(frozen=True, slots=True)
class Trait:
    """An effect of the catalogue, without its numbers."""

    block: str
    """Part of the simulator that it belongs to."""
    said: Said = ""
    said_with: Mapping[str, Said] = field(default_factory=dict)
    """The same by a parameter that makes it a particular one ..."""
    said_beyond: Said = ""
    """... and where the simulator has some of it already; empty: no different."""
    channel: str = ""
    """Output without which it cannot be tried; empty where any will do."""
    stated: tuple[str, str] | None = None
    """Section and key of the aircraft file that state how much of it the simulator has."""
    of_one_flight: bool = False
    """Came at some time of one flight, and says nothing of another."""
    by_nature: bool = False
    """What every aircraft has to some degree, or what takes its shape: faint, it is no finding."""
    of_one_imu: bool = False
    """Goes with an angle of attack that an autopilot makes of its own pitch rate and accelerations, which
    cannot show it; or is the nature of one."""
    of_the_stick: bool = True
    """The elevator alone can show it; else something else must vary."""
    takes: bool = False
    """Its size is what it takes away: more of it is none."""
    left_open: bool = False
    """Something to measure rather, where the aircraft file does not state it: it comes last."""
    need: Need | None = None
    """What it takes to be seen, where its channel or its cause may be missing ..."""
    unrecorded: tuple[str, str, str] | None = None
    """... and the slow channel that tells of it, with what to say where that was not recorded."""
    imitated_by: tuple[str, str] | None = None
    """What is no effect and looks the same, and what tells the two apart ..."""
    imitated_without: tuple[str, str, str] | None = None
    """... and the same where an output is missing, which comes first."""
    distinguished_by: Mapping[str, str] = field(default_factory=dict)
    """Effects further down the table that look alike: what tells each of them apart."""
    twin: str = ""
    """The one of them that differs by a rest only."""
