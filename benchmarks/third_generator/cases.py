"""Draw a case: what is wrong, the flight, and how far that can be seen."""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.random import Generator

from benchmarks.sealed.tlog import Wiring

from .fleet import Aircraft
from .flight import Channels
from .instruments import draw_instruments
from .named import NAMED, turbulent
from .plan import Plan, Wishes, draw_plan, plain_air
from .servo import Servo
from .setup import Effect, Setup
from .unnamed_motion import MOTION
from .unnamed_sensing import SENSING
from .visible import visibility

SHARES = {"none": 0.20, "one": 0.45, "two": 0.08, "parameters": 0.07, "outside": 0.20}
IN_TURBULENCE = 0.3
LEAST_NAMED = (0.6, 0.3)
"""Least dynamic ratio, and least ratio beyond the parameters, in some channel: units of noise."""
LEAST_OUTSIDE = (1.0, 0.6)
GROWTH = 1.4
MISTAKEN = ("M_alpha", "M_q", "M_delta_e", "Z_alpha", "Z_delta_e")
ATTEMPTS = 25

UNNAMED = {**MOTION, **SENSING}
EFFECTS: dict[str, Effect] = {**NAMED, **UNNAMED}


@dataclass(frozen=True)
class Assignment:
    """A class and the names of what is wrong."""

    kind: str
    names: tuple[str, ...]


@dataclass(frozen=True)
class Wrong:
    """One effect as it is in the flight."""

    name: str
    size: float
    parameters: dict[str, float]
    seen: dict[str, dict[str, float]]


@dataclass(frozen=True)
class Case:
    """All that is true."""

    assignment: Assignment
    setup: Setup
    shown: Channels
    wrong: tuple[Wrong, ...]
    believed: dict[str, float]
    turbulence_rms: float
    wiring: Wiring
    ground_m: float
    noise_seed: int
    troubles: tuple[str, ...] = field(default=())


def assignments(count: int, seed: int, only: str | None) -> list[Assignment]:
    """Classes by their shares; within a class every effect comes once before any comes twice.

    Raises
    ------
    ValueError
        When ``only`` is neither a class nor an effect.
    """
    rng = np.random.default_rng([seed, 0])
    if only in EFFECTS:
        return [Assignment("one" if only in NAMED else "outside", (only,))] * count
    if only is not None and only not in SHARES:
        raise ValueError(f"{only} is neither a class nor an effect; classes: {', '.join(SHARES)}")
    edges = np.round(np.cumsum(list(SHARES.values())) * count).astype(int)
    kinds = [list(SHARES)[int(np.searchsorted(edges, k, side="right"))] for k in range(count)]
    kinds = [only] * count if only is not None else [str(kind) for kind in rng.permutation(kinds)]
    decks = {"one": _deck(list(NAMED), rng), "outside": _deck(list(UNNAMED), rng)}
    return [_assignment(kind, decks, rng) for kind in kinds]


def _deck(names: list[str], rng: Generator):  # type: ignore[no-untyped-def]
    while True:
        yield from (str(name) for name in rng.permutation(names))


def _assignment(kind: str, decks, rng: Generator) -> Assignment:  # type: ignore[no-untyped-def]
    if kind in decks:
        return Assignment(kind, (next(decks[kind]),))
    if kind != "two":
        return Assignment(kind, ())
    while True:
        pair = [str(name) for name in rng.choice(list(NAMED), 2, replace=False)]
        if NAMED[pair[0]].block != NAMED[pair[1]].block:
            return Assignment(kind, tuple(pair))


def _wishes(effects: list[Effect]) -> Wishes:
    out = Wishes()
    for effect in effects:
        wish = effect.wishes
        out = Wishes(
            out.speeds or wish.speeds, out.near_ground or wish.near_ground, max(out.power, wish.power)
        )
    return out


def _base(effects: list[Effect], rng: Generator) -> tuple[Setup, float]:
    """A flight with nothing wrong, and the turbulence that it is flown in."""
    plan = draw_plan(rng, _wishes(effects))
    kit = draw_instruments(plan.aircraft, rng)
    while any(effect.needs_boom for effect in effects) and not kit.boom:
        kit = draw_instruments(plan.aircraft, rng)
    servo = Servo()
    if rng.random() < 0.5:
        servo = Servo(lag_s=float(rng.uniform(0.02, 0.06)), delay_s=float(rng.uniform(0.0, 0.02)))
    setup = Setup(plan, kit, servo, plain_air(plan))
    airy = any(effect.block == "air" for effect in effects)
    wanted = any(effect.in_turbulence for effect in effects) or rng.random() < IN_TURBULENCE
    rms = float(rng.uniform(0.003, 0.012)) * plan.shape.speed_0 if wanted and not airy else 0.0
    return (turbulent(setup, rms, rng) if rms > 0.0 else setup), rms


