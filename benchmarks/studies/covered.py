"""Whole campaigns of faulty instruments: do the intervals hold, are the stops right, and are the findings?

Each campaign is a flight of the bundled simulator, written as a log and heard by ``Campaign``. Servo,
instruments and telemetry are drawn from priors. The truth is the simulator's own linearisation at the
flown speed.
"""

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from advisor.aircraft.aircraft import Aircraft, CampaignPlan, Elevator
from advisor.aircraft.reference import PARAMETERS, SPEED_EXPONENTS
from advisor.bundled.study.campaigns import Scene, fly_named, respond
from advisor.campaign.campaign import Campaign, ManeuverJudged
from advisor.campaign.state import CampaignState
from advisor.decision.prediction import Prediction, tolerances
from advisor.flight.signals.trust import InstrumentFinding
from advisor.mavlink.logs.logs import open_log
from advisor.oem.estimate import Estimate
from advisor.oem.notes import findings_of
from advisor.process.arrays import FloatArray
from advisor.session.timeline import Timeline
from advisor.words.quantities import NORMAL_95
from benchmarks.studies.forecast import Forecast
from sim.effects.fitting import flight_of
from sim.faults import Faults, Filters
from sim.flight import Flight
from sim.hangar import habits
from sim.linear import ShortPeriod
from sim.record import record
from sim.scenario import Noise, Scenario, Servo

PLAN = CampaignPlan()
NAMED = PLAN.parameters
"""Derivatives whose intervals are checked."""
ARM_M = {"uav": 0.6, "linear": 6.0}
"""Aircraft to the longest boom of its vane, m: two mean chords of the small one, a nose boom of the jet."""
HEARD_EVERY_S = 2.0
"""Time between two looks at a log, s: less than the shortest time between two manoeuvres."""
FAR_OFF = 0.3
"""Relative error of a stated lag from which no false stop may be said. A wrong lag is off by once to twice as
much, either way."""
Statement = Literal["unknown", "right", "wrong"]
STATEMENTS: tuple[Statement, ...] = ("unknown", "right", "wrong")
ORDINARY = {"sign": 1.0, "scale": 1.0}
"""Value of a quantity that nobody states. Other quantities are zero."""


@dataclass(frozen=True, slots=True)
class Errors:
    """Errors of one campaign, as drawn. Times in s."""

    noise_percent: float
    lag_s: float
    command_late_s: float
    filter_hz: float
    """Cut-off of gyro and accelerometer, Hz, which the parameters state. 0: no filters."""
    alpha_late_s: float
    arm_m: float
    airspeed_scale: float
    stated_lag_s: float | None

    def truth_of(self, finding: InstrumentFinding) -> float:
        """Return the true value of what a finding tells."""
        drawn = {
            "elevator_lag_s": self.lag_s,
            "elevator_delay_s": self.command_late_s,
            "alpha_delay_s": self.alpha_late_s,
            "alpha_arm_m": self.arm_m,
            "airspeed_scale": self.airspeed_scale,
        }
        return drawn.get(finding.code, ORDINARY.get(finding.quantity, 0.0))

    def confirms(self, finding: InstrumentFinding) -> bool:
        """Return whether the truth is nearer to the finding's value than to the stated one. No unit is wrong
        here."""
        if isinstance(finding.value, str) or isinstance(finding.stated, str):
            return False
        stated = ORDINARY.get(finding.quantity, 0.0) if finding.stated is None else finding.stated
        truth = self.truth_of(finding)
        return abs(finding.value - truth) < abs(stated - truth)


@dataclass(frozen=True, slots=True)
class Drawn:
    """One campaign to be flown."""

    aircraft: str
    statement: Statement
    seed: tuple[int, int]

    @property
    def campaigns(self) -> int:
        """Number of campaigns in the task."""
        return 1

    @property
    def errors(self) -> Errors:
        """Errors, drawn from the priors."""
        rng = np.random.default_rng(self.seed)
        lag_s = float(rng.uniform(0.03, 0.2))
        vane = bool(rng.integers(2))
        off = float(rng.uniform(-1.0, 1.0))
        wrong = lag_s * (1.0 + np.copysign(FAR_OFF, off) * (1.0 + abs(off)))
        stated = {"unknown": None, "right": lag_s, "wrong": float(wrong)}
        return Errors(
            noise_percent=float(np.exp(rng.uniform(np.log(0.5), np.log(5.0)))),
            lag_s=lag_s,
            command_late_s=float(rng.uniform(-0.01, 0.01)),
            filter_hz=float(rng.uniform(15.0, 40.0)) * int(rng.integers(2)),
            alpha_late_s=0.0 if vane else float(rng.uniform(0.0, 0.09)),
            arm_m=float(rng.uniform(0.0, ARM_M[self.aircraft])) if vane else 0.0,
            airspeed_scale=float(rng.uniform(0.95, 1.05)),
            stated_lag_s=stated[self.statement],
        )


