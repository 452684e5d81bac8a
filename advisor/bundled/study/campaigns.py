"""The paper's campaign, flown many times, with each rule's stop and the errors at the stop."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from advisor.aircraft.aircraft import CampaignPlan, Rule
from advisor.bundled.study.flying import (
    NoiselessManeuver,
    NoiseReading,
    Scene,
    as_maneuver,
    fly_named,
    noise_scale,
)
from advisor.bundled.study.paper import ORDER
from advisor.decision.history import CandidateManeuver
from advisor.decision.information import knowledge
from advisor.decision.paper_rules import MANEUVER_RULES, scatter_percent, window
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.covariance import cramer_rao, influence
from advisor.oem.estimate import Estimate
from advisor.oem.estimator import channel_fits
from advisor.oem.gauss_newton import CONVERGED
from advisor.oem.problem import OutputErrorProblem, Record
from advisor.oem.rows import Signal
from advisor.oem.solution import reported as reported_parameters
from advisor.oem.solution import search
from advisor.process.arrays import FloatArray


def estimate_copies(
    flight: NoiselessManeuver, noise: FloatArray, copies: int, rng: np.random.Generator
) -> list[Estimate]:
    """Measure a flight ``copies`` times and estimate each measurement on its own.

    Each search begins at the estimate of the copies' mean.

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
    mean = search(_problem(flight, z.mean(axis=0)))[1]
    return [_estimate(_problem(flight, copy), (mean.shared, mean.local)) for copy in z]


def _problem(flight: NoiselessManeuver, z: FloatArray) -> OutputErrorProblem:
    """Return the problem of one measurement ``z``, shape (n, 2), of α and q."""
    outputs = {name: Signal(flight.t, z[:, k]) for k, name in enumerate(("alpha", "q"))}
    return OutputErrorProblem((Record(Signal(flight.t, flight.elevator), outputs),))


def _estimate(problem: OutputErrorProblem, begin: tuple[FloatArray, FloatArray]) -> Estimate:
    """Return the estimate of one measurement. The noise is white, so that the Cramér–Rao bound is the
    covariance.
    """
    assembly, optimum = search(problem, begin=begin)
    if optimum.status != CONVERGED:
        assembly, optimum = search(problem)
    effect = influence(assembly, optimum.sensitivities, optimum.noise)
    if optimum.status != CONVERGED or effect is None:
        raise ArithmeticError("a simulated manoeuvre could not be estimated")
    covariance = cramer_rao(assembly, effect.rows, optimum.noise)
    return Estimate(
        theta=reported_parameters(optimum.shared, optimum.local),
        covariance_cr=covariance,
        covariance=covariance,
        cost=float(np.prod(optimum.noise[:2] ** 2)),
        fits=channel_fits(assembly, optimum),
        iterations=optimum.iterations,
        not_identifiable={},
        correlated=(),
        condition=effect.condition,
        airspeed_m_s=None,
    )


def blocks(campaigns: int, size: int) -> Iterator[tuple[int, int]]:
    """Yield the number and the size of each block of campaigns.

    The size is a constant of the study and independent of the workers, because a block has a seed of its own.
    """
    for number, first in enumerate(range(0, campaigns, size)):
        yield number, min(size, campaigns - first)


RULES: tuple[Rule, ...] = ("continuous", "separate", "information")
BLOCK = 50
"""Number of campaigns in a task, which take a third of a second."""


@dataclass(frozen=True, slots=True)
class RuleOutcome:
    """Outcome of one campaign under one stopping rule."""

    needed: int | None
    """Number of manoeuvres after which the rule first said stop. None: no stop within the campaign."""
    theta: FloatArray
    """(8,) parameters reported at the stop, or at the campaign's end."""
    tolerance: FloatArray
    """(8,) tolerances of the rule ``information`` at that time. NaN under the paper's rules."""
    history_percent: tuple[float | None, ...]
    """Criterion after each manoeuvre. For ``information`` the history ends at the stop."""
    rejected: int
    """Number of flown manoeuvres that the stopping rule rejected."""


