"""What is flown: aircraft, manoeuvres, speeds and heights, and who holds the stick."""

from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.random import Generator
from scipy.ndimage import gaussian_filter1d

from .fleet import FLEET, Aircraft, Floats, Shape, scattered
from .flight import STEP_S, Channels, Gains, Inputs, fly
from .maneuvers import KINDS, SHARES, Maneuver, input_shape, peak_alpha
from .motion import Around, Faults
from .servo import Servo
from .trim import Trim, derivatives, short_period, trim, with_elevator_near


@dataclass(frozen=True)
class Plan:
    """One flight before any effect enters."""

    aircraft: Aircraft
    shape: Shape
    model: dict[str, float]
    own_rad_s: float
    trims: tuple[Trim, ...]
    maneuvers: tuple[Maneuver, ...]
    stick: Floats
    hands_off: Floats
    power: Floats
    stage: Floats
    """Number of the manoeuvre that each step belongs to or leads to."""
    gains: Gains
    remnant: Floats | None = None
    """Motion of the hand without any cause in the aircraft's motion, rad; None for a perfect hand."""

    @property
    def steps(self) -> int:
        """Steps of the whole flight."""
        return self.stick.size

    @property
    def time(self) -> Floats:
        """Time of every step [s]."""
        return STEP_S * np.arange(self.steps)


@dataclass(frozen=True)
class Wishes:
    """What an effect asks of the plan, so that it can be seen."""

    speeds: tuple[float, float] | None = None
    """Ratios to the reference speed."""
    near_ground: bool = False
    power: float = 0.0
    """Throttle steps within every manoeuvre, over the trimmed throttle."""


def draw_plan(rng: Generator, wishes: Wishes) -> Plan:
    """Draw an aircraft and six to ten manoeuvres."""
    fleet = [a for a in FLEET if a.span_m > 8.0] if wishes.near_ground else list(FLEET)
    aircraft = scattered(fleet[int(rng.integers(len(fleet)))], rng)
    if wishes.near_ground:
        aircraft = replace(aircraft, height_m=300.0)
    shape = with_elevator_near(aircraft, float(np.radians(rng.uniform(-3.0, 1.0))))
    level = trim(shape, Faults(), Around(), aircraft.airspeed_m_s, aircraft.height_m)
    model = derivatives(shape, level)
    own, damping = short_period(model)
    count = int(rng.integers(6, 11))
    speeds = _speeds(count, rng, wishes) * aircraft.airspeed_m_s
    heights = _heights(count, aircraft, rng, wishes)
    hand = _gains(model, own, damping, aircraft.airspeed_m_s, rng)
    return _laid_out(aircraft, shape, model, own, speeds, heights, hand, rng, wishes)


