"""One explanation of a flight: a full model with its evidence, and its row in the posterior."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Generic, Self, TypeVar

import numpy as np

from advisor.gap.alternative import Alternative


@dataclass(frozen=True)
class Evidence:
    """Log marginal likelihood of one explanation, nats."""

    right: float
    """Log evidence if all derivatives of the aircraft file are right."""
    wrong: float
    """Log evidence if some derivatives of the aircraft file are wrong."""

    @property
    def either(self) -> float:
        """Log evidence if right and wrong derivatives have equal prior probability."""
        return float(np.logaddexp(self.right, self.wrong) - np.log(2.0))

    def more(self, nats: float) -> "Evidence":
        """Return the evidence with ``nats`` added in both cases."""
        return Evidence(self.right + nats, self.wrong + nats)


@dataclass(frozen=True, kw_only=True)
class Explanation:
    """A model of the flight with at most one effect more than the stage's model."""

    alternative: Alternative | None
    """Alternative that the added effect stands for; None for derivatives alone."""
    name: str = ""
    """Name of the added effect or law."""
    numbers: tuple[str, ...] = ()
    """Names of the effect's parameters."""
    evidence: Evidence
    natural: Evidence
    """Evidence with the effect at the small size that every aircraft has."""
    likelihood: float
    """Log likelihood of the fit over the temperature, nats."""
    unseen: float = 0.0
    """Loss of evidence, at most 0, because the effect gains less on held-out manoeuvres than in the fit."""
    change: float = 0.0
    """Change of the outputs by the effect after a refit of all other parameters, as a share of the peaks."""
    chance: float = 1.0
    """Prior: probability that the simulator as given has the effect that the model takes out of it."""
    model_error: float = 0.0
    """Part of the evidence that allows for the error of every simulator, nats."""

    @property
    def form_error(self) -> float:
        """Error of the outputs due to the effect's simplified form, as a share of the peaks."""
        return form_error(self.numbers, self.change)

    def more(self, nats: float) -> Self:
        """Return the explanation with ``nats`` more evidence."""
        return replace(self, evidence=self.evidence.more(nats), natural=self.natural.more(nats))

    def lifted(self, nats: float) -> Self:
        """Return the explanation with ``nats`` more evidence for the error of every simulator."""
        return replace(self.more(nats), model_error=nats)


E = TypeVar("E", bound=Explanation)


@dataclass(frozen=True)
class Row(Generic[E]):
    """One model of an alternative, with the parts of its log weight."""

    alternative: Alternative
    explanation: E
    terms: Mapping[str, float]
    """Parts of the model's log weight by name, nats."""
    pair: E | None = None
    """Model with a second effect in addition; None for a single effect."""
    in_moving_air: bool = False
    """Whether the air moves more than in every natural flight."""

    @property
    def model(self) -> E:
        """Full model of the row."""
        return self.pair or self.explanation

    @property
    def weight(self) -> float:
        """Log of prior probability times marginal likelihood, nats, up to a constant."""
        return float(sum(self.terms.values()))


_MODEL = 0.005
"""Prior: error of every simulator's outputs, as a share of each output's peak."""
_FORM, _PLAY = 0.03, 0.1
"""Prior: error of an effect's form as a share of its change, in general, and for play, dead bands and
friction."""
_INDEPENDENT = 40.0
"""Prior: number of independent values in the error of a simulator."""


def form_error(names: Sequence[str], change: float) -> float:
    """Return the error of the outputs due to an effect's simplified form, as a share of the peaks."""
    return change * (_PLAY if "half_width_rad" in names else _FORM)


def most_nats(apart: float, *forms: float) -> float:
    """Return the largest log likelihood difference, nats, that two models can have.

    Parameters
    ----------
    apart
        Difference between the outputs of both models, as a share of the peaks.
    """
    error = float(np.linalg.norm((_MODEL, *forms)))
    return 0.5 * _INDEPENDENT * (apart / error) ** 2


def least_apart(nats: float) -> float:
    """Return the least difference between two models' outputs, as a share of the peaks, that may differ by
    ``nats``."""
    return float(_MODEL * np.sqrt(2.0 * nats / _INDEPENDENT))
