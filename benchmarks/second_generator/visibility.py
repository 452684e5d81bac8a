"""Fly an experiment, with and without its effect, and say how plainly the effect is there."""

from dataclasses import dataclass

import numpy as np

from .effects import Effect, Experiment, Parameters
from .flight import Truth, from_trim
from .kernel import Floats
from .sensors import observe
from .telemetry import Noise

CHANNELS = ("alpha", "q", "theta", "a_x", "a_z")
NAMED_RATIO, OUTSIDE_RATIO = 0.5, 1.0
ATTEMPTS = 14


@dataclass(frozen=True)
class Flown:
    """A flight and what its instruments showed, without noise."""

    truth: Truth
    observed: dict[str, Floats]


@dataclass(frozen=True)
class Sized:
    """An effect at the size it was flown, with the ratios that say how visible it is."""

    effect: Effect
    size: float
    parameters: Parameters
    ratios: dict[str, float]
    dynamic_ratios: dict[str, float]

    @property
    def largest_dynamic_ratio(self) -> float:
        """The plainest channel's dynamic ratio."""
        return max(self.dynamic_ratios.values())


def fly_experiment(case: Experiment, sensor_seed: int) -> Flown:
    """Fly and look at the instruments; whatever the instruments draw comes from the seed."""
    truth = from_trim(case.plan.step, case.model, case.servo, case.link, case.pilot, case.schedule())
    return Flown(truth, observe(truth, case.instruments, case.plan.step, np.random.default_rng(sensor_seed)))


def flyable(case: Experiment, flown: Flown) -> bool:
    """The aircraft stayed in the air, and within the angles that the model is good for."""
    truth = flown.truth
    if not all(np.all(np.isfinite(channel)) for channel in truth):
        return False
    speed = truth.airspeed / case.aircraft.airspeed_m_s
    alpha = np.abs(truth.alpha - case.model.alpha)
    return bool(np.max(alpha) < np.radians(14.0) and np.min(speed) > 0.6 and np.max(speed) < 1.5)


def ratios(case: Experiment, one: Flown, other: Flown, noise: Noise, without_means: bool) -> dict[str, float]:
    """RMS difference of two flights during the manoeuvres over the instrument's noise, a channel."""
    result = {}
    for channel in CHANNELS:
        parts = []
        for part in case.plan.during_maneuvers():
            difference = one.observed[channel][part] - other.observed[channel][part]
            parts.append(difference - np.mean(difference) if without_means else difference)
        result[channel] = float(np.sqrt(np.mean(np.concatenate(parts) ** 2))) / noise.of(channel)
    return result


def sized(
    case: Experiment,
    plain: Flown,
    effect: Effect,
    noise: Noise,
    wanted: float,
    seed: int,
    sensor_seed: int,
) -> tuple[Experiment, Sized]:
    """Draw the effect's size until it can be seen and flown; return the experiment with it.

    `plain` is the flight without it, `wanted` the dynamic ratio to reach in the plainest channel.
    Every attempt draws the same directions and kinds, so that only the size changes.
    """
    size = float(np.exp(np.random.default_rng(seed).uniform(np.log(0.35), np.log(1.8))))
    accepted = None
    for _ in range(ATTEMPTS):
        changed, parameters = effect.change(case, size, np.random.default_rng(seed + 1))
        flown = fly_experiment(changed, sensor_seed)
        if not flyable(changed, flown):
            size *= 0.7
            continue
        with_means = ratios(case, flown, plain, noise, without_means=False)
        dynamic = ratios(case, flown, plain, noise, without_means=True)
        accepted = changed, Sized(effect, size, parameters, with_means, dynamic)
        if not effect.dynamic or accepted[1].largest_dynamic_ratio >= wanted:
            return accepted
        size *= 1.4
    if accepted is None:
        raise ValueError(f"{effect.name} cannot be flown by {case.aircraft.name}")
    return accepted
