"""Noise of instruments and of unknown forces."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from advisor.oem.driven_motion.linear import Linear
from advisor.process.arrays import FloatArray

RANGE = (1e-12, 1e3)
"""Range of every noise parameter, SI. Without a lower bound the likelihood of data without noise has no
maximum."""
_MEMORY_S, _GUST_MEMORY_S = (0.05, 5.0), (0.5, 5.0)
"""Ranges of the correlation times of coloured noise and of gusts, s. Dryden's lengths are 20 to 600 m near
the ground, and aircraft pass them at 20 to 130 m/s."""
GUST, MEMORY, GUST_MEMORY = -3, -2, -1
"""Indices of the gust and of both correlation times among the logarithms."""
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
    """Shape (f,): root of the intensity of the white noise on each forced rate; (1,) for equal ones."""
    gust: float
    """Standard deviation of the gust's angle of incidence, rad."""
    gust_memory_s: float
    """Correlation time of the gust's angle, s."""

    @classmethod
    def still(cls, white: FloatArray) -> Self:
        """Return white noise of the instruments, shape (o,), without forces and gusts."""
        return cls(white, np.full(len(white), RANGE[0]), 0.3, np.array([RANGE[0]]), 0.0, 1.0)

    @property
    def logarithms(self) -> FloatArray:
        """Shape (2·o + f + 3,): logarithms of all parameters."""
        every = [*self.white, *self.coloured, *self.drive, self.gust, self.memory_s, self.gust_memory_s]
        return np.asarray(np.clip(np.log(np.maximum(every, RANGE[0])), *self.limits))

    @property
    def limits(self) -> FloatArray:
        """Shape (2, 2·o + f + 3): least and largest logarithms."""
        sizes = 2 * len(self.white) + len(self.drive) + 1
        return np.asarray(np.log(np.array([*[RANGE] * sizes, _MEMORY_S, _GUST_MEMORY_S])).T)

    def at(self, logarithms: FloatArray) -> "Noise":
        """Return the noise with other parameters, each within its range."""
        o, values = len(self.white), np.exp(np.clip(logarithms, *self.limits))
        memories = float(values[-2]), float(values[-1])
        return Noise(
            values[:o], values[o : 2 * o], memories[0], values[2 * o : -3], float(values[-3]), memories[1]
        )

    def driving(
        self, motion: Linear, start_variance: float = 0.0
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return rates, variances at the start and driving intensities of s states and of the gust's angle.

        The rates are by the states and by the gust's angle, shape (s + 1, s + 1); the others have (s + 1,).
        Every state has the variance ``start_variance`` at the start.
        """
        s = len(motion.matrix)
        matrix, begun, drive = np.zeros((s + 1, s + 1)), np.zeros(s + 1), np.zeros(s + 1)
        matrix[:s, :s], matrix[:s, s], matrix[s, s] = motion.matrix, motion.air, -1.0 / self.gust_memory_s
        begun[:s] = start_variance
        begun[s], drive[s] = self.gust**2, 2.0 * self.gust**2 / self.gust_memory_s
        drive[motion.forced] = self.drive**2
        return matrix, begun, drive
