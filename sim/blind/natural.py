"""Nuisances natural to every flight: delays, filters, thin air, light gusts.

A third of the flights have such nuisances. A diagnosis that calls a natural nuisance a cause would find a
cause in every real flight.
"""

from dataclasses import replace
from typing import Literal

import numpy as np

from ..faults import Faults, Filters
from ..faulty import standard_air
from ..scenario import Air, AlphaSensor, Scenario

SHARE = 1.0 / 3.0
"""Share of the flights with natural nuisances."""
_COMMAND_S = (-0.006, 0.010)
"""Range of the delay between a command's stamp and its effect, s, over 28 flights of one autopilot."""
_ALPHA_S = (0.02, 0.09)
"""Range of the lag of an autopilot's computed angle of attack, s."""
_CUTOFFS_HZ = (15.0, 20.0, 30.0)
"""Usual cut-offs of an autopilot's filters, Hz."""
_USUAL_HZ = 20.0
"""Cut-off of ArduPilot's filters by default, Hz."""
_STANDARD_DEVIATIONS = (
    "percent",
    "alpha_deg",
    "pitch_rate_deg_s",
    "pitch_deg",
    "accelerometer_m_s2",
    "airspeed_m_s",
    "climb_m_s",
)
"""Fields of the noise that are standard deviations."""
_HIGHEST_M = 2500.0
"""Largest height of the ground above sea level, m."""
_GUSTS_M_S = (0.02, 0.08)
"""Range of the natural turbulence, m/s at 25 m/s."""
OF_ALPHA = frozenset({"alpha_lag", "alpha_scale", "alpha_bias", "alpha_vane_offset", "alpha_skew"})
"""Effects of a vane, which no computed angle of attack has."""
OF_THE_AIR = frozenset({"turbulence", "gust"})


def natural(scenario: Scenario, names: list[str], speed_share: float) -> Scenario:
    """Return the scenario with natural nuisances, drawn by the scenario's own seed.

    Parameters
    ----------
    scenario, names
        Scenario without its effects, and the names of the effects.
    speed_share
        Air speed relative to 25 m/s. Gusts are scaled to a constant angle.
    """
    generator = np.random.default_rng([scenario.seed, 77])
    uniform = generator.uniform
    parameters: Literal["stated", "withheld"] = "stated" if generator.random() < 0.5 else "withheld"
    cutoff_hz = float(generator.choice(_CUTOFFS_HZ))
    faults = Faults(
        filters=Filters(cutoff_hz, cutoff_hz, parameters) if generator.random() < 0.5 else Filters(),
        command_late_s=float(uniform(*_COMMAND_S)),
        thin_air_m=float(uniform(100.0, _HIGHEST_M)) if scenario.engine == "bundled" else 0.0,
    )
    air, alpha = scenario.air, scenario.alpha
    gusts = float(uniform(*_GUSTS_M_S)) * speed_share
    if not OF_THE_AIR & set(names) and air.turbulence_m_s == 0.0:
        air = Air(turbulence_m_s=gusts, length_m=60.0 * speed_share)
    computed = AlphaSensor("derived", float(uniform(*_ALPHA_S)), float(uniform(0.0, 0.3)), 20.0)
    if not (OF_ALPHA | OF_THE_AIR) & set(names) and generator.random() < 0.5:
        alpha = computed
    return replace(scenario, faults=faults, air=air, alpha=alpha)


def quiet_factor(seed: int, least: float) -> float:
    """Return a factor on the noise of a flight, drawn between ``least`` and 1, evenly in the logarithm."""
    return float(np.exp(np.random.default_rng([seed, 78]).uniform(np.log(least), 0.0)))


def in_the_world(scenario: Scenario, least_noise: float) -> Scenario:
    """Return a natural scenario in which filters always act. The noise is smaller by down to the given
    factor.
    """
    filters = scenario.faults.filters
    if not filters.gyro_hz:
        filters = Filters(_USUAL_HZ, _USUAL_HZ, "stated")
    factor, noise = quiet_factor(scenario.seed, least_noise), scenario.noise
    quiet = {name: factor * getattr(noise, name) for name in _STANDARD_DEVIATIONS}
    return replace(scenario, faults=replace(scenario.faults, filters=filters), noise=replace(noise, **quiet))


def without_vane_noise(scenario: Scenario) -> Scenario:
    """Return the scenario without a vane's noise if the angle of attack is computed."""
    if scenario.alpha.source != "derived":
        return scenario
    return replace(scenario, noise=replace(scenario.noise, alpha_deg=0.0))


def read_airspeed(scenario: Scenario) -> float:
    """Return the scenario's air speed as the aircraft reads it, m/s. In thin air this is the indicated air
    speed.
    """
    speed = scenario.airspeed_m_s or 0.0
    ground_m = scenario.faults.thin_air_m
    if not ground_m:
        return speed
    return speed * float(np.sqrt(standard_air(ground_m + scenario.height_m)[2]))
