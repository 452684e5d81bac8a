"""Servo lag and delay of the command in a quick estimate: one Gauss-Newton step, and errors with both free.

An estimate in flight solves the model with the lag and the delay that are known so far. Their priors and the
samples tell how far both may be off. The joint step of derivatives and instruments moves the estimate, and
the joint covariance widens it.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS
from advisor.flight.signals.messages import FloatArray
from advisor.oem.estimate import Estimate
from advisor.oem.extra import Prior
from advisor.oem.instrument_fit import share_of, weighed
from advisor.oem.instruments import OF_ALPHA, Instrument, extra_of, unknown_instruments
from advisor.oem.solution import Solution, evaluate

N = len(PARAMETERS)


@dataclass(frozen=True, slots=True)
class Doubt:
    """Doubt that unknown instruments of the command add to an estimate that takes them as known."""

    step: FloatArray
    """(8,) step of the derivatives."""
    covariance: FloatArray
    """(8, 8) addition to the covariance."""
    covariance_cr: FloatArray
    """(8, 8) addition to the Cramér-Rao bound."""

    @classmethod
    def about(cls, solution: Solution, aircraft: Aircraft) -> "Doubt":
        """Return the doubt about a solution; none where the samples do not bear the instruments."""
        share = share_of(solution)
        names = [weighed(x, share) for x in _with_priors(solution, aircraft)]
        optimum = solution.optimum
        extra = extra_of(solution.problem, solution.assembly, optimum.shared, optimum.local, names)
        joint = evaluate(solution.problem, solution.assembly, optimum, extra)
        if not isinstance(joint, Solution):
            return cls(np.zeros(N), np.zeros((N, N)), np.zeros((N, N)))
        step = joint.influence.step(solution.residual, extra)[:N]
        wider = joint.covariance[:N, :N] - solution.covariance[:N, :N]
        return cls(step, wider, joint.covariance_cr[:N, :N] - solution.covariance_cr[:N, :N])

    def on(self, estimate: Estimate) -> Estimate:
        """Return an estimate with the doubt, of the solution or of one that follows it closely."""
        return replace(
            estimate,
            theta=estimate.theta + self.step,
            covariance=estimate.covariance + self.covariance,
            covariance_cr=estimate.covariance_cr + self.covariance_cr,
        )


def _with_priors(solution: Solution, aircraft: Aircraft) -> Iterator[Instrument]:
    """Yield the instruments of the command that have a prior or a statement with a width."""
    for x in unknown_instruments(solution.problem, aircraft):
        width = x.known_to * abs(x.stated or 0.0)
        if x.name not in OF_ALPHA and (x.prior is not None or width > 0.0):
            yield x if x.prior is not None else replace(x, prior=Prior(x.read(solution.problem), width))