@dataclass(frozen=True, slots=True)
class CampaignBlock:
    """Campaigns that are flown and judged together."""

    scene: Scene
    noise_percent: float
    campaigns: int
    seed: tuple[int, ...]
    reading: NoiseReading = "std"


Outcomes = Mapping[Rule, tuple[RuleOutcome, ...]]
"""Outcomes of all campaigns of a block under each stopping rule, by the rule."""


def table_blocks(
    scene: Scene, noise_percent: float, campaigns: int, seed: int, reading: NoiseReading = "std"
) -> list[CampaignBlock]:
    """Divide the campaigns at one noise level into blocks, each with a seed of its own."""
    return [
        CampaignBlock(scene, noise_percent, count, (seed, round(1000 * noise_percent), k), reading)
        for k, count in blocks(campaigns, BLOCK)
    ]


def judge(block: CampaignBlock) -> Outcomes:
    """Fly the campaigns of a block, and stop each by every rule."""
    maneuvers = [as_maneuver(fly_named(block.scene, name)) for name in ORDER]
    plan = CampaignPlan()
    flown = fly_campaigns(block)
    return {rule: tuple(outcome(campaign, rule, plan, maneuvers) for campaign in flown) for rule in RULES}


def fly_campaigns(block: CampaignBlock) -> list[list[Estimate]]:
    """Return the estimates of every manoeuvre of a block, campaign by campaign.

    The noise of the first manoeuvre is used for all manoeuvres, because the instruments do not change.
    """
    rng = np.random.default_rng(block.seed)
    flights = [fly_named(block.scene, name) for name in ORDER]
    noise = 0.01 * block.noise_percent * noise_scale(flights[0], block.reading)
    columns = [estimate_copies(flight, noise, block.campaigns, rng) for flight in flights]
    return [list(campaign) for campaign in zip(*columns, strict=True)]


def outcome(
    campaign: Sequence[Estimate], rule: Rule, plan: CampaignPlan, maneuvers: Sequence[Maneuver] = ()
) -> RuleOutcome:
    """Return the outcome of one campaign under ``rule``, by the functions that judge in flight.

    Parameters
    ----------
    maneuvers
        Flown manoeuvres, from which the rule ``information`` predicts the response. Without them the rule
        asks only for the named derivatives.
    """
    accepted = [r.accepted for r in MANEUVER_RULES[rule]([e.cost for e in campaign])]
    taken: list[Estimate] = []
    flown = [
        CandidateManeuver(estimate, maneuver=maneuvers[i] if maneuvers else None)
        for i, estimate in enumerate(campaign)
    ]
    history: list[float | None] = []
    needed = None
    for number, (estimate, good) in enumerate(zip(campaign, accepted, strict=True), start=1):
        if good:
            taken.append(estimate)
        if rule == "information":
            standing = knowledge(flown[:number], plan)
            history.append(standing.percent)
            if standing.sufficient or number == len(campaign):
                needed = number if standing.sufficient else None
                return RuleOutcome(needed, standing.posterior.theta, standing.tolerance, tuple(history), 0)
            continue
        members = window(taken, plan)
        history.append(None if members is None else scatter_percent(members, plan.criterion))
        value = history[-1]
        if needed is None and value is not None and value < plan.limit_percent:
            needed = number
            theta = reported(taken, plan)
    if needed is None:
        theta = reported(taken, plan)
    return RuleOutcome(needed, theta, np.full(8, np.nan), tuple(history), len(campaign) - len(taken))


def reported(taken: Sequence[Estimate], plan: CampaignPlan) -> FloatArray:
    """Return the final values of a campaign by the paper: the mean over the criterion's window."""
    mean: FloatArray = np.mean([e.theta for e in taken[-plan.window :]], axis=0)
    return mean
