"""Manoeuvres that the advice saves: campaigns flown as advised, against campaigns that repeat the standard
input."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from advisor.aircraft.aircraft import Aircraft, CampaignPlan, Limits
from advisor.bundled.study.campaigns import (
    AIRFRAMES,
    UAV,
    NoiselessManeuver,
    NonlinearAircraft,
    Scene,
    as_maneuver,
    estimate_copies,
    fly_named,
    follow,
    noise_scale,
)
from advisor.decision.advice import next_input
from advisor.decision.history import CandidateManeuver, usable_ones
from advisor.decision.information import knowledge
from advisor.decision.inputs import StepInput
from advisor.process.arrays import FloatArray

MOST = 25
"""Number of manoeuvres after which a campaign is given up."""
PLAN = CampaignPlan(rule="information", tolerance_percent=0.5)
"""Plan with a tenth of the default tolerance, so that the advice can save something: at the default two
manoeuvres suffice."""
HEIGHT_M = 100.0


@cache
def scenes() -> Mapping[str, Scene]:
    """Return the paper's aircraft, and the linearised bundled UAV."""
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
    """Manoeuvres that each campaign needed with the standard input in alternating directions."""
    advised: tuple[int, ...]
    """Manoeuvres that each campaign needed when each input was flown as advised."""

    @property
    def percent(self) -> float:
        """Mean saving of manoeuvres, in percent."""
        return 100.0 * (1.0 - float(np.mean(self.advised) / np.mean(self.standard)))


CASES = (("twin jet", 10.0), ("UAV", 5.0))
"""Aircraft and noise in percent at which the standard input needs about ten manoeuvres."""


@dataclass(frozen=True, slots=True)
class Pair:
    """A campaign that is flown twice from one first manoeuvre: by repetition and as advised."""

    aircraft: str
    noise_percent: float
    same_excursion: bool
    seed: tuple[int, ...]
    campaigns: int = 1


def pairs(campaigns: int, seed: int, cases: Sequence[tuple[str, float]] = CASES) -> list[Pair]:
    """Return every pair of campaigns of the study, each with a seed of its own."""
    return [
        Pair(name, noise, same, (seed, round(100 * noise), same, number))
        for name, noise in cases
        for same in (True, False)
        for number in range(campaigns)
    ]


def savings(flown: Sequence[Pair], needed: Sequence[tuple[int, int]]) -> list[Saving]:
    """Return the saving in each case.

    Parameters
    ----------
    needed
        Result of :func:`fly` for each pair.
    """
    by_case: dict[tuple[str, float, bool], list[tuple[int, int]]] = {}
    for pair, numbers in zip(flown, needed, strict=True):
        by_case.setdefault((pair.aircraft, pair.noise_percent, pair.same_excursion), []).append(numbers)
    return [Saving(*case, *map(tuple, zip(*numbers, strict=True))) for case, numbers in by_case.items()]


def fly(pair: Pair) -> tuple[int, int]:
    """Return the manoeuvres that the campaign needs by repetition of the standard input, and as advised."""
    scene, rng = scenes()[pair.aircraft], np.random.default_rng(pair.seed)
    named = {name: fly_named(scene, name) for name in ("3211", "rev")}
    noise = 0.01 * pair.noise_percent * noise_scale(named["3211"], "std")
    first = _flown(scene, named["3211"], noise, rng)
    crew = _crew(scene, named["3211"], pair.same_excursion)

    def standard(history: list[CandidateManeuver]) -> NoiselessManeuver:
        return named["rev" if len(history) % 2 else "3211"]

    def advised(history: list[CandidateManeuver]) -> NoiselessManeuver:
        option = next_input(history, crew).input
        return standard(history) if option is None else fly_input(scene, option)

    return _needed(scene, first, standard, noise, rng), _needed(scene, first, advised, noise, rng)


def _needed(
    scene: Scene,
    first: CandidateManeuver,
    choose: Callable[[list[CandidateManeuver]], NoiselessManeuver],
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


def fly_input(scene: Scene, option: StepInput) -> NoiselessManeuver:
    """Fly an advised input, with a free response as long as the standard input's."""
    free = scene.duration_s - scene.lead_s - 7.0 * scene.unit_s
    length = scene.lead_s + option.duration_s + free
    t = np.arange(round(length * scene.rate_hz) + 1) / scene.rate_hz
    _, trim = scene.aircraft.trim()
    return follow(scene, t, option.elevator(trim, scene.lead_s, length).at(t))


def _crew(scene: Scene, standard: NoiselessManeuver, same: bool) -> Aircraft:
    """Return the aircraft file, with an angle-of-attack limit where excursions are limited."""
    limits = Limits()
    if same:
        # The advice keeps a margin of a tenth to the limit; the limit is set so that the standard
        # input's own excursion is just allowed.
        excursion = float(np.max(np.abs(standard.response[:, 0] - standard.trim[0])))
        limits = Limits(alpha_deg=float(np.degrees((excursion + standard.trim[0]) / 0.9)))
    return replace(Aircraft(), campaign=PLAN, limits=limits)


def _flown(
    scene: Scene, flight: NoiselessManeuver, noise: FloatArray, rng: np.random.Generator
) -> CandidateManeuver:
    """Measure and estimate one manoeuvre, with the data that the advice needs."""
    (estimate,) = estimate_copies(flight, noise, 1, rng)
    return CandidateManeuver(estimate, maneuver=as_maneuver(flight))
