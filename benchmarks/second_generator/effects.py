"""The type of an effect, and the experiment it acts upon."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from .actuator import Servo
from .aircraft import Aircraft
from .atmosphere import Air, from_upward
from .flight import Link, Schedule
from .flight_model import FlightModel
from .kernel import Floats
from .maneuvers import Plan
from .pilot import Pilot
from .sensors import Clock, Instruments
from .trim import LinearModel

BLOCKS = (
    "input",
    "force_equation",
    "moment_equation",
    "air",
    "alpha_sensor",
    "pitch_rate_sensor",
    "accelerometer",
    "attitude_sensor",
    "timing",
)

Parameters = dict[str, float | str]


@dataclass(frozen=True)
class Experiment:
    """All there is to fly a case: the aircraft, what is planned, the air, the servo and the instruments."""

    aircraft: Aircraft
    linear: LinearModel
    model: FlightModel
    plan: Plan
    air: Air
    servo: Servo
    link: Link
    pilot: Pilot
    instruments: Instruments
    cg_aft: Floats
    mass_added: Floats
    ice: Floats
    moment_added: Floats
    delay: Floats
    dropout: Floats

    @property
    def omega(self) -> float:
        """Natural frequency of the short period [rad/s]."""
        return self.linear.natural_frequency

    @property
    def time(self) -> Floats:
        """The time grid [s]."""
        return self.plan.time

    def with_upward(self, upward: Floats) -> "Experiment":
        """More vertical wind [m/s]."""
        extra = from_upward(upward, self.plan.step, self.aircraft.airspeed_m_s, self.aircraft.span_m)
        return replace(self, air=self.air.plus(extra))

    def with_model(self, **changes: float) -> "Experiment":
        """Departures of the flight model."""
        return replace(self, model=self.model._replace(**changes))

    def with_servo(self, **changes: float) -> "Experiment":
        """Departures of the servo."""
        return replace(self, servo=self.servo._replace(**changes))

    def with_clock(self, stream: str, clock: Clock) -> "Experiment":
        """Another clock for one stream."""
        clocks = {**self.instruments.clocks, stream: clock}
        return replace(self, instruments=replace(self.instruments, clocks=clocks))

    def schedule(self) -> Schedule:
        """The arrays that the flight runs along."""
        return Schedule(
            offset=self.plan.offset,
            hands_off=self.plan.hands_off,
            airspeed=self.plan.airspeed,
            height=self.plan.height,
            power_change=self.plan.power_change,
            upward=self.air.upward,
            behind=self.air.behind,
            pitching=self.air.pitching,
            cg_aft=self.cg_aft,
            mass_added=self.mass_added,
            ice=self.ice,
            moment_added=self.moment_added,
            delay=self.delay,
            dropout=self.dropout,
        )


Outcome = tuple[Experiment, Parameters]
Change = Callable[[Experiment, float, np.random.Generator], Outcome]


@dataclass(frozen=True)
class Effect:
    """A cause of a gap: `change(experiment, size, rng)`, where size 1 is plainly there and 2 is large.

    `needs` is what the flight must contain for the effect to show: "speed", "power", "low" or nothing. An
    effect that is not `dynamic` only shifts a channel by a constant.
    """

    name: str
    block: str
    change: Change
    needs: str = ""
    dynamic: bool = True


def appearing(time: Floats, rng: np.random.Generator) -> Floats:
    """From 0 to 1 in mid-flight: a step, or a ramp over a third of the flight."""
    total = time[-1]
    start = rng.uniform(0.3, 0.55) * total
    length = float(rng.choice([0.5, 0.3 * total]))
    share: Floats = np.clip((time - start) / length, 0.0, 1.0)
    return share


def sign(rng: np.random.Generator) -> float:
    """Either way."""
    return float(rng.choice([-1.0, 1.0]))
