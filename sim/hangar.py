"""Aircraft by name, each with its suitable test inputs."""

from dataclasses import dataclass, replace

from .airframe import LIGHT_AIRCRAFT, UAV, Airframe
from .jsbsim_aircraft import JsbsimAircraft
from .linear import RESEARCH_JET
from .linear_aircraft import LinearAircraft
from .loading import ScenarioError
from .nonlinear_aircraft import NonlinearAircraft
from .scenario import Scenario

Aircraft = LinearAircraft | NonlinearAircraft | JsbsimAircraft


@dataclass(frozen=True)
class Habits:
    """Usual flight-test inputs of an aircraft."""

    airspeed_m_s: float
    amplitude_deg: float
    unit_s: float


AIRFRAMES: dict[str, tuple[Airframe, Habits]] = {
    "uav": (UAV, Habits(25.0, 2.0, 0.3)),
    "light": (LIGHT_AIRCRAFT, Habits(55.0, 2.0, 0.5)),
}
"""Nonlinear aircraft by name."""

JSBSIM_HABITS = {"c172p": Habits(53.0, 2.5, 0.4)}
OTHER_HABITS = Habits(55.0, 2.0, 0.5)
"""Usual inputs of a JSBSim aircraft without an entry."""

LINEAR_HABITS = Habits(100.0, 2.0, 0.8)
NAMES = (*AIRFRAMES, "linear")


def unit_for(frequency_rad_s: float) -> float:
    """Return the time unit, s, of a 3-2-1-1 whose spectrum is centred on the short-period frequency, rounded
    to 0.1 s.
    """
    return max(0.1, round(2.4 / max(frequency_rad_s, 0.5), 1))


def habits(scenario: Scenario) -> Habits:
    """Return the usual inputs of the scenario's aircraft."""
    if scenario.engine == "jsbsim":
        return JSBSIM_HABITS.get(scenario.aircraft, OTHER_HABITS)
    if scenario.aircraft in AIRFRAMES:
        return AIRFRAMES[scenario.aircraft][1]
    return LINEAR_HABITS


def build(scenario: Scenario, **changes: float) -> Aircraft:
    """Return the trimmed aircraft of the scenario. ``changes`` replace fields of a nonlinear airframe."""
    airspeed = scenario.airspeed_m_s or habits(scenario).airspeed_m_s
    if scenario.engine == "jsbsim":
        return JsbsimAircraft(scenario.aircraft, airspeed, scenario.height_m, scenario.step_s)
    if scenario.aircraft not in NAMES:
        raise ScenarioError([f"aircraft: '{scenario.aircraft}' is none of {', '.join(NAMES)} and no file"])
    if scenario.aircraft == "linear":
        return LinearAircraft(RESEARCH_JET, airspeed, scenario.height_m)
    airframe = AIRFRAMES[scenario.aircraft][0]
    held = 1.0 if scenario.speed == "held" else 0.0
    flown = replace(airframe, **{"speed_held": held, **scenario.airframe, **changes})
    return NonlinearAircraft(flown, airspeed, scenario.height_m)
