"""Sharp steps of a control, which show that someone outside a control loop moves the control."""

from itertools import pairwise

import numpy as np

from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.maneuvers.movement import SMALLEST_RAD

_SHARP_S = 0.06
"""Half of the largest duration of an external input's step, s. Feedback of the aircraft's motion is
slower."""
_SLOWEST_S = 0.15
"""Largest sampling interval of the elevator, s, at which a sharp step is visible."""
_SHARP = 0.5
"""Least share of a sharp step within twice ``_SHARP_S``."""
_FEWEST_SHARP = 3
"""Least number of sharp steps for an external input. A control loop makes one sharp step when it is switched
on, and one when its demand jumps."""


def moves_in_sharp_steps(maneuver: Maneuver, control: str) -> bool:
    """Return whether the control moves in sharp steps, which no feedback of the motion makes."""
    elevator = maneuver.channels[control]
    interval_s = float(np.median(np.diff(elevator.t))) if len(elevator) > 1 else np.inf
    if interval_s > _SLOWEST_S:
        return False
    reach = max(_SHARP_S, 1.01 * interval_s)
    steps = [(maneuver.span.start_s, 0.0), *maneuver.span.steps]
    sharp = 0
    for (_, old), (onset, new) in pairwise(steps):
        before, after = np.interp([onset - reach, onset + reach], elevator.t, elevator.y)
        done = (after - before) * np.sign(new - old)
        sharp += abs(new - old) >= 2.0 * SMALLEST_RAD and done >= _SHARP * abs(new - old)
    return sharp >= max(_FEWEST_SHARP, 0.6 * (len(steps) - 1))
