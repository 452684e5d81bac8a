"""The pilot between manoeuvres: holds pitch, height and speed; keeps hands still while a manoeuvre runs."""

from typing import NamedTuple

from .kernel import Floats, kernel
from .trim import LinearModel

# Places in the pilot's memory.
PITCH_INTEGRAL, MEAN_COMMAND, SPEED_INTEGRAL, THROTTLE = range(4)
MEMORY = 4


class Pilot(NamedTuple):
    """Gains of elevator on pitch, pitch rate [s] and integral [1/s], of climb on height [1/s], of thrust."""

    pitch: float
    pitch_rate: float
    pitch_integral: float
    height: float
    speed: float
    speed_integral: float


def suitable_pilot(linear: LinearModel, alertness: float) -> Pilot:
    """A pilot as fast as the aircraft; `alertness` around 1 scales the gains on pitch."""
    omega = linear.natural_frequency
    pitch = 0.25 * alertness * omega**2 / -linear.M_delta_e
    rate = 0.30 * alertness * omega / -linear.M_delta_e
    return Pilot(pitch, rate, 0.08 * omega * pitch, 0.25, 5.0, 0.6)


@kernel
def elevator_command(
    memory: Floats,
    theta: float,
    q: float,
    airspeed: float,
    wanted: tuple[float, float],
    pilot: Pilot,
    step: float,
) -> float:
    """Elevator [rad] off trim that brings pitch back; `wanted` is the trim's pitch and the height error."""
    trim_theta, height_error = wanted
    climb_angle = min(max(pilot.height * height_error / airspeed, -0.07), 0.07)
    error = theta - trim_theta - climb_angle
    memory[PITCH_INTEGRAL] = min(max(memory[PITCH_INTEGRAL] + pilot.pitch_integral * error * step, -0.2), 0.2)
    command = pilot.pitch * error + pilot.pitch_rate * q + memory[PITCH_INTEGRAL]
    memory[MEAN_COMMAND] += (command - memory[MEAN_COMMAND]) * step / 0.7
    return float(command)


@kernel
def throttle_command(memory: Floats, speed_error: float, pilot: Pilot, step: float) -> float:
    """Thrust over trim thrust that brings the airspeed back; `speed_error` is a share of the airspeed."""
    integral = memory[SPEED_INTEGRAL] + pilot.speed_integral * speed_error * step
    memory[SPEED_INTEGRAL] = min(max(integral, -0.7), 1.5)
    return float(min(max(1.0 + pilot.speed * speed_error + memory[SPEED_INTEGRAL], 0.0), 3.0))
