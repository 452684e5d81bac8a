"""An effect of the catalogue: everything that the program knows about it, in one object.

Each module of ``advisor.gap.effects`` makes one such object. The search, the aircraft file, the sentences,
the pages, the user's simulator and the exports read what they need from it.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

from advisor.gap.kit.curve import Curve
from advisor.gap.kit.variant import Variant
from advisor.gap.records.flights import PreparedManeuvers

Said = str | tuple[str, str]
"""Sentence about an effect. A second sentence holds for a negative first parameter, and shows sizes
without sign. Sizes are written as ``{parameter:.0f}``; ``_ms``, ``_deg``, ``_percent``, ``_power`` may
follow a name."""
BLOCKS = (
    "input", "moment_equation", "force_equation", "air", "alpha_sensor", "pitch_rate_sensor", "accelerometer",
    "timing",
)  # fmt: skip
"""Blocks of a simulator that effects belong to, in their order on every page."""
ANY = float("-inf")
"""Least allowed value of a parameter that may have any."""


@dataclass(frozen=True, slots=True)
class Need:
    """Why an effect cannot be seen, and what would make it visible."""

    parameter: str
    """The effect's first parameter, in the spelling of the aircraft file."""
    because: str
    add: str


@dataclass(frozen=True, kw_only=True, slots=True)
class Effect:
    """An effect of the catalogue."""

    name: str
    """Name, which is also that of the effect's module."""
    block: str
    """Block of the simulator that the effect belongs to, of ``BLOCKS``."""
    keys: Mapping[str, float]
    """Parameters in the aircraft file, each with its least allowed value."""
    variants: Callable[[PreparedManeuvers], Sequence[Variant]]
    """Function that returns the effect's descriptions in a fit: parameters, bounds, priors, least sizes, and
    the terms of Eqs. (1)-(2) that they change. None where the effect is judged outside the fits."""
    said: Said
    said_with: Mapping[str, Said] = field(default_factory=dict)
    """Sentence by a parameter that only some variants of the effect have."""
    said_or: str = ""
    """Words for the effect as the second of two that look alike; empty: it is only listed."""
    said_beyond: Said = ""
    """Sentence where the simulator has some of the effect already; empty: ``said`` serves."""
    channel: str = ""
    """Output without which the effect cannot be tried; empty where any will do."""
    stated: tuple[str, str] | None = None
    """Section and key of the aircraft file that state the effect's size in the simulator."""
    outside_fits: Callable[[PreparedManeuvers], bool] | None = None
    """Function that returns whether flights let it be judged outside the fits; None for other effects."""
    of_one_flight: bool = False
    """Whether the effect belongs to one flight and says nothing about another."""
    of_one_imu: bool = False
    """Whether an α that an autopilot computes from its own rates and accelerations cannot show the effect."""
    of_the_stick: bool = True
    """Whether the elevator alone can show the effect; if not, another input must vary."""
    need: Need | None = None
    """Requirement for seeing the effect, where its channel or its cause may be missing."""
    unrecorded: tuple[str, str, str] | None = None
    """Slow channel that shows the effect, and reason and remedy where that channel was not recorded."""
    without_speed: tuple[str, str] | None = None
    """Reason and remedy where the air speed reads next to nothing."""
    imitated_by: tuple[str, str] | None = None
    """Cause outside the catalogue that looks the same, and what distinguishes the two."""
    imitated_without: tuple[str, str, str] | None = None
    """Output, cause that looks the same where that output is missing, and what distinguishes the two."""
    distinguished_by: Mapping[str, str] = field(default_factory=dict)
    """Effects that look alike, each with what distinguishes it; stated by one of the two."""
    curve: Curve | None = None
    """Form in an export of force and moment; None where no format carries the effect there."""
    servo: Mapping[str, tuple[str, float]] = field(default_factory=dict)
    """Form in an export of the servo: parameter to the field of ``ExportedServo`` it adds to, and factor."""


def without_sizes(said: Said, size: str) -> tuple[str, ...]:
    """Return the sentences with ``size`` in place of every number."""
    both = (said,) if isinstance(said, str) else said
    return tuple(re.sub(r"\{\w+:[^}]*\}", size, text) for text in both)


def always(*variants: Variant) -> Callable[[PreparedManeuvers], Sequence[Variant]]:
    """Return a function that returns these descriptions for any flights."""
    return partial(_given, variants)


def _given(variants: Sequence[Variant], _: PreparedManeuvers) -> Sequence[Variant]:
    return variants


def not_fitted(_: PreparedManeuvers) -> Sequence[Variant]:
    """Return no description: the effect is judged outside the fits."""
    return ()
