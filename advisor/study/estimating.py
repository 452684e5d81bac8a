"""Many noisy copies of one manoeuvre, each estimated by output error."""

from collections.abc import Callable

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.oem.batch import Batch, solve_many
from advisor.oem.estimate import ChannelFit, Estimate, NoEstimate
from advisor.oem.problem import Problem, Record, Signal
from advisor.oem.solution import solve
from advisor.study.flying import Flight

Advance = Callable[[int], None]
"""Told how many estimates were done since the last call."""


def estimate_copies(
    flight: Flight, noise: FloatArray, copies: int, rng: np.random.Generator
) -> list[Estimate]:
    """Measure a flight ``copies`` times and estimate each measurement on its own.

    Parameters
    ----------
    noise
        Standard deviation of the measurement noise, broadcastable to (n, 2), white and Gaussian.

    Raises
    ------
    ArithmeticError
        A copy could not be estimated.
    """
    z = flight.response + noise * rng.standard_normal((copies, *flight.response.shape))
    elevator = Signal(flight.t, flight.elevator)
    batch = solve_many(elevator, flight.t, z[:, :, 0], z[:, :, 1])
    if batch.failed:
        raise ArithmeticError(f"{batch.failed} of {copies} simulated manoeuvres could not be estimated")
    correlation = _correlation(elevator, flight, z[0])
    return [_estimate(flight, z[i], batch, i, correlation) for i in range(copies)]


def _correlation(elevator: Signal, flight: Flight, z: FloatArray) -> FloatArray:
    """(8, 8) correlation of the errors: a matter of the input, so that one copy speaks for all."""
    outputs = {"alpha": Signal(flight.t, z[:, 0]), "q": Signal(flight.t, z[:, 1])}
    solution = solve(Problem((Record(elevator, outputs),)))
    if isinstance(solution, NoEstimate):
        raise ArithmeticError(f"a simulated manoeuvre could not be estimated: {solution.text}")
    std = np.sqrt(np.diag(solution.covariance_cr))
    return np.asarray(solution.covariance_cr / np.outer(std, std))


def _estimate(flight: Flight, z: FloatArray, batch: Batch, i: int, correlation: FloatArray) -> Estimate:
    """One row as the rules see it; the noise is white, so the plain bound is the covariance."""
    covariance = correlation * np.outer(batch.std_cr[i], batch.std_cr[i])
    fits = {
        # The clean response stands for the fitted one, which differs by less than its error.
        name: ChannelFit(name, flight.t, z[:, k], flight.response[:, k], float(batch.noise[i, k]))
        for k, name in enumerate(("alpha", "q"))
    }
    return Estimate(
        theta=batch.theta[i],
        covariance_cr=covariance,
        covariance=covariance,
        cost=float(batch.cost[i]),
        fits=(fits,),
        iterations=int(batch.iterations[i]),
        not_identifiable={},
        correlated=(),
        condition=float("nan"),
        airspeed_m_s=None,
    )
