"""Response of an output to a test input: its size, its noise, and the share that the model explains."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from advisor.decision.envelope import flown
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.maneuvers.purpose import LEAST_PITCH_RATE_DEG_S
from advisor.oem.estimate import ChannelFit
from advisor.process.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Response:
    """An output that a control's input moves, and the least response for a test."""

    output: str
    said: str
    unit: str
    handle: str
    """Control in the pilot's hand: the stick for the elevator, otherwise the control's name."""
    least_signal: float = 12.0
    """Least ratio of the response's peak to the white part of the output's noise."""
    least_r2: float = 0.85
    """Least share of the response that the model must explain, after removal of white noise."""

    def factor(self, maneuver: Maneuver, fits: Mapping[str, ChannelFit], by_noise: bool = True) -> float:
        """Return the factor by which the response is too small, above 1 if it is.

        Parameters
        ----------
        by_noise
            Whether the response must exceed the noise, and not only the least angular rate.
        """
        peak = half_range(maneuver, self.output)
        channel = maneuver.channels[self.output].y
        noise = white_part(fits[self.output].residual if self.output in fits else channel)
        least = self.least_signal * noise if by_noise else 0.0
        if self.unit == "deg/s":
            least = max(least, math.radians(LEAST_PITCH_RATE_DEG_S))
        return least / peak if peak > 0.0 else math.inf


def explained_share(fit: ChannelFit) -> float:
    """Return the share of an output's variance that the model explains, after removal of white noise."""
    noise = white_part(fit.residual) ** 2
    spread = float(np.var(fit.measured)) - noise
    return 1.0 - max(0.0, fit.rms**2 - noise) / spread if spread > 0.0 else 1.0


def half_range(maneuver: Maneuver, name: str) -> float:
    """Return half of a channel's range during the manoeuvre."""
    y = flown(maneuver, name)
    return float(np.ptp(y)) / 2.0 if len(y) else 0.0


def white_part(values: FloatArray) -> float:
    """Return the standard deviation of the white part of a signal, from second differences."""
    if len(values) < 3:
        return 0.0
    return float(np.std(np.diff(values, 2))) / math.sqrt(6.0)
