"""Moving air: Dryden turbulence and a discrete gust."""

import math

import numpy as np


class DrydenTurbulence:
    """Vertical and head-on gusts with the Dryden spectra (MIL-F-8785C, low intensity).

    The vertical component has the spectrum's second-order shaping filter

        w(s)/n(s) = σ √(3V/L) · (s + V/(√3 L)) / (s + V/L)²,

    the head-on component has the first-order filter. The filters advance with their exact discrete
    transition, with white noise constant over a step.
    """

    def __init__(
        self, sigma_m_s: float, length_m: float, generator: np.random.Generator, head_share: float = 1.0
    ) -> None:
        self.sigma = sigma_m_s
        self.length = length_m
        self.head_share = head_share
        self._generator = generator
        self._noise: list[float] = []
        self._x1 = self._x2 = self._head = 0.0

    def step(self, airspeed: float, dt: float) -> tuple[float, float]:
        """Return (gust up, gust head-on) in m/s after ``dt`` seconds of flight at ``airspeed``."""
        if len(self._noise) < 2:
            self._noise = self._generator.standard_normal(2048).tolist()
        if self.sigma == 0.0:
            return 0.0, 0.0
        rate = airspeed / self.length
        decay = math.exp(-rate * dt)
        white = self._noise.pop() / math.sqrt(dt)
        # x2 is the filter's double pole, x1 its integrated input: w = b1·x1 + b0·x2.
        gained = (1.0 - decay) / rate
        ramped = (1.0 - decay * (1.0 + rate * dt)) / rate**2
        x2 = decay * self._x2 + dt * decay * self._x1 + ramped * white
        self._x1 = decay * self._x1 + gained * white
        self._x2 = x2
        gain = self.sigma * math.sqrt(3.0 * rate)
        up = gain * (self._x1 + rate * (1.0 / math.sqrt(3.0) - 1.0) * self._x2)
        head_white = self._noise.pop()
        self._head = decay * self._head + math.sqrt(1.0 - decay**2) * head_white
        return up, self.sigma * self.head_share * self._head


def gust_1_minus_cos(distance_m: float, length_m: float, amplitude_m_s: float) -> float:
    """Return the vertical speed (m/s, up) of a 1 − cos gust at a distance into the gust, MIL-F-8785C
    3.7.1.3."""
    if not 0.0 < distance_m < length_m:
        return 0.0
    return 0.5 * amplitude_m_s * (1.0 - math.cos(2.0 * math.pi * distance_m / length_m))
