"""Early stops of the rule ``information``, and the manoeuvres that each rule needs.

A stop is false when the model then predicts the true response to the campaign's inputs worse than the
tolerance. The error is the largest over time, in percent of the peak, of the worst output.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft, CampaignPlan, Elevator, Rule
from advisor.bundled.study.campaigns import (
    ORDER,
    RULES,
    NoiselessManeuver,
    Scene,
    as_maneuver,
    blocks,
    estimate_copies,
    fly_named,
    follow,
    noise_scale,
    respond,
)
from advisor.decision.advice import forecast
from advisor.decision.history import CandidateManeuver
from advisor.decision.information import CriterionCourse, knowledge
from advisor.decision.prediction import MOMENTS, PREDICTED, response_to
from advisor.decision.stopping import progress
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.record import Channel
from advisor.oem.estimate import NoEstimate
from advisor.oem.estimator import estimate, estimate_jointly
from advisor.oem.surface import Servo
from advisor.process.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Case:
    """Input and disturbances of a campaign."""

    name: str
    noise_percent: float
    tolerance_percent: float = 5.0
    correlation_s: float = 0.0
    """Correlation time of the noise, s, first order. 0: white."""
    gust_percent: float = 0.0
    """Standard deviation of the gusts' angle, in percent of that of the response in α."""
    lag_s: float = 0.0
    """First-order lag of the servo, s, which the crew does not know. It is estimated jointly, as in
    flight."""


CASES = (
    Case("white noise", 1.0),
    Case("white noise", 2.5),
    Case("white noise", 5.0),
    Case("white noise", 5.0, tolerance_percent=1.0),
    Case("coloured noise, 0.2 s", 2.5, correlation_s=0.2),
    Case("coloured noise, 0.2 s", 2.5, tolerance_percent=2.0, correlation_s=0.2),
    Case("coloured noise, 1 s", 5.0, tolerance_percent=3.0, correlation_s=1.0),
    Case("gusts of 5 %", 2.5, gust_percent=5.0),
    Case("gusts of 10 %", 2.5, gust_percent=10.0),
    Case("servo lag 0.05 s unknown", 2.5, lag_s=0.05),
    Case("servo lag 0.14 s unknown", 2.5, lag_s=0.14),
)
"""Cases with the default tolerance, and with tighter ones that need several manoeuvres."""
BLOCK = 5
"""Number of campaigns in a task: a second of work at most."""
GUST_S = 0.5
"""Correlation time of the gusts, s."""
KNOWN_FROM = 2
"""Number of manoeuvres at which an unknown lag is first estimated jointly."""


