"""The paper's campaign, flown many times, with each rule's stop, the errors at the stop, and the paper's
values.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from scipy.linalg import expm

from advisor.aircraft.aircraft import CampaignPlan, Rule
from advisor.aircraft.reference import PARAMETERS
from advisor.decision.history import CandidateManeuver
from advisor.decision.information import knowledge
from advisor.decision.paper_rules import MANEUVER_RULES, scatter_percent, window
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from advisor.oem.covariance import cramer_rao, influence
from advisor.oem.estimate import Estimate
from advisor.oem.estimator import channel_fits
from advisor.oem.gauss_newton import CONVERGED
from advisor.oem.problem import OutputErrorProblem, Record
from advisor.oem.rows import Signal
from advisor.oem.solution import reported as reported_parameters
from advisor.oem.solution import search
from advisor.process.arrays import FloatArray
from advisor.process.installed import SIMULATOR

if TYPE_CHECKING or SIMULATOR == "sim":
    from sim.airframe import UAV
    from sim.hangar import AIRFRAMES
    from sim.linear import RESEARCH_JET, ShortPeriod
    from sim.maneuvers import STEPS
    from sim.nonlinear_aircraft import NonlinearAircraft
else:
    from inflight_sim.airframe import UAV
    from inflight_sim.hangar import AIRFRAMES
    from inflight_sim.linear import RESEARCH_JET, ShortPeriod
    from inflight_sim.maneuvers import STEPS
    from inflight_sim.nonlinear_aircraft import NonlinearAircraft

__all__ = ["AIRFRAMES", "RESEARCH_JET", "STEPS", "UAV", "NonlinearAircraft", "ShortPeriod"]


Steps = tuple[tuple[float, float], ...]
NoiseReading = Literal["std", "peak", "rms", "sample"]

NOISE_READINGS: Mapping[NoiseReading, str] = {
    "std": "of the standard deviation of the response over the manoeuvre",
    "peak": "of the largest deviation of the response from trim",
    "rms": "of the root mean square of the response, trim included",
    "sample": "of each sample's own deviation from trim",
}
"""Description of each reference of the noise's percentage, by its name. The first reference is the
default."""


@dataclass(frozen=True, slots=True)
class Scene:
    """An aircraft, with the sampling rate and the input of its manoeuvres."""

    aircraft: ShortPeriod = RESEARCH_JET
    unit_s: float = 0.7
    """One unit of time of the 3-2-1-1: about a quarter of the short period, the textbook's choice."""
    amplitude_rad: float = float(np.radians(2.0))
    lead_s: float = 1.0
    duration_s: float = 10.0
    rate_hz: float = 50.0

    @property
    def theta(self) -> FloatArray:
        """Shape (8,), the true parameters in the order of ``PARAMETERS``."""
        return np.array(list(self.aircraft.as_dict().values()))


@dataclass(frozen=True, slots=True)
class NoiselessManeuver:
    """One simulated manoeuvre without noise."""

    t: FloatArray
    elevator: FloatArray
    """(n,) elevator deflection in rad, linear between samples."""
    response: FloatArray
    """(n, 2) response of α in rad and q in rad/s."""
    trim: FloatArray
    """(2,) state before the input."""


def fly(scene: Scene, steps: Steps) -> NoiselessManeuver:
    """Fly an input of ``steps`` (duration in units, share of the amplitude; positive pulls) from trim."""
    _, trimmed = scene.aircraft.trim()
    t = np.arange(round(scene.duration_s * scene.rate_hz) + 1) / scene.rate_hz
    elevator = np.full(len(t), trimmed)
    onset = scene.lead_s
    for units, share in steps:
        on = (t > onset - 1e-9) & (t < onset + units * scene.unit_s - 1e-9)
        elevator[on] -= share * scene.amplitude_rad  # trailing edge up raises the nose
        onset += units * scene.unit_s
    return follow(scene, t, elevator)


def follow(scene: Scene, t: FloatArray, elevator: FloatArray) -> NoiselessManeuver:
    """Return the response from trim to an elevator sampled at ``t``."""
    alpha, _ = scene.aircraft.trim()
    trim = np.array([alpha, 0.0])
    return NoiselessManeuver(t, elevator, respond(scene.aircraft, elevator, trim, 1.0 / scene.rate_hz), trim)


