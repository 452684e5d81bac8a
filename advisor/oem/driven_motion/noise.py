"""Noise of instruments and of unknown forces."""

from dataclasses import dataclass

import numpy as np

from advisor.process.arrays import FloatArray

RANGE = (1e-12, 1e3)
"""Range of every noise parameter, SI. Without a lower bound the likelihood of data without noise has no
maximum."""
_MEMORY_S, _GUST_MEMORY_S = (0.05, 5.0), (0.5, 5.0)
"""Ranges of the correlation times of coloured noise and of gusts, s. Dryden's lengths are 20 to 600 m near
the ground, and aircraft pass them at 20 to 130 m/s."""
LEAST_GUST_RAD = 0.0017
"""Least standard deviation of a reported gust angle, rad: 0.1 deg."""


@dataclass(frozen=True, slots=True)
class Noise:
    """Noise of the instruments and forces on the motion, as standard deviations and intensities, SI."""

    white: FloatArray
    """Shape (o,): white noise of each output."""
    coloured: FloatArray
    """Shape (o,): coloured noise of each output."""
    memory_s: float
    """Correlation time of the coloured noise, s."""
    drive: FloatArray
    """Shape (f,): square root of the intensity of the white noise on each forced rate."""
    gust: float
    """Standard deviation of the gust's angle of incidence, rad."""
    gust_memory_s: float
    """Correlation time of the gust's angle, s."""

    @property
    def logarithms(self) -> FloatArray:
        """Shape (2·o + f + 3,): logarithms of all parameters."""
        every = [*self.white, *self.coloured, *self.drive, self.gust, self.memory_s, self.gust_memory_s]
        return np.asarray(np.log(np.clip(every, *RANGE)))

    def at(self, logarithms: FloatArray) -> "Noise":
        """Return the noise with other parameters, each within its range."""
        o, values = len(self.white), np.clip(np.exp(logarithms), *RANGE)
        return Noise(
            values[:o],
            values[o : 2 * o],
            float(np.clip(values[-2], *_MEMORY_S)),
            values[2 * o : -3],
            float(values[-3]),
            float(np.clip(values[-1], *_GUST_MEMORY_S)),
        )