def _speeds(count: int, rng: Generator, wishes: Wishes) -> Floats:
    low = high = 1.0
    if wishes.speeds is not None:
        low, high = wishes.speeds
    elif rng.random() < 0.4:
        low, high = float(rng.uniform(0.88, 0.94)), float(rng.uniform(1.06, 1.14))
    ratios = np.where(np.arange(count) < count // 2, low, high)
    return np.asarray(ratios * rng.uniform(0.985, 1.015, count))


def _heights(count: int, aircraft: Aircraft, rng: Generator, wishes: Wishes) -> Floats:
    if wishes.near_ground:
        low = rng.uniform(0.45, 0.8, count) * aircraft.span_m
        high = rng.uniform(2.0, 3.0, count) * aircraft.span_m
        return np.where(np.arange(count) % 2 == 0, high, low)
    return aircraft.height_m + rng.uniform(-3.0, 3.0, count)


def _gains(model: dict[str, float], own: float, damping: float, speed: float, rng: Generator) -> Gains:
    power = abs(model["M_delta_e"])
    # A damper of a stabilised mode brings the damping ratio up by a quarter to a half.
    damper = 2.0 * own * float(rng.uniform(0.12, 0.3)) / power if rng.random() < 0.35 else 0.0
    rate = 2.0 * own * max(0.9 - damping, 0.1) / power
    return Gains(0.2 * own**2 / power, rate, 0.12 * own / speed, 0.04, damper)


def _laid_out(
    aircraft: Aircraft,
    shape: Shape,
    model: dict[str, float],
    own: float,
    speeds: Floats,
    heights: Floats,
    gains: Gains,
    rng: Generator,
    wishes: Wishes,
) -> Plan:
    at, maneuvers, pieces = float(rng.uniform(5.0, 8.0)), [], []
    powers = []
    for k, (speed, height) in enumerate(zip(speeds, heights, strict=True)):
        far = k > 0 and (abs(speed - speeds[k - 1]) > 0.05 * speed or abs(height - heights[k - 1]) > 4.0)
        pause = float(rng.uniform(18.0, 24.0) if far else rng.uniform(8.0, 12.0)) * max(1.0, 4.5 / own)
        at += pause if k > 0 else 0.0
        kind = str(rng.choice(KINDS, p=SHARES))
        series = input_shape(kind, own, rng) * float(rng.choice([-1.0, 1.0]))
        # No more than 0.9 g from the trim.
        wanted = min(float(np.radians(rng.uniform(1.8, 3.4))), 8.8 / (abs(model["Z_alpha"]) * float(speed)))
        reach = 0.75 * aircraft.elevator_reach_rad
        amplitude = min(wanted / peak_alpha(series, model), reach / 1.2)
        begin = at + float(rng.uniform(0.7, 1.8))
        end = begin + series.size * STEP_S
        rest = max(float(rng.uniform(1.5, 3.0)), 8.0 / own)
        maneuvers.append(
            Maneuver(
                kind, at, begin, end, end + rest, float(speed), float(height), amplitude, gains.damper > 0.0
            )
        )
        pieces.append((begin, amplitude * series))
        step = wishes.power if wishes.power > 0.0 else float(rng.uniform(0.0, 0.2) * (rng.random() < 0.35))
        powers.append(
            (float(rng.uniform(begin - 0.3, 0.5 * (begin + end))), step * float(rng.choice([-1.0, 1.0])), end)
        )
        at = end + rest
    count = int((at + 4.0) / STEP_S)
    stick, hands_off, power, stage = (
        np.zeros(count),
        np.zeros(count),
        np.zeros(count),
        np.full(count, len(maneuvers) - 1.0),
    )
    trims = tuple(trim(shape, Faults(), Around(), m.airspeed_m_s, m.height_m) for m in maneuvers)
    for k in reversed(range(len(maneuvers))):
        m, (begin, series), (when, share, until) = maneuvers[k], pieces[k], powers[k]
        stage[: int(m.end_s / STEP_S)] = k
        hands_off[int(m.start_s / STEP_S) : int(m.end_s / STEP_S)] = 1.0
        first = int(begin / STEP_S)
        stick[first : first + series.size] += series
        power[int(when / STEP_S) : int(until / STEP_S)] = share * trims[k].throttle
    smooth = gaussian_filter1d(power, 0.15 / STEP_S)
    return Plan(aircraft, shape, model, own, trims, tuple(maneuvers), stick, hands_off, smooth, stage, gains)


def plain_air(plan: Plan) -> dict[str, Floats]:
    """Calm air and an aircraft as the file has it, a series for each member of ``Around``."""
    return {name: np.full(plan.steps, value) for name, value in Around()._asdict().items()}


def inputs(plan: Plan, around: dict[str, Floats]) -> Inputs:
    """The plan as series; the commanded trim goes over smoothly from one manoeuvre to the next."""
    stage = plan.stage.astype(int)

    def by_stage(name: str) -> Floats:
        values = np.array([getattr(trimmed, name) for trimmed in plan.trims])[stage]
        return np.asarray(gaussian_filter1d(values, 2.5 / STEP_S, mode="nearest"))

    return Inputs(
        stick=plan.stick,
        hands_off=plan.hands_off,
        speed=by_stage("speed"),
        height=by_stage("height"),
        alpha=by_stage("alpha"),
        delta=by_stage("delta"),
        throttle=by_stage("throttle"),
        throttle_step=plan.power,
        remnant=np.zeros(plan.steps) if plan.remnant is None else plan.remnant,
        around=tuple(around[name] for name in Around._fields),
    )


def flown(
    plan: Plan,
    faults: Faults,
    servo: Servo,
    around: dict[str, Floats],
    spoilers: tuple[float, float] = (1e9, -1e9),
) -> Channels:
    """The true channels of the flight."""
    first = trim(
        plan.shape,
        faults,
        Around(*(float(around[name][0]) for name in Around._fields))._replace(updraft=0.0, headwind=0.0),
        plan.trims[0].speed,
        plan.trims[0].height,
    )
    given = inputs(plan, around)
    _, channels = fly(
        first.state, given, plan.shape, faults, servo, plan.gains, spoilers, plan.aircraft.elevator_reach_rad
    )
    return channels


def as_key(plan: Plan) -> dict[str, Any]:
    """The plan as the key tells of it."""
    return {
        "aircraft": asdict(plan.aircraft),
        "linear_model": plan.model,
        "damper_s": plan.gains.damper,
        "maneuvers": [asdict(m) for m in plan.maneuvers],
    }