@dataclass(frozen=True, slots=True)
class Stop:
    """The first stop of a campaign."""

    after: int
    """Number of manoeuvres flown."""
    response: float
    """Largest error of the predicted response to the standard input, over its tolerance."""
    derivative: float
    """Largest error of a named derivative, over its tolerance."""

    @property
    def false(self) -> bool:
        """Whether an error exceeds its tolerance."""
        return max(self.response, self.derivative) > 1.0


@dataclass(frozen=True, slots=True)
class Outcome:
    """What the advisor said of one campaign."""

    drawn: Drawn
    accepted: int
    off: Mapping[str, float]
    """Named derivative to its error over the half-width of its 95 % interval. Empty without a model."""
    stop: Stop | None
    right: tuple[str, ...]
    """Codes of the contradictions that the truth confirms."""
    wrong: tuple[str, ...]
    """Codes of the other contradictions."""
    flown: int = 0
    """Number of manoeuvres in all."""
    forecasts: tuple[Forecast, ...] = ()
    """Forecasts until the first stop."""

    @property
    def far_off(self) -> bool:
        """Whether the stated lag is off by ``FAR_OFF`` or more."""
        errors = self.drawn.errors
        stated = errors.stated_lag_s
        return stated is not None and abs(stated / errors.lag_s - 1.0) >= FAR_OFF

    @property
    def stopped_falsely(self) -> bool:
        """Whether the first stop is false."""
        return self.stop is not None and self.stop.false

    @property
    def document(self) -> dict[str, object]:
        """The outcome for programs."""
        stop = None if self.stop is None else {**asdict(self.stop), "false": self.stop.false}
        return {
            "aircraft": self.drawn.aircraft,
            "statement": self.drawn.statement,
            **asdict(self.drawn.errors),
            "accepted": self.accepted,
            "off": dict(self.off),
            "stop": stop,
            "right": list(self.right),
            "wrong": list(self.wrong),
            "forecasts": [asdict(one) for one in self.forecasts],
        }


def draws(campaigns: int, seed: int) -> list[Drawn]:
    """Return the campaigns: aircraft and statements of the lag in turn, each with a seed of its own."""
    pairs = [(aircraft, statement) for statement in STATEMENTS for aircraft in ARM_M]
    return [Drawn(*pairs[k % len(pairs)], (seed, k)) for k in range(campaigns)]


def coverage_percent(found: Sequence[Outcome]) -> dict[str, float]:
    """Return the share of the campaigns with a model whose 95 % interval holds the truth, for each named
    derivative; empty without a model."""
    modelled = [one.off for one in found if one.off]
    return {
        name: 100.0 * float(np.mean([abs(off[name]) <= 1.0 for off in modelled]))
        for name in (NAMED if modelled else ())
    }


def fly(drawn: Drawn) -> Outcome:
    """Fly one campaign, and return what the advisor said of it."""
    errors = drawn.errors
    flight = flight_of(_scenario(drawn, errors))
    aircraft = Aircraft(elevator=Elevator(lag_s=errors.stated_lag_s))
    campaign = Campaign(aircraft)
    stop, forecasts = _heard(campaign, flight, errors)
    state = campaign.state
    off: Mapping[str, float] = {}
    told = {f.code: f for f in state.instruments}
    if state.model is not None:
        off = _off(state.model, _truth(flight, state.model, errors))
        told |= {f.code: f for f in findings_of(state.model, aircraft)}
    contradictions = [f for f in told.values() if f.contradicts]
    return Outcome(
        drawn,
        sum(judged.verdict.accepted for judged in state.maneuvers),
        off,
        stop,
        tuple(f.code for f in contradictions if errors.confirms(f)),
        tuple(f.code for f in contradictions if not errors.confirms(f)),
        len(state.maneuvers),
        forecasts,
    )


