"""Estimates by output error from many noisy copies of one manoeuvre."""

import numpy as np

from advisor.bundled.study.flying import NoiselessManeuver
from advisor.decision.foresight import Instruments, expect
from advisor.flight.signals.messages import FloatArray
from advisor.oem.batch import Batch, solve_many
from advisor.oem.estimate import ChannelFit, Estimate
from advisor.oem.rows import Signal
from advisor.oem.surface import Servo


def estimate_copies(
    flight: NoiselessManeuver, noise: FloatArray, copies: int, rng: np.random.Generator
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
    batch = solve_many(Signal(flight.t, flight.elevator), flight.t, z[:, :, 0], z[:, :, 1])
    if batch.failed:
        raise ArithmeticError(f"{batch.failed} of {copies} simulated manoeuvres could not be estimated")
    correlation = _correlation(flight, batch)
    return [_estimate(flight, z[i], batch, i, correlation) for i in range(copies)]


def _correlation(flight: NoiselessManeuver, batch: Batch) -> FloatArray:
    """Return the (8, 8) correlation of the errors. The input determines the correlation, so that one copy
    suffices."""
    step = float(flight.t[1] - flight.t[0])
    noise = (float(batch.noise[0, 0]), float(batch.noise[0, 1]))
    expected = expect(
        batch.theta[0], Signal(flight.t, flight.elevator), Instruments((step, step), noise, Servo())
    )
    if expected is None:
        raise ArithmeticError("this input cannot tell the parameters apart")
    return np.asarray(expected.covariance / np.outer(expected.std, expected.std))


def _estimate(
    flight: NoiselessManeuver, z: FloatArray, batch: Batch, i: int, correlation: FloatArray
) -> Estimate:
    """Return the estimate of one copy. The noise is white, so that the plain bound is the covariance."""
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
