"""One explanation of a flight: a full model with its fit and its evidence; and the row that it makes."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.alternative import Alternative
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.holdout import HeldOut, hold_out, mean_squares
from advisor.gap.fitting.problem import EffectProblem, counts
from advisor.gap.inference.evidence import Evidence, FlightProblem, evidence_of, log_likelihood
from advisor.gap.inference.model_error import form_error
from advisor.gap.inference.sizes import natural_share
from advisor.gap.kit.variant import Variant

_SYMMETRIC = float(np.log(2.0))
"""Log prior gain, nats, of a number that cannot be negative: its Gaussian prior has half the range."""


@dataclass(frozen=True)
class Explanation:
    """A model of the flight with at most one effect more than the model of the stage."""

    variant: Variant | None
    """Effect or law that is added; None for derivatives alone."""
    problem: FlightProblem
    """The flight with the tolerance of the derivatives under which the model was fitted."""
    fitted: EffectFit
    held_out: HeldOut
    evidence: Evidence
    natural: Evidence
    """Evidence with as little of the effect as every aircraft has."""
    likelihood: float
    """Log likelihood over the temperature, nats: the part of the evidence that the fit makes."""
    unseen: float
    """Part of the evidence, at most 0, by which the effect gains less on unseen manoeuvres than in the
    fit."""
    change: float
    """Change of the outputs by the effect, all else refitted, as a share of the peaks."""
    model_error: float = 0.0
    """Part of the evidence that the error of every simulator makes up for."""

    @property
    def name(self) -> str:
        """Name of the effect or law; empty for derivatives alone."""
        return "" if self.variant is None else self.variant.effect

    @property
    def values(self) -> FloatArray:
        """Numbers of the added effect, shape (numbers,); empty for derivatives alone."""
        return np.zeros(0) if self.variant is None else np.asarray(self.fitted.point.values[-1])

    @property
    def form_error(self) -> float:
        """Error of the outputs by the form of the effect, as a share of the peaks."""
        return form_error(() if self.variant is None else self.variant.names, self.change)

    def lifted(self, nats: float) -> "Explanation":
        """Return the explanation with evidence for the error of every simulator."""
        more = self.evidence.more(nats), self.natural.more(nats)
        return replace(self, evidence=more[0], natural=more[1], model_error=nats)


@dataclass(frozen=True)
class Row:
    """One way in which an alternative may be true, with the parts of its log weight."""

    alternative: Alternative
    explanation: Explanation
    terms: Mapping[str, float]
    """Parts of the log weight by name, nats."""
    pair: Explanation | None = None
    """Model with a second effect in addition."""

    @property
    def model(self) -> Explanation:
        """Whole model of the way."""
        return self.pair or self.explanation

    @property
    def weight(self) -> float:
        """Log of prior times marginal likelihood, nats, up to a constant of the flight."""
        return float(sum(self.terms.values()))


def explained(
    problem: FlightProblem, variant: Variant | None, made: EffectFit, plain: EffectFit, heat: float
) -> Explanation:
    """Return an explanation with its evidence, which unseen manoeuvres may cut.

    Parameters
    ----------
    plain
        Fit of the model without the effect.
    heat
        Temperature of the flight (``evidence.temperature``).
    """
    extra, unseen = 0.0, 0.0
    held = hold_out(problem, made)
    if variant is not None:
        low, high = variant.bounds[0]
        extra += _SYMMETRIC if low >= 0.0 or high <= 0.0 else 0.0
        if variant.sides is not None:
            extra -= 0.5 * len(problem.flights) * float(np.log(len(variant.sides[1])))
        if "at_s" in variant.fixed:
            extra -= float(np.log(max(len(problem.flights) - 1, 1)))
        if not variant.needs:
            unseen = _lost_unseen(problem, plain, made, held) / heat
    told = evidence_of(problem, made, heat).more(extra + unseen)
    natural = (
        told
        if variant is None
        else evidence_of(problem, made, heat, natural_share(variant)).more(extra + unseen)
    )
    return Explanation(
        variant, problem, made, held, told, natural,
        log_likelihood(problem, made) / heat, unseen, change_of(problem, plain, made),
    )  # fmt: skip


def change_of(problem: EffectProblem, one: EffectFit, other: EffectFit) -> float:
    """Return the largest difference between two models, as a share of each telling channel's peak."""
    squares = mean_squares(problem, [a - b for a, b in zip(one.residuals, other.residuals, strict=True)])
    share = np.sqrt(np.mean(squares, axis=0)) / problem.flights.peaks
    return float(np.max(share[problem.flights.telling]))


def _lost_unseen(problem: EffectProblem, plain: EffectFit, made: EffectFit, held: HeldOut) -> float:
    """Return by how much less an effect gains on manoeuvres held out than in the fit, nats; at most 0."""
    n = counts(problem)
    in_fit = float(np.sum(n * np.log(plain.noise / made.noise)))
    was, now = (np.maximum(h.innovation_square, 1e-12) for h in (hold_out(problem, plain), held))
    return min(0.0, float(np.sum(0.5 * n * np.log(was / now))) - in_fit)
