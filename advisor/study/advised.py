"""What following the advice saves: campaigns flown as advised beside those that repeat the standard input."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.aircraft import Aircraft, CampaignPlan, Limits
from advisor.decision.advice import recommended
from advisor.decision.history import Flown, usable_ones
from advisor.decision.information import knowledge
from advisor.decision.inputs import StepInput
from advisor.flight.messages import FloatArray
from advisor.study.estimating import Advance, estimate_copies
from advisor.study.flying import Flight, Scene, as_maneuver, fly_named, follow, noise_scale
from advisor.study.simulator import AIRFRAMES, UAV, NonlinearAircraft

MOST = 25
"""A campaign is given up after so many manoeuvres."""
PLAN = CampaignPlan(rule="information", tolerance_percent=0.5)
"""A tenth of the default tolerance, so that there is something to save: at the default two manoeuvres do."""
HEIGHT_M = 100.0


def scenes() -> Mapping[str, Scene]:
    """Return the paper's aircraft, and the bundled UAV as linear as its own linearisation is."""
    habits = AIRFRAMES["uav"][1]
    uav = NonlinearAircraft(UAV, habits.airspeed_m_s, HEIGHT_M).truth
    return {
        "twin jet": Scene(),
        "UAV": Scene(
            aircraft=uav,
            unit_s=habits.unit_s,
            amplitude_rad=float(np.radians(habits.amplitude_deg)),
            duration_s=6.0,
        ),
    }


@dataclass(frozen=True, slots=True)
class Saving:
    """One aircraft at one noise level."""

    aircraft: str
    noise_percent: float
    same_excursion: bool
    """Whether the advised inputs were held to the standard input's angles of attack."""
    standard: tuple[int, ...]
    """Manoeuvres each campaign needed, repeating the standard input in alternating directions."""
    advised: tuple[int, ...]
    """The same, flying what was advised after each manoeuvre."""

    @property
    def percent(self) -> float:
        """Fewer manoeuvres on average, in percent."""
        return 100.0 * (1.0 - float(np.mean(self.advised) / np.mean(self.standard)))


CASES = (("twin jet", 10.0), ("UAV", 5.0))
"""Aircraft and noise in percent at which the standard input needs about ten manoeuvres."""


def measure(
    campaigns: int, seed: int, advance: Advance | None = None, cases: Sequence[tuple[str, float]] = CASES
) -> list[Saving]:
    """Fly every campaign twice, from the same first manoeuvre."""
    savings = []
    for name, noise in cases:
        scene = scenes()[name]
        for same in (True, False):
            rng = np.random.default_rng([seed, round(100 * noise), same])
            pairs = [_both(scene, noise, same, rng, advance) for _ in range(campaigns)]
            savings.append(Saving(name, noise, same, tuple(s for s, _ in pairs), tuple(a for _, a in pairs)))
    return savings


def _both(
    scene: Scene, noise_percent: float, same: bool, rng: np.random.Generator, advance: Advance | None
) -> tuple[int, int]:
    named = {name: fly_named(scene, name) for name in ("3211", "rev")}
    noise = 0.01 * noise_percent * noise_scale(named["3211"], "std")
    first = _flown(scene, named["3211"], noise, rng)
    crew = _crew(scene, named["3211"], same)

    def standard(history: list[Flown]) -> Flight:
        return named["rev" if len(history) % 2 else "3211"]

    def advised(history: list[Flown]) -> Flight:
        option = recommended(history, crew)
        return standard(history) if option is None else fly_input(scene, option)

    needed = tuple(_needed(scene, first, choose, noise, rng) for choose in (standard, advised))
    if advance is not None:
        advance(1)
    return needed[0], needed[1]


def _needed(
    scene: Scene,
    first: Flown,
    choose: Callable[[list[Flown]], Flight],
    noise: FloatArray,
    rng: np.random.Generator,
) -> int:
    history = [first]
    while len(history) < MOST:
        known = knowledge(usable_ones(history), PLAN)
        if known.sufficient:
            break
        history.append(_flown(scene, choose(history), noise, rng))
    return len(history)


def fly_input(scene: Scene, option: StepInput) -> Flight:
    """Fly an advised input, with as long a free response as the standard input leaves."""
    free = scene.duration_s - scene.lead_s - 7.0 * scene.unit_s
    length = scene.lead_s + option.duration_s + free
    t = np.arange(round(length * scene.rate_hz) + 1) / scene.rate_hz
    _, trim = scene.aircraft.trim()
    return follow(scene, t, option.elevator(trim, scene.lead_s, length).at(t))


def _crew(scene: Scene, standard: Flight, same: bool) -> Aircraft:
    """Return the aircraft file, with an angle-of-attack limit where excursions are held."""
    limits = Limits()
    if same:
        # The advice keeps a margin of a tenth to the limit; the limit is set so that the standard
        # input's own excursion is just allowed.
        excursion = float(np.max(np.abs(standard.response[:, 0] - standard.trim[0])))
        limits = Limits(alpha_deg=float(np.degrees((excursion + standard.trim[0]) / 0.9)))
    return replace(Aircraft(), campaign=PLAN, limits=limits)


def _flown(scene: Scene, flight: Flight, noise: FloatArray, rng: np.random.Generator) -> Flown:
    """Measure and estimate one manoeuvre, with what the advice looks at."""
    (estimate,) = estimate_copies(flight, noise, 1, rng)
    return Flown(estimate, maneuver=as_maneuver(flight))
