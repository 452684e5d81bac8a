"""Alternatives: possible explanations of a flight, each with its evidence and its probability."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Literal

from advisor.gap.decision import Decision
from advisor.process.parts import FailedPart

Kind = Literal["none", "parameters", "effect", "air", "unknown"]
"""Kind of an alternative. ``air`` is an effect of the moving air; ``effect`` is an effect of the aircraft or
of the telemetry."""


@dataclass(frozen=True, slots=True)
class Alternative:
    """One possible explanation of the flight, as the answer of a diagnosis."""

    kind: Kind
    name: str
    """``none``, ``parameters``, ``unknown``, or the name of an effect."""
    block: str = ""
    """Block of the simulator in which the effect acts; empty for ``none`` and ``parameters``."""

    @property
    def is_effect(self) -> bool:
        """Whether the alternative is an effect of the catalogue."""
        return self.name not in ("none", "parameters", "unknown")

    @property
    def label(self) -> str:
        """Name of the alternative, with its block for an effect without a name: ``unknown@input``."""
        return f"{self.name}@{self.block}" if self.kind == "unknown" else self.name


def together(shares: Iterable[tuple[Alternative, float]]) -> list[tuple[Alternative, float]]:
    """Return alternatives with their probabilities, the likeliest first. Alternatives without a name are
    joined into one, whatever their block."""
    added: dict[str, tuple[Alternative, float]] = {}
    for alternative, share in shares:
        first, p = added.get(alternative.name, (alternative, 0.0))
        added[alternative.name] = first, p + share
    return sorted(added.values(), key=lambda answer: -answer[1])


@dataclass(frozen=True, slots=True)
class Column:
    """One part of the log weight of an alternative."""

    name: str
    value: float
    unit: str
    sentence: str


@dataclass(frozen=True, slots=True)
class AlternativeEvidence:
    """Evidence on one alternative: the parts of the log weight of its likeliest model."""

    alternative: Alternative
    columns: tuple[Column, ...]
    probability: float


@dataclass(frozen=True, slots=True)
class Contribution:
    """One part of the log odds between the answer of a diagnosis and its strongest rival."""

    name: str
    """Name of the part of the log weight, or ``rest``."""
    nats: float
    sentence: str


@dataclass(frozen=True, slots=True)
class Probabilities:
    """Probabilities of all alternatives, which sum to 1."""

    none: float = 0.0
    parameters: float = 0.0
    unknown: Mapping[str, float] = field(default_factory=dict)
    """Probability of an effect without a name, by the block's name."""
    effects: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Weighed:
    """The alternatives of a diagnosis with their evidence."""

    evidence: tuple[AlternativeEvidence, ...] = ()
    """The evidence on every alternative, likeliest first; empty for one manoeuvre, which proves no cause."""
    why: tuple[Contribution, ...] = ()
    """Parts of the log odds between the answer and its strongest rival, nats."""
    answer: Alternative | None = None
    """The likeliest alternative; None for a single manoeuvre."""
    rival: str = ""
    """Label of the answer's strongest rival; empty without ``why``."""
    failed: tuple[FailedPart, ...] = ()
    """Effects without an alternative in the evidence, because a numerical fault of the advisor ended their
    model.
    """
    decisions: tuple[Decision, ...] = ()
    """Every statistic that was compared with a limit, in the order of the comparisons."""

    @property
    def probabilities(self) -> Probabilities | None:
        """Probabilities of all alternatives by kind and name; None without evidence."""
        if not self.evidence:
            return None
        each = [(e.alternative, e.probability) for e in self.evidence]
        return Probabilities(
            none=sum(p for a, p in each if a.kind == "none"),
            parameters=sum(p for a, p in each if a.kind == "parameters"),
            unknown={a.block: p for a, p in each if a.kind == "unknown"},
            effects={a.name: p for a, p in each if a.is_effect},
        )
