"""One flight on a time grid: pilot, servo, aircraft and air together."""

from typing import NamedTuple

import numpy as np

from . import actuator, pilot
from .actuator import Load, Servo, servo_step
from .flight_model import FlightModel
from .kernel import Floats, kernel
from .motion import HEIGHT, MODE, MODE_RATE, STATES, THETA, Q, Surroundings, advance, density, derivatives
from .pilot import Pilot, elevator_command, throttle_command
from .trim import level_state


class Link(NamedTuple):
    """The elevator's way to the servo.

    `period` is the number of grid steps between two renewals of a digital command, `resolution` the elevator
    [rad] of one microsecond of pulse width, `neutral` the elevator at the calibration's centre.
    """

    period: int
    resolution: float
    neutral: float


class Schedule(NamedTuple):
    """Everything that is known of a flight beforehand, on the time grid."""

    offset: Floats
    hands_off: Floats
    airspeed: Floats
    height: Floats
    power_change: Floats
    upward: Floats
    behind: Floats
    pitching: Floats
    cg_aft: Floats
    mass_added: Floats
    ice: Floats
    moment_added: Floats
    delay: Floats
    dropout: Floats


class Truth(NamedTuple):
    """What really happened, on the time grid [SI, rad]: the command is what the servo was told."""

    airspeed: Floats
    alpha: Floats
    q: Floats
    theta: Floats
    height: Floats
    climb: Floats
    a_x: Floats
    a_z: Floats
    q_dot: Floats
    mode: Floats
    mode_rate: Floats
    command: Floats
    elevator: Floats
    thrust: Floats


@kernel
def _around(k: int, schedule: Schedule) -> Surroundings:
    return Surroundings(
        schedule.upward[k],
        schedule.behind[k],
        schedule.pitching[k],
        schedule.cg_aft[k],
        schedule.mass_added[k],
        schedule.ice[k],
        schedule.moment_added[k],
    )


@kernel
def fly(
    step: float, start: Floats, model: FlightModel, servo: Servo, link: Link, hands: Pilot, schedule: Schedule
) -> Truth:
    """Fly the schedule from a state vector."""
    count = len(schedule.offset)
    rows = np.zeros((14, count))
    truth = Truth(
        rows[0],
        rows[1],
        rows[2],
        rows[3],
        rows[4],
        rows[5],
        rows[6],
        rows[7],
        rows[8],
        rows[9],
        rows[10],
        rows[11],
        rows[12],
        rows[13],
    )
    state = start.copy()
    slopes = np.zeros((4, STATES))
    slope = np.zeros(STATES)
    servo_memory = np.full(actuator.MEMORY, model.elevator)
    servo_memory[actuator.RATE] = 0.0
    mind = np.zeros(pilot.MEMORY)
    mind[pilot.THROTTLE] = 1.0
    pressure = 0.5 * density(model.elevation + start[HEIGHT]) * model.airspeed**2
    command = elevator = model.elevator
    received = model.elevator
    power = 1.0
    separated = 0.0
    for k in range(count):
        time = k * step
        around = _around(k, schedule)
        thrust = model.thrust * power
        felt = derivatives(state, time, elevator, thrust, around, separated, model, slope)
        # The pilot flies until the manoeuvre starts, then holds the mean of the last moments.
        if schedule.hands_off[k] > 0.0:
            asked = mind[pilot.MEAN_COMMAND]
        else:
            wanted = (model.alpha, schedule.height[k] - state[HEIGHT])
            asked = elevator_command(mind, state[THETA], state[Q], felt.airspeed, wanted, hands, step)
            speed_error = (schedule.airspeed[k] - felt.airspeed) / model.airspeed
            mind[pilot.THROTTLE] = throttle_command(mind, speed_error, hands, step)
        if k % link.period == 0:
            departure = model.elevator + asked + schedule.offset[k] - link.neutral
            command = link.neutral + link.resolution * np.round(departure / link.resolution)
        power += (mind[pilot.THROTTLE] * (1.0 + schedule.power_change[k]) - power) * step / 0.4

        truth.airspeed[k], truth.alpha[k] = felt.airspeed, felt.alpha
        truth.q[k], truth.theta[k], truth.height[k] = state[Q], state[THETA], state[HEIGHT]
        truth.a_x[k], truth.a_z[k], truth.q_dot[k] = felt.a_x, felt.a_z, slope[Q]
        truth.climb[k], truth.mode[k], truth.mode_rate[k] = slope[HEIGHT], state[MODE], state[MODE_RATE]
        truth.command[k], truth.elevator[k], truth.thrust[k] = command, elevator, power

        if schedule.dropout[k] == 0.0:
            received = truth.command[max(k - int(schedule.delay[k] / step + 0.5), 0)]
            if schedule.delay[k] / step > k:
                received = model.elevator
        load_pressure = 0.5 * density(model.elevation + state[HEIGHT]) * felt.airspeed**2 / pressure
        load = Load(felt.alpha - model.alpha, load_pressure, time)
        moved = servo_step(servo_memory, received, model.elevator, load, servo, step)
        if felt.alpha > model.hysteresis_on:
            separated = 1.0
        elif felt.alpha < model.hysteresis_off:
            separated = 0.0
        advance(state, time, step, (elevator, moved), thrust, around, separated, model, slopes)
        elevator = moved
    return truth


def from_trim(
    step: float, model: FlightModel, servo: Servo, link: Link, hands: Pilot, schedule: Schedule
) -> Truth:
    """Fly the schedule from level flight; in the first seconds the pilot takes up an effect on the trim."""
    start = level_state(model, model.airspeed, model.alpha, float(schedule.height[0]))
    truth: Truth = fly(step, start, model, servo, link, hands, schedule)
    return truth
