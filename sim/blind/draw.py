"""Random draw of a case: aircraft, manoeuvres, air, noise, and the withheld effect."""

from dataclasses import dataclass, field, replace
from typing import Any, Literal, get_args

import numpy as np

from .. import hangar
from ..effects.fitting import KINDS, flight_of, without_effects
from ..flight import Sample, noise_sigma
from ..linear import ShortPeriod
from ..loading import DepartureError
from ..scenario import Air, Clock, Instruments, Maneuver, Noise, Scenario
from ..trim import TrimError
from .natural import SHARE, natural, without_vane_noise
from .sizes import INSIDE, ON_ANY_ENGINE, OUTSIDE, Scale
from .visibility import structural_gap

Group = Literal["clean", "hard", "jsbsim", "none", "parameters", "outside", "two", "simulator"]
GROUPS: tuple[Group, ...] = get_args(Group)
SHARES = (0.34, 0.20, 0.08, 0.18, 0.04, 0.10, 0.06, 0.0)
"""Default share of each group among the cases. ``simulator`` is drawn on request only."""

SMALLEST_GAP = 0.05
"""Least structural gap above the noise, for a visible effect. A case with a smaller gap is drawn again."""

IN_TURNS, STEEPEST_DEG = 0.3, 25.0
"""Share of the flights with manoeuvres in turns, and the steepest bank, deg."""

ATTEMPTS = 10
OFFSETS = ("alpha_bias", "pitch_rate_bias")
"""Offsets that a manoeuvre's nuisance parameters absorb. Only kinematics show these offsets, so only their
size matters."""


@dataclass(frozen=True)
class Case:
    """One sealed case: the flight, and the right answer."""

    group: Group
    scenario: Scenario
    prior: ShortPeriod
    """Prior model of the simulator, for ``model`` in the aircraft file."""
    effects: dict[str, dict[str, float]]
    blocks: list[str]
    gap: float
    """Structural gap of the case above the noise."""
    hard: bool
    background: list[str] = field(default_factory=list)
    """Disturbances of a hard case in addition to the effect."""

    @property
    def kind(self) -> str:
        """Kind of the case, by the names of ``judge``."""
        return "one" if self.group in ("clean", "hard", "jsbsim") else self.group

    @property
    def condition(self) -> str:
        """Difficulty of the flight in one word."""
        return "JSBSim" if self.group == "jsbsim" else "hard" if self.hard else "clean"

    def key(self) -> dict[str, Any]:
        """Return the content of the sealed key for this case."""
        return {
            "kind": self.kind,
            "condition": self.condition,
            "effects": self.effects,
            "blocks": self.blocks,
            "gap": self.gap,
            "background": self.background,
            "aircraft": self.scenario.aircraft,
        }


def draw_case(group: Group, generator: np.random.Generator, natural_share: float = SHARE) -> Case:
    """Draw a case until its effect is visible above the noise.

    Parameters
    ----------
    group
        Group of cases to draw from.
    generator
        Random generator of all draws.
    natural_share
        Share of the cases with natural nuisances.

    Raises
    ------
    RuntimeError
        No draw of the group was visible, which means that sizes and noise do not match.
    """
    hard = group == "hard" or (group in ("none", "outside", "two") and generator.random() < 0.3)
    for _ in range(40):
        names = _names(group, generator)
        scenario, background = scenario_of(group, names, hard, generator)
        if np.random.default_rng([scenario.seed, 76]).random() < natural_share:
            scenario = natural(scenario, names, hangar.habits(scenario).airspeed_m_s / 25.0)
            background = [*background, "natural"]
        try:
            case = sized(group, scenario, names, hard, background, generator)
        except TrimError:
            # An airframe, a speed and an effect that do not match are drawn again.
            continue
        if case is not None:
            return replace(case, scenario=without_vane_noise(case.scenario))
    raise RuntimeError(f"no visible case of group {group}")


