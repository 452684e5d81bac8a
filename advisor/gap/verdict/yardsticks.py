"""Published measures of a simulator's fidelity, in addition to the gap.

The measures are Theil's inequality coefficient (Theil 1966), R², and the tolerance of simulator
qualification. The coefficient is split into bias, variance and covariance (Jategaonkar, *Flight Vehicle
System Identification*, section 11.3). For the short period the tolerance is ±1.5° of pitch or ±2 °/s, and
±0.10 g. The source is 14 CFR Part 60, Appendix A, and EASA CS-FSTD(A), test 2.c.10.
"""

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.signals.messages import FloatArray
from advisor.gap.result import Yardsticks

BAND = {"theta": np.radians(1.5), "q": np.radians(2.0), "a_z": 0.10 * GRAVITY_M_S2}
"""Words: tolerance of simulator qualification for the short period, by channel, SI."""


def yardsticks(channel: str, measured: FloatArray, simulated: FloatArray) -> Yardsticks:
    """Return all measures of fidelity of one channel; both arrays have shape (n,)."""
    error = measured - simulated
    power = float(np.mean(error**2))
    size = float(np.sqrt(np.mean(measured**2)) + np.sqrt(np.mean(simulated**2)))
    spread_m, spread_s = float(np.std(measured)), float(np.std(simulated))
    bias = float(np.mean(error)) ** 2
    variance = (spread_m - spread_s) ** 2
    band = BAND.get(channel)
    return Yardsticks(
        theil=float(np.sqrt(power)) / size if size > 0.0 else float("nan"),
        bias=bias / power if power > 0.0 else 0.0,
        variance=variance / power if power > 0.0 else 0.0,
        covariance=max(1.0 - (bias + variance) / power, 0.0) if power > 0.0 else 1.0,
        r2=1.0 - power / spread_m**2 if spread_m > 0.0 else float("nan"),
        within_tolerance=None if band is None else float(np.mean(np.abs(error) <= band)),
    )
