"""An effect of the catalogue: all that the program states about an effect, in one object.

Each module of ``advisor.gap.effects`` makes one ``Effect``. The search, the aircraft file, the sentences, the
pages, the user's simulator and the exports read that object.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

from advisor.gap.kit.curve import Curve
from advisor.gap.kit.variant import Variant
from advisor.gap.records.flights import PreparedManeuvers

Said = str | tuple[str, str]
"""Sentence about an effect, with its sizes. A second sentence is used for a negative first parameter, and
shows sizes without sign. Sizes are written as ``{parameter:.0f}``; the suffix ``_ms``, ``_deg``, ``_percent``
or ``_power`` sets the unit."""
BLOCKS = (
    "input", "moment_equation", "force_equation", "air", "alpha_sensor", "pitch_rate_sensor", "accelerometer",
    "timing",
)  # fmt: skip
"""Blocks of a simulator that effects belong to, in their order on every page."""
ANY = float("-inf")
"""Least allowed value of a parameter that may have any value."""


@dataclass(frozen=True, slots=True)
class Need:
    """Reason why an effect cannot be detected, and the measurement that would detect it."""

    because: str
    add: str


@dataclass(frozen=True, kw_only=True, slots=True)
class Effect:
    """An effect of the catalogue."""

    name: str
    """Name of the effect, and of its module."""
    block: str
    """Block of the simulator that the effect belongs to, of ``BLOCKS``."""
    keys: Mapping[str, float]
    """Least allowed value of each parameter in the aircraft file."""
    variants: Callable[[PreparedManeuvers], Sequence[Variant]]
    """Function that returns the effect's variants in a fit, with parameters, bounds and priors. The function
    returns no variant if the effect is judged outside the fits."""
    said: Said
    said_with: Mapping[str, Said] = field(default_factory=dict)
    """Sentence for each parameter that only some variants of the effect have."""
    said_or: str = ""
    """Words for the effect as an alternative to a similar effect; empty if it is only listed."""
    said_beyond: Said = ""
    """Sentence if the simulator already has some of the effect; empty if ``said`` is used."""
    channel: str = ""
    """Output without which the effect cannot be tried; empty if any output suffices."""
    stated: tuple[str, str] | None = None
    """Section and key of the aircraft file that state the effect's size in the simulator."""
    outside_fits: Callable[[PreparedManeuvers], bool] | None = None
    """Function that returns whether the effect can be judged outside the fits; None for other effects."""
    of_one_flight: bool = False
    """Whether the effect belongs to one flight and does not occur in another."""
    of_one_imu: bool = False
    """Whether an α that an autopilot computes from its own rates and accelerations cannot show the effect."""
    of_the_stick: bool = True
    """Whether the elevator alone can show the effect; otherwise another input must vary."""
    need: Need | None = None
    """Requirement for the detection of the effect, if its channel or its cause may be missing."""
    unrecorded: tuple[str, str, str] | None = None
    """Slow channel that shows the effect, with the reason and the remedy if it was not recorded."""
    without_speed: tuple[str, str] | None = None
    """Reason and remedy if the air speed sensor reads almost nothing."""
    imitated_by: tuple[str, str] | None = None
    """Cause outside the catalogue that looks like the effect, and the measurement that distinguishes both."""
    imitated_without: tuple[str, str, str] | None = None
    """Output, cause that looks like the effect without that output, and the measurement that distinguishes
    both."""
    distinguished_by: Mapping[str, str] = field(default_factory=dict)
    """Measurement that distinguishes the effect from a similar one, by the similar effect's name."""
    curve: Curve | None = None
    """Form of the effect in an export of force and moment; None where no format supports it."""
    servo: Mapping[str, tuple[str, float]] = field(default_factory=dict)
    """Field of ``ExportedServo`` to which each parameter adds in an export of the servo, and the factor."""


def without_sizes(said: Said, size: str) -> tuple[str, ...]:
    """Return the sentences with ``size`` in place of every number."""
    both = (said,) if isinstance(said, str) else said
    return tuple(re.sub(r"\{\w+:[^}]*\}", size, text) for text in both)


def always(*variants: Variant) -> Callable[[PreparedManeuvers], Sequence[Variant]]:
    """Return a function that returns ``variants`` for any flights."""
    return partial(_given, variants)


def _given(variants: Sequence[Variant], _: PreparedManeuvers) -> Sequence[Variant]:
    return variants


def not_fitted(_: PreparedManeuvers) -> Sequence[Variant]:
    """Return no variant, because the effect is judged outside the fits."""
    return ()
