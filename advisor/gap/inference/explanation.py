"""One explanation of a flight: a full model with its evidence; and the row that it makes."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Generic, Self, TypeVar

import numpy as np

from advisor.gap.alternative import Alternative
from advisor.gap.inference.model_error import form_error


@dataclass(frozen=True)
class Evidence:
    """Log marginal likelihood of one explanation, nats."""

    right: float
    """With all of the file's derivatives right."""
    wrong: float
    """With some of them wrong."""

    @property
    def either(self) -> float:
        """Log marginal likelihood where both cases are alike likely before the flight."""
        return float(np.logaddexp(self.right, self.wrong) - np.log(2.0))

    def more(self, nats: float) -> "Evidence":
        """Return the evidence with ``nats`` added in both cases."""
        return Evidence(self.right + nats, self.wrong + nats)


@dataclass(frozen=True, kw_only=True)
class Explanation:
    """A model of the flight with at most one effect more than the model of the stage; an axis adds its
    fit."""

    alternative: Alternative | None
    """The answer that the added effect is; None for derivatives alone."""
    name: str = ""
    """Name of the added effect or law."""
    numbers: tuple[str, ...] = ()
    """Names of its numbers."""
    evidence: Evidence
    natural: Evidence
    """Evidence with as little of the effect as every aircraft has."""
    likelihood: float
    """Log likelihood over the temperature, nats: the part of the evidence that the fit makes."""
    unseen: float = 0.0
    """Part of the evidence, at most 0, by which the effect gains less on unseen manoeuvres than in the
    fit."""
    change: float = 0.0
    """Change of the outputs by the effect, all else refitted, as a share of the peaks."""
    model_error: float = 0.0
    """Part of the evidence that the error of every simulator makes up for."""

    @property
    def solution(self) -> object:
        """The fit, which explanations in still and in moving air share."""
        return self

    @property
    def form_error(self) -> float:
        """Error of the outputs by the form of the effect, as a share of the peaks."""
        return form_error(self.numbers, self.change)

    def more(self, nats: float) -> Self:
        """Return the explanation with so much more evidence."""
        return replace(self, evidence=self.evidence.more(nats), natural=self.natural.more(nats))

    def lifted(self, nats: float) -> Self:
        """Return the explanation with evidence for the error of every simulator."""
        return replace(self.more(nats), model_error=nats)


E = TypeVar("E", bound=Explanation)


@dataclass(frozen=True)
class Row(Generic[E]):
    """One way in which an alternative may be true, with the parts of its log weight."""

    alternative: Alternative
    explanation: E
    terms: Mapping[str, float]
    """Parts of the log weight by name, nats."""
    pair: E | None = None
    """Model with a second effect in addition."""
    in_moving_air: bool = False
    """Whether the air moves more than it always does."""

    @property
    def model(self) -> E:
        """Whole model of the way."""
        return self.pair or self.explanation

    @property
    def weight(self) -> float:
        """Log of prior times marginal likelihood, nats, up to a constant of the flight."""
        return float(sum(self.terms.values()))