def _names(group: Group, generator: np.random.Generator) -> list[str]:
    if group in ("none", "parameters"):
        return []
    if group == "jsbsim":
        return [str(generator.choice(ON_ANY_ENGINE))]
    if group == "outside":
        return [str(generator.choice(sorted(OUTSIDE)))]
    known = [name for name in sorted(INSIDE) if group == "clean" or name not in ("turbulence", "gust")]
    first = str(generator.choice(known))
    if group != "two":
        return [first]
    others = [name for name in known if KINDS[name].block != KINDS[first].block and name not in OFFSETS]
    return [first, str(generator.choice(others))]


def scenario_of(
    group: Group, names: list[str], hard: bool, generator: np.random.Generator
) -> tuple[Scenario, list[str]]:
    """Draw all properties of a case except the effect's sizes."""
    uniform = generator.uniform
    engine: Literal["bundled", "jsbsim"] = "jsbsim" if group == "jsbsim" else "bundled"
    aircraft = "c172p" if engine == "jsbsim" else ("uav" if generator.random() < 0.55 else "light")
    usual = hangar.habits(Scenario(aircraft=aircraft, engine=engine))
    span = 1.0 if engine == "jsbsim" else hangar.AIRFRAMES[aircraft][0].span
    low = "ground_effect" in names or (engine == "bundled" and generator.random() < 0.2)
    fast = generator.random() < 0.15
    turning = engine == "bundled" and generator.random() < IN_TURNS
    background: list[str] = []
    air, clock, instruments, colour = Air(), Clock(boot_s=float(uniform(20.0, 900.0))), Instruments(), 0.0
    if hard:
        length = usual.airspeed_m_s / 25.0
        air = Air(turbulence_m_s=float(uniform(0.05, 0.15)) * length, length_m=60.0 * length)
        clock = replace(clock, jitter_s=0.004)
        instruments = Instruments(float(uniform(-0.3, 0.3)) * length)
        colour = float(uniform(0.3, 0.8))
        background = ["turbulence"]
    order = ["3211", "rev", "doublet", "rev", "3211", "121", "3211", "rev", "doublet"]
    maneuvers = tuple(
        Maneuver(
            input=name,
            amplitude_deg=usual.amplitude_deg * float(generator.choice([0.6, 1.0, 1.3])),
            throttle_change=float(uniform(-0.2, 0.2))
            if generator.random() < 0.4 and engine == "bundled"
            else 0.0,
            bank_deg=float(uniform(-STEEPEST_DEG, STEEPEST_DEG)) if turning else 0.0,
        )
        for name in generator.permutation(order)
    )
    scenario = Scenario(
        aircraft=aircraft,
        engine=engine,
        seed=int(generator.integers(2**31)),
        loop_hz=250.0 if fast else 50.0,
        airspeed_m_s=usual.airspeed_m_s * float(uniform(0.9, 1.12)),
        height_m=1000.0
        if engine == "jsbsim"
        else float(uniform(1.2, 2.5)) * span
        if low
        else float(uniform(80, 400)),
        lead_in_s=6.0,
        free_s=float(uniform(3.0, 4.0)),
        gap_s=6.0,
        unit_s=round(usual.unit_s * float(generator.choice([0.8, 1.0, 1.2])), 2),
        maneuvers=maneuvers,
        input="held" if not fast and generator.random() < 0.3 else "linear",
        speed="free" if hard or engine == "jsbsim" else "held",
        noise=_noise(generator, colour),
        instruments=instruments,
        air=air,
        clock=clock,
        airframe=_airframe(aircraft, generator) if engine == "bundled" else {},
    )
    return scenario, background


def _noise(generator: np.random.Generator, colour: float) -> Noise:
    """Return white noise whose size lies between good flight-test instruments and a hobby autopilot."""
    level = float(np.exp(generator.uniform(np.log(0.4), np.log(2.0))))

    def about(value: float) -> float:
        return value * level * float(generator.uniform(0.7, 1.4))

    return Noise(
        alpha_deg=about(0.06),
        pitch_rate_deg_s=about(0.15),
        pitch_deg=about(0.05),
        accelerometer_m_s2=about(0.05),
        airspeed_m_s=about(0.06),
        climb_m_s=about(0.05),
        colour=colour,
    )


