"""A floor that is no instrument's: where nothing was flown much goes on, and no air that moves explains it.

Flaps that run, a stick that is touched, an engine that is opened: measured against such a floor there would
be no gap at all.
"""

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.fitting.fit import Fitted
from advisor.gap.fitting.problem import Problem
from advisor.gap.noise.probes import DYNAMIC, probe_blocks
from advisor.gap.noise.quiet import unfiltered
from advisor.gap.records.floor import stated_floor
from advisor.gap.unnamed.leftover import Leftover, ranking_of

_OF_NOISE, _OF_PEAK = 5.0, 0.1
"""White noise of a channel, and share of its peak, that a floor must exceed which is none ..."""
_CHANNELS = 2
"""... in so many channels: an instrument that wanders is one."""


def unsteady(problem: Problem, last: Fitted, floor: FloatArray) -> Leftover | None:
    """Where that lies which moves the aircraft while nothing is flown; None where the floor is noise.

    ``floor`` is the noise of each channel as measured, shape (channels,).
    """
    loud = (floor > _OF_NOISE * problem.flights.white) & (floor > _OF_PEAK * problem.flights.peaks)
    if np.count_nonzero(loud) < _CHANNELS:
        return None
    probes = probe_blocks(*unfiltered(problem, last), stated_floor(problem.flights), list(DYNAMIC))
    block = probes[0].block
    note = "Where nothing was flown the aircraft moved by a tenth of its largest motion and more."
    return Leftover(block, probes[0].explained, ranking_of(probes, block), note=note)