def fly_named(scene: Scene, name: str) -> NoiselessManeuver:
    """Fly one of the bundled aircraft's inputs: ``3211``, ``rev``, ..."""
    return fly(scene, STEPS[name])


def as_maneuver(flight: NoiselessManeuver) -> Maneuver:
    """Return the flight as a manoeuvre from a message stream: command, begin and end."""
    moving = np.flatnonzero(np.abs(flight.elevator - flight.elevator[0]) > 1e-9)
    start, end = flight.t[moving[0]], flight.t[min(moving[-1] + 1, len(flight.t) - 1)]
    span = Span(
        record_from_s=0.0,
        start_s=float(start),
        last_step_s=float(end),
        end_s=float(flight.t[-1]),
        kind="other",
        steps=(),
        closed_by="quiet",
    )
    return Maneuver(1, 0, span, {"elevator": Channel("elevator", flight.t, flight.elevator)})


def respond(aircraft: ShortPeriod, elevator: FloatArray, state: FloatArray, step_s: float) -> FloatArray:
    """Return the exact solution of Eqs. (1)-(2) for an elevator that is linear between its samples.

    The matrix exponential of the system augmented by the input and its slope (Van Loan, 1978).

    Returns
    -------
    FloatArray
        Shape (n, 2): α and q at the samples.
    """
    p = aircraft
    augmented = np.zeros((5, 5))
    augmented[0] = [p.Z_alpha, 1.0 + p.Z_q, p.Z_delta_e, p.Z_0, 0.0]
    augmented[1] = [p.M_alpha, p.M_q, p.M_delta_e, p.M_0, 0.0]
    augmented[2, 4] = 1.0
    step = expm(augmented * step_s)[:2]
    states = np.empty((len(elevator), 2))
    states[0] = state
    for k in range(len(elevator) - 1):
        slope = (elevator[k + 1] - elevator[k]) / step_s
        states[k + 1] = step @ [*states[k], elevator[k], 1.0, slope]
    return states


def noise_scale(flight: NoiselessManeuver, reading: NoiseReading) -> FloatArray:
    """Return the standard deviation of a noise of 100 %, for every sample, broadcastable to (n, 2)."""
    deviation = flight.response - flight.trim
    match reading:
        case "std":
            return np.asarray(flight.response.std(axis=0))
        case "peak":
            return np.asarray(np.abs(deviation).max(axis=0))
        case "rms":
            return np.asarray(np.sqrt((flight.response**2).mean(axis=0)))
        case "sample":
            return np.abs(deviation)


NOISE_PERCENT = (1.0, 2.5, 5.0)
ORDER = ("3211", "rev", "rev", "3211", "rev", "3211", "rev")
"""Inputs of the seven manoeuvres of the campaign."""


@dataclass(frozen=True, slots=True)
class PaperRow:
    """One row of Table 1 of the paper."""

    needed: int | None
    """Number of manoeuvres until the stop. None: the campaign never stopped."""
    error_percent: Mapping[str, float]
    """Error of each parameter in percent of its true value."""


def _row(needed: int | None, *errors: float) -> PaperRow:
    return PaperRow(needed, dict(zip(PARAMETERS, errors, strict=True)))


TABLE_1: Mapping[tuple[Rule, float], PaperRow] = {
    ("continuous", 1.0): _row(3, 0.12, 0.28, 0.54, 0.44, 0.32, 0.15, 0.56, 0.07),
    ("continuous", 2.5): _row(7, 0.87, 0.74, 6.38, 3.35, 0.73, 0.10, 1.69, 1.21),
    ("continuous", 5.0): _row(None, 0.07, 5.50, 16.37, 0.89, 2.18, 2.35, 1.28, 0.70),
    ("separate", 1.0): _row(3, 0.12, 0.28, 0.54, 0.44, 0.32, 0.14, 0.56, 0.07),
    ("separate", 2.5): _row(4, 0.29, 2.79, 3.59, 0.70, 1.19, 0.60, 1.82, 0.88),
    ("separate", 5.0): _row(4, 5.43, 4.86, 30.85, 9.41, 1.26, 0.56, 3.46, 1.20),
}


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
