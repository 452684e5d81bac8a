"""Campaigns written down by hand: estimates with chosen values, costs and errors."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft.reference import PARAMETERS
from advisor.decision.history import CandidateManeuver
from advisor.oem.estimate import ChannelFit, Estimate
from advisor.process.arrays import FloatArray

THETA = np.array([-0.009, -0.483, 0.104, 0.676, 0.475, -4.93, -2.01, -7.21])
"""The twin-jet research aircraft of the study, rad and s."""

SAMPLES = 500
NOISE = 1e-4
"""Of both channels, rad and rad/s."""


def estimate(
    theta: FloatArray = THETA,
    *,
    cost: float = 1e-9,
    std_percent: float = 1.0,
    covariance: FloatArray | None = None,
    airspeed_m_s: float | None = None,
) -> Estimate:
    """An estimate with independent errors of ``std_percent`` of the reference aircraft's values."""
    if covariance is None:
        covariance = np.diag((0.01 * std_percent * THETA) ** 2)
    t = np.arange(SAMPLES) / 50.0
    fits = {name: ChannelFit(name, t, np.zeros(SAMPLES), np.zeros(SAMPLES), NOISE) for name in ("alpha", "q")}
    return Estimate(
        theta=np.asarray(theta, dtype=float),
        covariance_cr=covariance,
        covariance=covariance,
        cost=cost,
        fits=(fits,),
        iterations=4,
        not_identifiable={},
        correlated=(),
        condition=10.0,
        airspeed_m_s=airspeed_m_s,
    )


def flown(costs: Sequence[float]) -> list[CandidateManeuver]:
    """A campaign of usable manoeuvres with these costs."""
    return [CandidateManeuver(estimate(cost=cost)) for cost in costs]


def with_residual(estimate: Estimate, residual: FloatArray) -> Estimate:
    """The same estimate with other residuals, in both channels alike."""
    fits = {name: replace(fit, measured=residual) for name, fit in estimate.fits[0].items()}
    return replace(estimate, fits=(fits,))


def at_alpha(estimate: Estimate, low_deg: float, high_deg: float) -> Estimate:
    """The same estimate from a manoeuvre between these angles of attack."""
    measured = np.radians(np.linspace(low_deg, high_deg, SAMPLES))
    alpha = replace(estimate.fits[0]["alpha"], measured=measured)
    return replace(estimate, fits=({**estimate.fits[0], "alpha": alpha},))


def with_change(parameter: str, factor: float) -> FloatArray:
    """The reference aircraft with one parameter multiplied."""
    theta = THETA.copy()
    theta[PARAMETERS.index(parameter)] *= factor
    return theta


def drawn(rng: np.random.Generator, theta: FloatArray = THETA, std_percent: float = 1.0) -> Estimate:
    """An estimate whose error is drawn from the covariance it states."""
    return estimate(theta + 0.01 * std_percent * THETA * rng.standard_normal(8), std_percent=std_percent)
