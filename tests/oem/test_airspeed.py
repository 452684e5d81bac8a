"""The lag of an air speed indicator, from the change of speed that accelerometers show."""

import numpy as np
import pytest

from advisor.flight.signals.record import Channel
from advisor.oem.airspeed import airspeed

T = np.arange(0.0, 12.0, 0.1)
RATE = 2.0 * np.pi / 6.0


def swinging(late_s: float, noise_m_s: float):
    """Level flight whose speed swings by 1 m/s about 20 m/s, read late and with noise."""
    noise = noise_m_s * np.random.default_rng(8).standard_normal(len(T))
    told = {
        "airspeed": 20.0 + np.sin(RATE * (T - late_s)) + noise,
        "a_x": RATE * np.cos(RATE * T),
        "a_z": np.full_like(T, -9.80665),
        "theta": np.zeros_like(T),
        "alpha": np.zeros_like(T),
    }
    return {name: Channel(name, T, y, "VFR_HUD.airspeed", "measured") for name, y in told.items()}


@pytest.mark.parametrize(("noise_m_s", "lag_s"), [(0.05, 0.4), (0.3, 0.4), (0.8, 0.0)])
def test_a_lag_counts_that_removes_a_third_of_the_disagreement(noise_m_s: float, lag_s: float) -> None:
    found = airspeed(swinging(0.4, noise_m_s))
    assert found is not None
    assert found.smooth == (noise_m_s < 0.6)
    assert found.lag_s == pytest.approx(lag_s, abs=0.15)
