"""Cases with a user's own simulator: a JSBSim aircraft flies, and its model is the simulator.

In most cases the effect is in the aircraft and missing in the model. In the other cases the effect is in the
simulator's servo, and missing in the aircraft.
"""

from dataclasses import dataclass, replace

import numpy as np

from ..hangar import Habits
from ..trim import TrimError
from .draw import Case, scenario_of, sized
from .sizes import ON_ANY_ENGINE

FLEET = {
    "c172p": Habits(53.0, 2.5, 0.4),
    "T37": Habits(110.0, 1.5, 0.5),
    "737": Habits(140.0, 1.5, 0.6),
}
"""JSBSim names of aircraft of 1 t, 3 t and 50 t."""
WITHOUT, MIRRORED = 0.2, 0.15
"""Share of the cases without an effect, and share with an effect in the simulator alone."""
SERVO = {"actuator_lag": "lag_s", "transport_delay": "delay_s"}
"""Key in the aircraft file of each effect that a simulator's servo can have."""
AIR = ("turbulence", "gust")
"""Effects that no simulator can contain."""
TRIALS = 40


@dataclass(frozen=True)
class SimulatedCase(Case):
    """A case whose aircraft file names a simulator and contains no model."""

    simulator: str = ""
    servo: tuple[tuple[str, float], ...] = ()
    """Lag or delay of the elevator in the aircraft file, as key and value."""


def draw_simulated(generator: np.random.Generator) -> SimulatedCase:
    """Draw a case until its effect is visible above the noise.

    Raises
    ------
    RuntimeError
        No draw was visible.
    """
    kind = generator.random()
    mirrored = WITHOUT <= kind < WITHOUT + MIRRORED
    for _ in range(TRIALS):
        names: list[str] = []
        if kind >= WITHOUT:
            known = sorted(SERVO) if mirrored else [n for n in ON_ANY_ENGINE if n not in AIR]
            names = [str(generator.choice(known))]
        aircraft = str(generator.choice(list(FLEET)))
        habits = FLEET[aircraft]
        scenario, _ = scenario_of("jsbsim", names, False, generator)
        scenario = replace(
            scenario,
            aircraft=aircraft,
            airspeed_m_s=habits.airspeed_m_s * float(generator.uniform(0.95, 1.08)),
            unit_s=round(habits.unit_s * float(generator.choice([0.8, 1.0, 1.2])), 2),
            maneuvers=tuple(
                replace(m, amplitude_deg=habits.amplitude_deg * float(generator.choice([0.6, 1.0, 1.3])))
                for m in scenario.maneuvers
            ),
        )
        try:
            case = sized("simulator", scenario, names, False, [], generator)
        except TrimError:
            continue
        if case is not None:
            return _named(case, mirrored)
    raise RuntimeError("no visible case of group simulator")


def _named(case: Case, mirrored: bool) -> SimulatedCase:
    """Return the case with its simulator. A mirrored case has the effect in the simulator's servo instead of
    the aircraft."""
    scenario, effects, servo = case.scenario, case.effects, []
    if mirrored:
        scenario = replace(scenario, effects={})
        for effect, sizes in case.effects.items():
            key = SERVO[effect]
            servo.append((key, round(sizes[key], 5)))
            effects = {effect: {key: -round(sizes[key], 5)}}
    return SimulatedCase(
        "simulator", scenario, case.prior, effects, case.blocks, case.gap, case.hard, case.background,
        f"jsbsim:{scenario.aircraft}", tuple(servo),
    )  # fmt: skip