def _sized(
    setup: Setup, plain: Channels, name: str, rng: Generator, least: tuple[float, float]
) -> Wrong | None:
    """The effect at a size that can be seen; None when no size can."""
    effect = EFFECTS[name]
    size = float(np.exp(rng.uniform(np.log(effect.low), np.log(effect.high))))
    seed = int(rng.integers(1 << 31))
    while size <= effect.most:
        changed, parameters = effect.apply(setup, size, np.random.default_rng(seed))
        try:
            seen = visibility(setup, plain, changed.flight())
        except (ArithmeticError, ValueError):
            return None
        if _enough(effect, seen, least):
            return Wrong(name, size, {**parameters, "seed": float(seed)}, seen)
        size *= GROWTH
    return None


def _enough(effect: Effect, seen: dict[str, dict[str, float]], least: tuple[float, float]) -> bool:
    if not effect.dynamic:
        return max(seen["ratios"].values()) >= 1.0
    return (
        max(seen["dynamic_ratios"].values()) >= least[0]
        and max(seen["beyond_parameters"].values()) >= least[1]
    )


def _believed(setup: Setup, kind: str, rng: Generator) -> dict[str, float]:
    """The file's model: the truth, or two to four derivatives off; the trim stays where it was."""
    model = dict(setup.plan.model)
    if kind == "parameters":
        for name in rng.choice(MISTAKEN, int(rng.integers(2, 5)), replace=False):
            model[str(name)] *= 1.0 + float(rng.choice([-1.0, 1.0])) * float(rng.uniform(0.15, 0.4))
        level = setup.plan.trims[0]
        model["Z_0"] = -model["Z_alpha"] * level.alpha - model["Z_delta_e"] * level.delta
        model["M_0"] = -model["M_alpha"] * level.alpha - model["M_delta_e"] * level.delta
    return model


def draw_case(assignment: Assignment, seed: int, index: int) -> Case:
    """The same seed and index give the same case.

    Raises
    ------
    RuntimeError
        When no flight shows the effect.
    """
    for attempt in range(ATTEMPTS):
        rng = np.random.default_rng([seed, index, attempt])
        case = _attempt(assignment, rng)
        if case is not None:
            return case
    raise RuntimeError(f"{assignment.names}: not visible in {ATTEMPTS} flights")


def _attempt(assignment: Assignment, rng: Generator) -> Case | None:
    effects = [EFFECTS[name] for name in assignment.names]
    try:
        setup, rms = _base(effects, rng)
        plain = setup.flight()
    except (ArithmeticError, ValueError):
        return None
    least = LEAST_OUTSIDE if assignment.kind == "outside" else LEAST_NAMED
    wrong = [_sized(setup, plain, name, rng, least) for name in assignment.names]
    found = tuple(one for one in wrong if one is not None)
    if len(found) < len(wrong):
        return None
    believed = _believed(setup, assignment.kind, rng)
    flown = setup
    for one in found:
        flown, _ = EFFECTS[one.name].apply(
            flown, one.size, np.random.default_rng(int(one.parameters["seed"]))
        )
    try:
        shown = flown.flight()
    except (ArithmeticError, ValueError):
        return None
    clean = tuple(
        replace(one, parameters={key: value for key, value in one.parameters.items() if key != "seed"})
        for one in found
    )
    return Case(
        assignment=assignment,
        setup=flown,
        shown=shown,
        wrong=clean,
        believed=believed,
        turbulence_rms=rms,
        wiring=_wiring(setup.plan, setup.kit.imu_message, rng),
        ground_m=float(rng.uniform(5.0, 600.0)),
        noise_seed=int(rng.integers(1 << 31)),
        troubles=_troubles(setup, rms),
    )


def _wiring(plan: Plan, imu: str, rng: Generator) -> Wiring:
    aircraft: Aircraft = plan.aircraft
    reach = float(np.round(np.degrees(aircraft.elevator_reach_rad), 1))
    low, high = float(rng.integers(1050, 1150)), float(rng.integers(1850, 1950))
    middle, reverse = float(rng.integers(1460, 1540)), bool(rng.random() < 0.5)
    ends = (reach, -reach) if reverse else (-reach, reach)
    return Wiring(
        elevator_output=int(rng.choice([1, 2, 4])),
        reversed=reverse,
        calibration=((low, ends[0]), (middle, 0.0), (high, ends[1])),
        imu=imu,
        boot_s=float(np.round(rng.uniform(20.0, 900.0), 3)),
    )


def _troubles(setup: Setup, rms: float) -> tuple[str, ...]:
    found = {
        "turbulence": rms > 0.0,
        "stamp_jitter": setup.kit.stamp_error_s > 0.0,
        "alpha_made_by_autopilot": setup.kit.sends_alpha and not setup.kit.boom,
        "no_alpha": not setup.kit.sends_alpha,
        "stabilised_mode": setup.plan.gains.damper > 0.0,
    }
    return tuple(name for name, there in found.items() if there)