def _airframe(aircraft: str, generator: np.random.Generator) -> dict[str, float]:
    """Return a different aircraft of one class, with its main properties changed by up to a fifth."""
    base = hangar.AIRFRAMES[aircraft][0]
    names = ("mass", "iyy", "cl_alpha", "cl_q", "cl_delta_e", "cm_alpha", "cm_q", "cm_delta_e")
    return {name: getattr(base, name) * float(generator.uniform(0.82, 1.2)) for name in names}


def sized(
    group: Group,
    scenario: Scenario,
    names: list[str],
    hard: bool,
    background: list[str],
    generator: np.random.Generator,
) -> Case | None:
    """Draw sizes until the effect is visible; return None if the flight cannot show it."""
    quiet = replace(scenario, noise=Noise(), air=Air(), clock=replace(scenario.clock, jitter_s=0.0))
    flight = flight_of(without_effects(quiet))
    truth = flight.engine.truth
    prior = _prior_of(truth, generator) if group == "parameters" else truth
    if not names:
        return Case(group, scenario, prior, {}, [], 0.0, hard, background)
    plain = list(flight.samples())
    scale = _scale(scenario, plain)
    sigma = noise_sigma(scenario)
    for _ in range(ATTEMPTS):
        effects = {name: (INSIDE.get(name) or OUTSIDE[name])(scale, generator) for name in names}
        gaps = [
            _gap(name, replace(quiet, effects={name: sizes}), plain, truth, sigma)
            for name, sizes in effects.items()
        ]
        if min(gaps) >= SMALLEST_GAP:
            blocks = [KINDS[name].block for name in names]
            return Case(
                group,
                replace(scenario, effects=effects),
                prior,
                effects,
                blocks,
                min(gaps),
                hard,
                background,
            )
    return None


def _gap(
    name: str, scenario: Scenario, plain: list[Sample], truth: ShortPeriod, sigma: dict[str, float]
) -> float:
    if name in OFFSETS:
        channel, size = ("alpha", "bias_rad") if name == "alpha_bias" else ("q", "bias_rad_s")
        return (scenario.effects[name][size] / sigma[channel]) ** 2
    try:
        changed = list(flight_of(scenario).samples())
    except DepartureError:
        return 0.0
    motions = np.array([(s.motion.airspeed, s.motion.height, s.motion.alpha) for s in changed])
    if not np.isfinite(motions).all() or motions[:, 1].min() < 0.0 or np.abs(motions[:, 2]).max() > 0.35:
        return 0.0
    return structural_gap(plain, changed, truth, sigma, 1.0 / scenario.loop_hz)


def _scale(scenario: Scenario, plain: list[Sample]) -> Scale:
    flown = [sample for sample in plain if sample.flying]
    amplitude = float(np.ptp([sample.motion.elevator for sample in flown])) / 2
    swing = float(np.ptp([sample.motion.alpha for sample in flown])) / 2
    speed = plain[0].motion.airspeed / 25.0
    if scenario.engine == "jsbsim":
        return Scale(4.0, 1.5, amplitude, swing, speed)
    base = hangar.AIRFRAMES[scenario.aircraft][0]
    fields = {name: scenario.airframe[name] for name in ("cl_alpha", "cm_alpha", "cm_delta_e")}
    return Scale(1.0 if scenario.aircraft == "uav" else 4.0, base.chord, amplitude, swing, speed, **fields)


def _prior_of(truth: ShortPeriod, generator: np.random.Generator) -> ShortPeriod:
    """Return a simulator with the right structure, and with derivatives wrong by 10 to 30 percent."""
    values = truth.as_dict()
    for name in ("Z_alpha", "M_alpha", "M_q", "M_delta_e"):
        values[name] *= 1.0 + float(generator.choice([-1, 1]) * generator.uniform(0.1, 0.3))
    return ShortPeriod(**values)
