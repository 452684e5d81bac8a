"""Natural delay between two messages of one log, due to sampling, stamping and transport.

An autopilot renews its servo outputs at one rate, and a stream samples them at another. Over 28 flights of
one autopilot the command acted 6 ms before to 10 ms after its linear reading, with stamps 20 ms apart. A
natural delay is no property of the aircraft. A delay of 10 ms that a model lacks changes M_q and M_δe by 7 to
19 %."""

from collections.abc import Sequence

import numpy as np

from advisor.process.arrays import FloatArray

CLOCKS_S = 0.015
"""Standard deviation of a message's delay beyond its sampling interval, s: autopilot loop, transport,
filters. The value comes from 28 flights of one autopilot, -6 to +10 ms plus 4 to 20 ms of filters."""


def lateness_std(stamps: Sequence[FloatArray]) -> float:
    """Return the standard deviation of a channel's natural delay, s: half an interval plus ``CLOCKS_S``."""
    intervals = np.concatenate([np.diff(t) for t in stamps])
    return 0.5 * float(np.median(intervals)) + CLOCKS_S