def _scenario(drawn: Drawn, errors: Errors) -> Scenario:
    effects = {
        "alpha_skew": {"skew_s": errors.alpha_late_s},
        "alpha_vane_offset": {"arm_m": errors.arm_m},
    }
    return Scenario(
        aircraft=drawn.aircraft,
        seed=int(np.random.SeedSequence(drawn.seed).generate_state(1)[0]),
        noise=Noise(percent=errors.noise_percent),
        servo=Servo(lag_s=errors.lag_s),
        effects={name: sizes for name, sizes in effects.items() if any(sizes.values())},
        faults=Faults(
            scale={"airspeed": errors.airspeed_scale},
            filters=Filters(errors.filter_hz, errors.filter_hz),
            command_late_s=errors.command_late_s,
        ),
    )


def _heard(campaign: Campaign, flight: Flight, errors: Errors) -> tuple[Stop | None, tuple[Forecast, ...]]:
    """Feed the flight's log to the end as a link delivers it; return the first stop and the forecasts before
    it."""
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "flight.tlog"
        record(flight, log)
        timeline = Timeline([columns for batch in open_log(log) for columns in batch])
    stop, forecasts = None, list[Forecast]()
    for position_s in np.arange(0.0, timeline.duration_s + HEARD_EVERY_S, HEARD_EVERY_S):
        events = campaign.feed(timeline.up_to(float(position_s)))
        if stop is None and any(isinstance(event, ManeuverJudged) for event in events):
            stop = _stop(campaign.state, flight, errors)
            following = campaign.state.flight_test.next
            if stop is None and following is not None and following.remaining is not None:
                remaining = following.remaining
                forecasts.append(Forecast(len(campaign.state.maneuvers), remaining.median, remaining.p90))
    campaign.finish()
    return stop or _stop(campaign.state, flight, errors), tuple(forecasts)


def _truth(flight: Flight, model: Estimate, errors: Errors) -> FloatArray:
    """Return the true parameters (8,) at the speed that the model states, without the error of that speed.

    The linear aircraft has the same derivatives at every speed."""
    truth = flight.engine.truth.as_dict()
    ratio = 1.0
    if model.airspeed_m_s and flight.scenario.aircraft != "linear":
        ratio = model.airspeed_m_s / errors.airspeed_scale / habits(flight.scenario).airspeed_m_s
    return np.array([truth[name] * ratio ** SPEED_EXPONENTS.get(name, 0.0) for name in PARAMETERS])


def _off(model: Estimate, truth: FloatArray) -> dict[str, float]:
    rows = {name: PARAMETERS.index(name) for name in NAMED}
    return {
        name: float((model.theta[row] - truth[row]) / (NORMAL_95 * model.std[row]))
        for name, row in rows.items()
    }


def _stop(state: CampaignState, flight: Flight, errors: Errors) -> Stop | None:
    """Return the stop that the state says; None without."""
    model = state.model
    if state.flight_test.decision != "stop" or model is None:
        return None
    truth = _truth(flight, model, errors)
    allowed = tolerances(truth, Prediction({}), PLAN)
    rows = [PARAMETERS.index(name) for name in NAMED]
    derivative = float(np.max(np.abs(model.theta - truth)[rows] / allowed[rows]))
    response = response_error_percent(model.theta, truth, flight.scenario) / PLAN.tolerance_percent
    return Stop(len(state.maneuvers), response, derivative)


def response_error_percent(theta: FloatArray, truth: FloatArray, scenario: Scenario) -> float:
    """Return the largest error of the response to the surface's standard 3-2-1-1, in percent of its peak."""
    usual = habits(scenario)
    true, found = (replace(ShortPeriod(*map(float, values)), Z_0=0.0, M_0=0.0) for values in (truth, theta))
    scene = Scene(true, usual.unit_s, float(np.radians(usual.amplitude_deg)))
    flight = fly_named(scene, "3211")
    predicted = respond(found, flight.elevator, np.zeros(2), 1.0 / scene.rate_hz)
    off = np.max(np.abs(predicted - flight.response), axis=0)
    return float(np.max(100.0 * off / np.max(np.abs(flight.response), axis=0)))