@dataclass(frozen=True, slots=True)
class Stops:
    """Campaigns of one case."""

    case: Case
    needed: dict[Rule, tuple[int | None, ...]]
    """Manoeuvres flown when each rule first said stop, for each campaign. None: no stop in seven."""
    error_percent: tuple[float, ...]
    """Error of the predicted response where ``information`` stopped, in percent of its peak."""
    promises: tuple[tuple[int, int | None], ...]
    """For each forecast before the stop: the number that nine campaigns in ten do not exceed, and the number
    flown. None: no stop in seven."""

    @property
    def kept_percent(self) -> float:
        """Share of the forecasts with a number that held; NaN without a forecast."""
        kept = [needed is not None and needed <= promised for promised, needed in self.promises]
        return 100.0 * float(np.mean(kept)) if kept else float("nan")

    @property
    def false_percent(self) -> float:
        """Share of the stops with an error above the tolerance; NaN without a stop."""
        wrong = [error > self.case.tolerance_percent for error in self.error_percent]
        return 100.0 * float(np.mean(wrong)) if wrong else float("nan")

    def error_quantile(self, share: float) -> float | None:
        """Return the error that ``share`` of the stops do not exceed; None without a stop."""
        return float(np.quantile(self.error_percent, share)) if self.error_percent else None

    def median_needed(self, rule: Rule) -> int | None:
        """Return the median number of manoeuvres; None where most campaigns do not stop."""
        middle = sorted(np.inf if n is None else n for n in self.needed[rule])[len(self.needed[rule]) // 2]
        return None if np.isinf(middle) else int(middle)

    def never_percent(self, rule: Rule) -> float:
        """Return the share of the campaigns that ``rule`` does not end."""
        return 100.0 * float(np.mean([n is None for n in self.needed[rule]]))


@dataclass(frozen=True, slots=True)
class StopsBlock:
    """Campaigns of one case that are flown and judged together."""

    case: Case
    campaigns: int
    seed: tuple[int, ...]


def stop_blocks(campaigns: int, seed: int, cases: Sequence[Case]) -> list[StopsBlock]:
    """Divide the campaigns of every case into blocks, each with a seed of its own."""
    return [
        StopsBlock(case, count, (seed, number, k))
        for number, case in enumerate(cases)
        for k, count in blocks(campaigns, BLOCK)
    ]


def fly(block: StopsBlock) -> Stops:
    """Fly a block, and return where each rule stops."""
    case, scene, rng = block.case, Scene(), np.random.default_rng(block.seed)
    flights = {name: _through(scene, fly_named(scene, name), case.lag_s) for name in set(ORDER)}
    noise = 0.01 * case.noise_percent * noise_scale(flights[ORDER[0]], "std")
    order = [flights[name] for name in ORDER]
    flown: list[tuple[CandidateManeuver, ...]]
    if case.correlation_s == case.gust_percent == case.lag_s == 0.0:
        columns = [_copies(flight, noise, block.campaigns, rng) for flight in order]
        flown = list(zip(*columns, strict=True))
    else:
        flown = [_campaign(scene, order, noise, case, rng) for _ in range(block.campaigns)]
    return _measured(case, flown, order)


def by_case(found: Sequence[Stops]) -> list[Stops]:
    """Join the blocks of each case."""
    cases: dict[Case, list[Stops]] = {}
    for one in found:
        cases.setdefault(one.case, []).append(one)
    return [
        Stops(
            case,
            {rule: tuple(n for one in several for n in one.needed[rule]) for rule in RULES},
            tuple(error for one in several for error in one.error_percent),
            tuple(promise for one in several for promise in one.promises),
        )
        for case, several in cases.items()
    ]


def _through(scene: Scene, flight: NoiselessManeuver, lag_s: float) -> NoiselessManeuver:
    """Return the flight with its command passed through a servo with a lag."""
    if lag_s <= 0.0:
        return flight
    surface, _, _ = Servo(lag_s).move(flight.t, flight.elevator, flight.t)
    return replace(follow(scene, flight.t, surface), elevator=flight.elevator)


def _copies(
    flight: NoiselessManeuver, noise: FloatArray, campaigns: int, rng: np.random.Generator
) -> list[CandidateManeuver]:
    """Return the manoeuvre of each campaign, with white noise."""
    maneuver = as_maneuver(flight)
    return [CandidateManeuver(e, maneuver=maneuver) for e in estimate_copies(flight, noise, campaigns, rng)]


def _campaign(
    scene: Scene, order: Sequence[NoiselessManeuver], noise: FloatArray, case: Case, rng: np.random.Generator
) -> tuple[CandidateManeuver, ...]:
    """Return one campaign through the estimator of the flight test, with its corrected covariance.

    Raises
    ------
    ArithmeticError
        A manoeuvre could not be estimated.
    """
    maneuvers = [
        _measure(
            flight, noise * _coloured(flight, case.correlation_s, rng) + _gusts(scene, flight, case, rng)
        )
        for flight in order
    ]
    lag_s = _lag_found(maneuvers[:KNOWN_FROM]) if case.lag_s > 0.0 else 0.0
    aircraft = Aircraft(elevator=Elevator(lag_s=lag_s, delay_s=0.0))
    flown = []
    for maneuver in maneuvers:
        found = estimate(maneuver, aircraft)
        if isinstance(found, NoEstimate):
            raise ArithmeticError(found.text)
        flown.append(CandidateManeuver(found, maneuver=maneuver, servo=Servo(lag_s)))
    return tuple(flown)


def _gusts(
    scene: Scene, flight: NoiselessManeuver, case: Case, rng: np.random.Generator
) -> FloatArray | float:
    """Return the gusts' contributions to α and q, shape (n, 2). A gust acts through Z_alpha and M_alpha."""
    if case.gust_percent == 0.0:
        return 0.0
    size = 0.01 * case.gust_percent * float(np.std(flight.response[:, 0]))
    gust = size * _coloured(flight, GUST_S, rng)[:, 0]
    p = scene.aircraft
    moved = replace(p, Z_0=0.0, M_0=0.0, Z_delta_e=p.Z_alpha, M_delta_e=p.M_alpha)
    return respond(moved, gust, np.zeros(2), 1.0 / scene.rate_hz)


def _measure(flight: NoiselessManeuver, disturbance: FloatArray) -> Maneuver:
    maneuver, z = as_maneuver(flight), flight.response + disturbance
    channels = {name: Channel(name, flight.t, z[:, k]) for k, name in enumerate(("alpha", "q"))}
    return replace(maneuver, channels={**maneuver.channels, **channels})


def _lag_found(maneuvers: Sequence[Maneuver]) -> float:
    """Return the lag of the joint estimate; 0 where the data do not show one."""
    model = estimate_jointly(maneuvers, Aircraft())
    if isinstance(model, NoEstimate):
        raise ArithmeticError(model.text)
    lag = model.instrument("servo_lag_s")
    return lag.value if lag is not None else 0.0


def _coloured(flight: NoiselessManeuver, correlation_s: float, rng: np.random.Generator) -> FloatArray:
    """Return noise of unit variance, shape (n, 2)."""
    white = rng.standard_normal(flight.response.shape)
    if correlation_s == 0.0:
        return white
    kept = float(np.exp(-(flight.t[1] - flight.t[0]) / correlation_s))
    noise: FloatArray = white.copy()
    for k in range(1, len(white)):
        noise[k] = kept * noise[k - 1] + np.sqrt(1.0 - kept**2) * white[k]
    return noise


def _measured(
    case: Case, campaigns: Sequence[Sequence[CandidateManeuver]], flights: Sequence[NoiselessManeuver]
) -> Stops:
    plan = CampaignPlan(tolerance_percent=case.tolerance_percent)
    needed: dict[Rule, tuple[int | None, ...]] = {
        rule: tuple(progress(campaign, rule, plan).stopped_at for campaign in campaigns) for rule in RULES
    }
    errors = [
        _error_percent(campaign[:number], flights[:number], plan)
        for campaign, number in zip(campaigns, needed["information"], strict=True)
        if number is not None
    ]
    promises = [
        promise
        for campaign, number in zip(campaigns, needed["information"], strict=True)
        for promise in _promises(campaign, number, plan)
    ]
    return Stops(case, needed, tuple(errors), tuple(promises))


def _promises(
    campaign: Sequence[CandidateManeuver], stopped_at: int | None, plan: CampaignPlan
) -> Iterator[tuple[int, int | None]]:
    """Yield the forecasts before the stop of a campaign that does not follow the advice."""
    course = CriterionCourse(plan)
    for flown in range(1, len(campaign) if stopped_at is None else stopped_at):
        promised = forecast(campaign[:flown], course).p90
        if promised is not None:
            yield promised, None if stopped_at is None else stopped_at - flown


def _error_percent(
    flown: Sequence[CandidateManeuver], flights: Sequence[NoiselessManeuver], plan: CampaignPlan
) -> float:
    """Return the largest error of the response predicted at the stop, in percent of its peak."""
    derivatives = knowledge(flown, plan).posterior.shared.theta
    worst = 0.0
    for one, flight in zip(flown, flights, strict=True):
        predicted = response_to(one, derivatives, None)
        if predicted is None:
            return float("inf")
        moments = np.linspace(flight.t[0], flight.t[-1], MOMENTS)
        for k, name in enumerate(("alpha", "q")):
            true = np.interp(moments, flight.t, flight.response[:, k] - flight.trim[k])
            off = np.max(np.abs(predicted.values[PREDICTED.index(name)] - true))
            worst = max(worst, 100.0 * float(off / np.max(np.abs(true))))
    return worst
