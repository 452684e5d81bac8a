"""Draw one case from its seed: aircraft, condition, plan, effects, noise, recorder."""

from dataclasses import dataclass, replace

import numpy as np

from benchmarks.sealed.tlog import Wiring

from .actuator import Servo
from .aircraft import FLEET, scattered
from .atmosphere import dryden, still_air
from .belief import believed_model
from .catalogue import NAMED
from .design import Assignment
from .effects import Experiment
from .equipment import draw_noise, draw_recorder, draw_wiring
from .flight import Link
from .flight_model import plain_model
from .maneuvers import Plan
from .nature import SHARE, Nature, draw_nature
from .pilot import suitable_pilot
from .planning import STEP, Wishes, draw_plan
from .sensors import Accelerometer, Instruments, Vane
from .telemetry import Noise, Recorder
from .trim import LinearModel, linearised, trimmed
from .visibility import NAMED_RATIO, OUTSIDE_RATIO, Flown, Sized, fly_experiment, flyable, sized

OFF_CENTRE = "imu off the centre of gravity"
TROUBLES = ("turbulence", "coloured noise", "jitter", "speed changes", OFF_CENTRE)
MODEL_SHARE, HARD_SHARE = 0.66, 0.40
LARGEST_SPEED_CHANGE = 0.14


@dataclass(frozen=True)
class Case:
    """One drawn case, flown: everything that its files and its key are written from."""

    assignment: Assignment
    experiment: Experiment
    flown: Flown
    effects: tuple[Sized, ...]
    troubles: tuple[str, ...]
    background_rms: float
    noise: Noise
    recorder: Recorder
    wiring: Wiring
    believed: LinearModel | None
    stated_arms: dict[str, float | None]
    record_seed: int
    nature: Nature


def largest_speed_change(plan: Plan, flown: Flown) -> float:
    """Largest change of airspeed within a manoeuvre, as a share."""
    parts = (flown.truth.airspeed[part] for part in plan.during_maneuvers())
    return max(float(np.ptp(part) / part[0]) for part in parts)


def _experiment(wishes: Wishes, digital: bool, wiring: Wiring, seed: int, attempt: int) -> Experiment:
    """The case in still air with ideal instruments; each attempt plans another flight."""
    rng = np.random.default_rng(seed)
    aircraft = scattered(FLEET[int(rng.integers(len(FLEET)))], rng)
    height = 60.0 + 4.0 * aircraft.span_m
    model = trimmed(plain_model(aircraft), height)
    linear = linearised(model, height)
    plan = draw_plan(aircraft, linear, wishes, np.random.default_rng([seed, attempt]))
    count = len(plan.offset)
    # A digital command is renewed at the rate it is logged at; otherwise the command moves all the time.
    slow = [5, 10, 20] if linear.natural_frequency < 6.0 else [5, 10]
    period = int(rng.choice(slow)) if digital else 1
    low, high = wiring.calibration[0], wiring.calibration[-1]
    resolution = abs(np.radians(high[1] - low[1]) / (high[0] - low[0]))
    return Experiment(
        aircraft=aircraft,
        linear=linear,
        model=model,
        plan=plan,
        air=still_air(count),
        servo=Servo(),
        link=Link(period, float(resolution), float(np.radians(wiring.calibration[1][1]))),
        pilot=suitable_pilot(linear, float(rng.uniform(0.7, 1.2))),
        instruments=Instruments(),
        cg_aft=np.zeros(count),
        mass_added=np.zeros(count),
        ice=np.zeros(count),
        moment_added=np.zeros(count),
        delay=np.zeros(count),
        dropout=np.zeros(count),
    )


def suitable_experiment(wishes: Wishes, digital: bool, wiring: Wiring, seed: int) -> Experiment:
    """The experiment with manoeuvres gentle enough for the speed, and high enough above the ground."""
    for attempt in range(12):
        case = _experiment(wishes, digital, wiring, seed, attempt)
        flown = fly_experiment(case, 0)
        lowest = float(np.min(flown.truth.height)) - 0.1 * case.aircraft.span_m
        if not flyable(case, flown) or largest_speed_change(case.plan, flown) > LARGEST_SPEED_CHANGE:
            wishes = replace(wishes, amplitude=0.88 * wishes.amplitude)
        elif lowest < 0.0:
            wishes = replace(wishes, extra_height=wishes.extra_height - lowest)
        else:
            return case
    raise ValueError(f"no plan suits {case.aircraft.name}")


def _draw_troubles(assignment: Assignment, rng: np.random.Generator) -> tuple[str, ...]:
    """At least two troubles in a hard condition, none in a clean one."""
    hard = bool(rng.random() < HARD_SHARE)
    possible = list(TROUBLES)
    if "accelerometer_offset" in assignment.names:
        # An arm that the aircraft file states would hide the one that it does not.
        possible.remove(OFF_CENTRE)
    chosen = rng.choice(possible, int(rng.integers(2, len(possible) + 1)), replace=False).tolist()
    return tuple(trouble for trouble in possible if hard and trouble in chosen)


