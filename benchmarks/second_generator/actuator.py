"""The servo and its linkage, from the command on the wire to the surface."""

from typing import NamedTuple

import numpy as np

from .kernel import Floats, kernel

UNLIMITED = 1e3  # rad or rad/s: no servo gets there

# Places in the servo's memory: servo position and rate, surface behind the play, the command it holds on to.
POSITION, RATE, SURFACE, HELD = range(4)
MEMORY = 4


class Servo(NamedTuple):
    """Servo and linkage [SI, rad]; the defaults follow the command at once.

    With `natural_frequency` above zero the servo is of second order, otherwise `lag` above zero makes it of
    first order. `torque_limit` is the hinge moment, in rad of elevator at the trim's pressure, at which the
    servo stalls.
    """

    lag: float = 0.0
    natural_frequency: float = 0.0
    damping: float = 0.7
    rate_limit: float = UNLIMITED
    half_play: float = 0.0
    half_deadband: float = 0.0
    resolution: float = 0.0
    stiction: float = 0.0
    oscillation: float = 0.0
    oscillation_frequency: float = 0.0
    cable_preload: float = UNLIMITED
    cable_stretch: float = 0.0
    torque_limit: float = UNLIMITED
    float_per_alpha: float = 0.0


class Load(NamedTuple):
    """What loads the surface: angle of attack off trim [rad], pressure over that of the trim, time [s]."""

    alpha: float
    pressure: float
    time: float


@kernel
def without_deadband(departure: float, half: float) -> float:
    """What remains of a command's departure from neutral beyond a dead band."""
    return float(np.sign(departure) * max(abs(departure) - half, 0.0))


@kernel
def servo_step(
    memory: Floats, command: float, neutral: float, load: Load, servo: Servo, step: float
) -> float:
    """Move the servo by one time step; return the surface's deflection [rad] at its end."""
    wanted = neutral + without_deadband(command - neutral, servo.half_deadband)
    if servo.resolution > 0.0:
        wanted = neutral + servo.resolution * np.round((wanted - neutral) / servo.resolution)
    # A stuck servo lets go when the command has gone far enough, and sticks again when it has arrived.
    if abs(wanted - memory[HELD]) >= servo.stiction:
        memory[HELD] = wanted
    wanted = memory[HELD]

    before = memory[POSITION]
    if servo.natural_frequency > 0.0:
        omega = servo.natural_frequency
        acceleration = omega**2 * (wanted - before) - 2.0 * servo.damping * omega * memory[RATE]
        rate = memory[RATE] + step * acceleration
    elif servo.lag > 0.0:
        rate = (wanted - before) * (1.0 - np.exp(-step / servo.lag)) / step
    else:
        rate = (wanted - before) / step
    rate = min(max(rate, -servo.rate_limit), servo.rate_limit)
    memory[RATE], memory[POSITION] = rate, before + step * rate

    # The linkage follows with play: the surface moves only when a side of the slot pushes it.
    low, high = memory[POSITION] - servo.half_play, memory[POSITION] + servo.half_play
    memory[SURFACE] = min(max(memory[SURFACE], low), high)
    surface = memory[SURFACE]

    # Hinge moment in rad of elevator: mostly its own deflection, a share of the angle of attack.
    hinge = load.pressure * ((surface - neutral) + 0.4 * load.alpha)
    beyond = without_deadband(hinge, servo.cable_preload)
    surface -= servo.cable_stretch * beyond
    surface -= without_deadband(hinge, servo.torque_limit)
    # A floating elevator trails with the wind only while the load exceeds the friction of its hinges.
    surface += load.pressure * servo.float_per_alpha * without_deadband(load.alpha, 0.008)
    return float(surface + servo.oscillation * np.sin(servo.oscillation_frequency * load.time))
