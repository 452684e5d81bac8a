"""Alternatives: what may explain a flight, each with its evidence and its probability."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

Kind = Literal["none", "parameters", "effect", "air", "unknown"]
"""Kind of an alternative. ``air`` is an effect of the air, ``effect`` one of the aircraft or its
telemetry."""
KINDS: tuple[Kind, ...] = ("none", "parameters", "effect", "air", "unknown")


@dataclass(frozen=True, slots=True)
class Alternative:
    """One answer that a diagnosis may give."""

    kind: Kind
    name: str
    """``none``, ``parameters``, ``unknown``, or the name of an effect."""
    block: str = ""
    """Block of the simulator; empty for ``none`` and ``parameters``."""
    second: str = ""
    """Second effect of a set, whose main effect is ``name``; empty for a single answer."""

    @property
    def is_effect(self) -> bool:
        """Whether the alternative is an effect of the catalogue."""
        return self.name not in ("none", "parameters", "unknown")

    @property
    def first(self) -> "Alternative":
        """The first cause: the main effect of a set, and any other alternative itself."""
        return replace(self, second="")

    @property
    def label(self) -> str:
        """The names, with the block where the name alone does not say it: ``unknown@input``, ``a + b``."""
        if self.kind == "unknown":
            return f"{self.name}@{self.block}"
        return f"{self.name} + {self.second}" if self.second else self.name


@dataclass(frozen=True, slots=True)
class Column:
    """One measured quantity of an alternative."""

    name: str
    value: float
    unit: str
    sentence: str


@dataclass(frozen=True, slots=True)
class AlternativeEvidence:
    """The evidence on one alternative: every alternative has the same columns."""

    alternative: Alternative
    columns: tuple[Column, ...]
    probability: float

    def value(self, name: str) -> float:
        """Return the value of a column."""
        return next(column.value for column in self.columns if column.name == name)


@dataclass(frozen=True, slots=True)
class Contribution:
    """One part of the log odds of the answer against its strongest rival."""

    name: str
    """Column, ``prior``, or ``rest``."""
    nats: float
    sentence: str


@dataclass(frozen=True, slots=True)
class Probabilities:
    """Probabilities of all alternatives, which sum to 1."""

    none: float = 0.0
    parameters: float = 0.0
    unknown: Mapping[str, float] = field(default_factory=dict)
    """Probability of an effect without a name, by block."""
    effects: Mapping[str, float] = field(default_factory=dict)
