"""Flight of a rigid body in gusts: hands that hold the attitude, inputs of one control, and its servos."""

import numpy as np

from benchmarks.at_once.motion import HEIGHT_M, STEP_S, Floats, Numbers, stepped
from benchmarks.second_generator.kernel import kernel

HANDS_S = 0.02
"""Time between two movements of the hands, s."""
_EACH = round(HANDS_S / STEP_S)


@kernel
def flown(
    x: Floats,
    asked: Floats,
    hands: Floats,
    remnant: Floats,
    gains: Floats,
    trim: Floats,
    servos: Floats,
    delay_s: float,
    gusts: Floats,
    us_per_rad: float,
    n: Numbers,
) -> tuple[Floats, Floats, Floats]:
    """Return the states (n, 9), specific forces (n, 3) and pulses (n, 3) of a flight.

    Parameters
    ----------
    asked, remnant, gusts
        Shape (n, 3): inputs and remnant of elevator, aileron and rudder, rad; gust in body axes, m/s.
    hands
        Shape (n, 3): 1 where the hands answer the motion with a control, 0 where the control is the input's.
    gains
        Shape (6,): elevator by pitch angle and pitch rate, aileron by bank and roll rate, rad and s, path
        angle by height, rad/m, and the hands' delay, s.
    trim
        Shape (2,): angle of attack and elevator of level flight, rad.
    servos
        Shape (3, 3): lag, s, largest rate, rad/s, and width of the play, rad, of each surface.
    delay_s
        Time by which every command acts late, s.
    """
    count = len(asked)
    states, forces, pulses = np.empty((count, 9)), np.empty((count, 3)), np.empty((count, 3))
    held, servo = np.array([trim[1], 0.0, 0.0]), np.array([trim[1], 0.0, 0.0])
    surfaces = servo.copy()
    late, behind = int(delay_s / STEP_S + 0.5), int(gains[5] / STEP_S + 0.5)
    for k in range(count):
        if k % _EACH == 0:
            seen = states[max(k - behind, 0)] if k > behind else x
            path = min(max(gains[4] * (HEIGHT_M - seen[8]), -0.06), 0.06)
            wanted = np.array(
                [
                    trim[1] + gains[0] * (seen[7] - trim[0] - path) + gains[1] * seen[4],
                    gains[2] * seen[6] + gains[3] * seen[3],
                    0.0,
                ]
            )
            for c in range(3):
                if hands[k, c] > 0.5:
                    held[c] = wanted[c] + remnant[k, c]
        pulses[k] = np.floor(1500.5 + us_per_rad * (held + asked[k]))
        told = (pulses[max(k - late, 0)] - 1500.0) / us_per_rad
        after = surfaces.copy()
        for c in range(3):
            lag, most, play = servos[c, 0], servos[c, 1] * STEP_S, servos[c, 2]
            step = (told[c] - servo[c]) * (1.0 - np.exp(-STEP_S / lag))
            servo[c] += min(max(step, -most), most)
            after[c] = min(max(surfaces[c], servo[c] - 0.5 * play), servo[c] + 0.5 * play)
        states[k] = x
        x, forces[k] = stepped(x, surfaces, after, gusts[k], n)
        surfaces = after
    return states, forces, pulses
