"""An instrument that wanders by itself: slowly, far more than its noise, and alone.

Slow errors that all instruments share are those of the day or of the filter that describes them, and count as
noise. One alone that wanders by a good part of what it measures is at fault, though no model is.
"""

import numpy as np

from advisor.gap.fitting.fit import Fitted, rms_of
from advisor.gap.fitting.problem import Problem
from advisor.gap.fitting.whitening import Filters
from advisor.gap.noise.probes import SENSOR_CHANNELS
from advisor.gap.unnamed.leftover import Leftover

_OF_PEAK = 0.04
"""Share of a channel's peak that its error must reach ..."""
_OF_WHITE = 3.0
"""... and how many times its white noise ..."""
_OF_OTHERS = 5.0
"""... and how many times what any other channel has beyond its white noise ..."""
_MEMORY_S = 0.5
"""... with a memory that no instrument's noise has."""


def wandering_attitude(problem: Problem, last: Fitted) -> Leftover | None:
    """The same of the attitude, beside any names: nothing but its instrument parts it from the pitch rate."""
    found = wandering_sensor(problem, last)
    return found if found is not None and found.block == "attitude_sensor" else None


def wandering_sensor(problem: Problem, last: Fitted) -> Leftover | None:
    """The one instrument that wanders, with a note that says how far; None where none does."""
    if not isinstance(problem.whitening, Filters):
        return None
    airs, peaks = problem.whitening.airs, problem.flights.peaks
    if float(np.median([air.memory_s for air in airs])) < _MEMORY_S:
        return None
    errors, white = rms_of(problem, last.left), problem.flights.white
    slow = np.sqrt(np.maximum(errors**2 - white**2, 0.0)) / peaks
    worst = int(np.argmax(slow))
    others = np.delete(slow, worst)
    if worst not in problem.flights.telling or slow[worst] < _OF_OTHERS * float(np.max(others, initial=0.0)):
        return None
    error = float(errors[worst])
    if error < max(_OF_PEAK * peaks[worst], _OF_WHITE * white[worst]):
        return None
    block = next(b for b, channel in SENSOR_CHANNELS.items() if channel == problem.channels[worst])
    percent = 100.0 * error / peaks[worst]
    note = f"It wanders by itself, by {percent:.0f} % of the largest motion, where nothing else does."
    power = np.zeros(len(peaks))
    power[worst] = (slow[worst] * peaks[worst]) ** 2
    return Leftover(block, 1.0, ((block, 1.0),), power, note)
