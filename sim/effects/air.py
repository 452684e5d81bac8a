"""Moving air as an effect: gusts and wind shear."""

from ..atmosphere import gust_1_minus_cos
from ..motion import Motion


class Gusts:
    """A 1 − cos gust at each of several times."""

    def __init__(self, amplitude_m_s: float, length_m: float, times_s: tuple[float, ...]) -> None:
        self.amplitude, self.length, self.times_s = amplitude_m_s, length_m, times_s

    def step(self, time_s: float, motion: Motion, dt: float) -> tuple[float, float]:
        """Return the gust speeds at ``time_s``, m/s."""
        up = sum(
            gust_1_minus_cos((time_s - at) * motion.airspeed, self.length, self.amplitude)
            for at in self.times_s
        )
        return up, 0.0


class WindShear:
    """Head wind that grows with height through a layer, and is constant above and below."""

    def __init__(self, gradient_1_s: float, height_m: float, most_m_s: float = 3.0) -> None:
        self.gradient, self.height, self.most = gradient_1_s, height_m, most_m_s

    def step(self, time_s: float, motion: Motion, dt: float) -> tuple[float, float]:
        """Return the head wind at the present height, m/s."""
        wind = self.gradient * (motion.height - self.height)
        return 0.0, min(max(wind, -self.most), self.most)
