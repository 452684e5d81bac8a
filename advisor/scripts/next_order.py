"""Orders to a script. An order names an input by its place in the table, size and time unit, or ends an
input.
"""

from math import degrees

from advisor.decision.inputs import StepInput
from advisor.scripts.inputs import NAMES

_NAMES = {
    ("elevator", True): "3-2-1-1",
    ("elevator", False): "reverse 3-2-1-1",
    ("aileron", True): "aileron doublet",
    ("rudder", True): "rudder doublet",
}
"""Name in a script's table, by control and direction of the first step. A script flies the elevator only as
3-2-1-1, which contains the frequencies of other orders of steps.
"""


def next_order(advised: StepInput) -> tuple[int, float, float]:
    """Return the number of the input, its size in deg, and its time unit in s."""
    elevator = advised.control == "elevator"
    name = _NAMES[advised.control, advised.nose_up_first if elevator else True]
    return 1 + NAMES.index(name), round(degrees(advised.amplitude_rad), 2), round(advised.unit_s, 2)


def end_order(number: int) -> tuple[int, float, float]:
    """Return the order to end the multisine of this number, with a size that no script would fly."""
    return 0, -float(number), 0.0