def _draw_wishes(
    assignment: Assignment, troubles: tuple[str, ...], digital: bool, rng: np.random.Generator
) -> Wishes:
    """What the effects need; some of it happens in flights where nothing depends on it, too."""
    needs = {effect.needs for effect in assignment.effects}
    power, low = bool(rng.random() < 0.2), bool(rng.random() < 0.12)
    ramp = float(rng.uniform(0.03, 0.08))
    return Wishes(
        speed_share=0.18 if "speed" in needs else 0.06 if "speed changes" in troubles else 0.0,
        power_share=0.45 if power or "power" in needs else 0.0,
        low=low or "low" in needs,
        ramp=0.0 if digital else ramp,
    )


def _in_background_air(case: Experiment, seed: int) -> tuple[Experiment, float]:
    """The case in light turbulence, and the turbulence's rms [m/s]."""
    rng = np.random.default_rng(seed)
    speed = case.aircraft.airspeed_m_s
    rms, length = float(rng.uniform(0.003, 0.008)) * speed, float(rng.uniform(1.5, 5.0)) * speed
    air = dryden(rng, len(case.time), STEP, speed, (rms, rms), length, case.aircraft.span_m)
    return replace(case, air=air), rms


def _with_arms(
    case: Experiment, assignment: Assignment, off_centre: bool, rng: np.random.Generator
) -> tuple[Experiment, dict[str, float | None]]:
    """The case with instruments in their places, and the places that its aircraft file states.

    A stated arm is no gap. Where an arm is the effect, the file says zero, or that it is unknown.
    """
    scale = case.aircraft.arm_scale_m
    stated: dict[str, float | None] = {
        name: 0.0 if rng.random() < 0.5 else None for name in ("vane", "accelerometer")
    }
    vane = Vane()
    if rng.random() < 0.3 and "alpha_vane_offset" not in assignment.names:
        vane = Vane(arm=float(rng.uniform(0.2, 0.8)) * scale)
        stated["vane"] = vane.arm
    accelerometer = Accelerometer()
    if off_centre:
        accelerometer = Accelerometer(arm=float(rng.uniform(-0.5, 0.5)) * scale)
        stated["accelerometer"] = accelerometer.arm
    return replace(case, instruments=Instruments(vane=vane, accelerometer=accelerometer)), stated


def _with_effects(
    plain: Experiment, assignment: Assignment, noise: Noise, seed: int, sensor_seed: int
) -> tuple[Experiment, tuple[Sized, ...]]:
    """The case with all its effects, each of the size at which it is visible alone."""
    case, effects = plain, []
    flown = fly_experiment(plain, sensor_seed)
    for number, effect in enumerate(assignment.effects):
        wanted = NAMED_RATIO if effect in NAMED else OUTSIDE_RATIO
        own_seed = seed + 10 * number
        _, fitted = sized(plain, flown, effect, noise, wanted, own_seed, sensor_seed)
        case, _ = effect.change(case, fitted.size, np.random.default_rng(own_seed + 1))
        effects.append(fitted)
    return case, tuple(effects)


def draw_case(assignment: Assignment, seed: int, index: int, natural_share: float = SHARE) -> Case:
    """Draw and fly one case. Design, plan, air, effects and noise have generators of their own."""
    seeds = np.random.SeedSequence([seed, index]).generate_state(5).tolist()
    design_seed, plan_seed, air_seed, effect_seed, record_seed = seeds
    rng = np.random.default_rng(design_seed)
    troubles = _draw_troubles(assignment, rng)
    digital = bool(rng.random() < 0.5)
    wishes = _draw_wishes(assignment, troubles, digital, rng)
    wiring = draw_wiring(rng)
    noise = draw_noise(rng, "coloured noise" in troubles)
    plain = suitable_experiment(wishes, digital, wiring, plan_seed)
    background_rms = 0.0
    if "turbulence" in troubles:
        plain, background_rms = _in_background_air(plain, air_seed)
    plain, stated = _with_arms(plain, assignment, OFF_CENTRE in troubles, rng)
    case, effects = _with_effects(plain, assignment, noise, effect_seed, record_seed)
    flown = fly_experiment(case, record_seed)
    if not flyable(case, flown):
        raise ValueError(f"case {index} of seed {seed} cannot be flown")
    wrong = assignment.kind == "parameters"
    believed = None
    if wrong or rng.random() < MODEL_SHARE:
        trim = (plain.model.alpha, plain.model.elevator)
        believed = believed_model(case.linear, case.plan, trim, wrong, noise, rng)
    jitter = 0.004 if "jitter" in troubles else 0.0003
    return Case(
        assignment=assignment,
        experiment=case,
        flown=flown,
        effects=effects,
        troubles=troubles,
        background_rms=background_rms,
        noise=noise,
        recorder=draw_recorder(rng, case.omega, case.link.period, jitter, digital),
        wiring=wiring,
        believed=believed,
        stated_arms=stated,
        record_seed=record_seed,
        nature=draw_nature(
            np.random.default_rng([record_seed, 3]),
            assignment.names,
            case.aircraft.elevation_m + float(flown.truth.height[0]),
            natural_share,
        ),
    )
