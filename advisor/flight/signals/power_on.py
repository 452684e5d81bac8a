"""A power-on of the vehicle as a whole: every channel from its first stamp to its last."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from advisor.flight.signals.messages import FloatArray, IntArray
from advisor.flight.signals.record import Channel


@dataclass(frozen=True, slots=True)
class PowerOn:
    """All channels that one vehicle sent from one power-on to the next.

    A stream keeps power-ons on request only, because their memory grows with the length of the flight.
    """

    boot: int
    """Number of the power-on in its log, 0 for the first."""
    channels: Mapping[str, Channel]
    """Channel name to its samples from its best source, SI, each at its own stamps."""
    clock_order: IntArray
    """Shape (n,), rising: arrival index of each message that stamps the vehicle's clock."""
    clock_s: FloatArray
    """Shape (n,), never falling: the vehicle's clock at each of these arrivals, s since boot."""

    def arrivals(self, start_s: float, end_s: float) -> tuple[int, int]:
        """Return the arrival indices of the first and the last stamp of the clock with ``start_s <= t <=
        end_s``.

        Raises
        ------
        ValueError
            The clock shows no time of this stretch.
        """
        i, j = np.searchsorted(self.clock_s, [start_s, np.nextafter(end_s, np.inf)])
        if i == j:
            raise ValueError("the vehicle's clock shows no time of this stretch")
        return int(self.clock_order[i]), int(self.clock_order[j - 1])
