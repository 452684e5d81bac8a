"""The share of the air speed that heights must explain, on hand-made climbs without noise."""

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from advisor.gap.uncatalogued.wind_shear import Shear, wind_shear

SPEED_M_S = 20.0
T = np.arange(0.0, 10.0, 0.05)
CLIMB_ANGLE = 0.3 * np.sin(0.5 * np.pi * T)
CLIMBED = SPEED_M_S * cumulative_trapezoid(np.sin(CLIMB_ANGLE), T, initial=0.0)
PARABOLA = np.linalg.qr(np.vander(T, 3))[0]


def free(y):
    """Return a course without its parabola."""
    return y - PARABOLA @ (PARABOLA.T @ y)


def climbing(wind, height_m=None):
    """Return a manoeuvre that climbs and sinks at α = 0 in balance, with ``wind`` added to its air speed."""
    channels = {
        "airspeed": SPEED_M_S + wind,
        "a_x": GRAVITY_M_S2 * np.sin(CLIMB_ANGLE),
        "a_z": -GRAVITY_M_S2 * np.cos(CLIMB_ANGLE),
        "theta": CLIMB_ANGLE,
        "alpha": np.zeros(len(T)),
    }
    if height_m is not None:
        channels["height"] = CLIMBED - np.mean(CLIMBED) + height_m
    span = Span(0.0, 1.0, 8.0, 10.0, "3-2-1-1", (), "quiet")
    return Maneuver(1, 0, span, {name: Channel(name, T, y) for name, y in channels.items()})


def rough(seen, share):
    """Return air that heights do not explain; ``seen`` then has a ``share`` of the power."""
    alternating = free(np.where(np.arange(len(T)) % 2, 1.0, -1.0))
    power = float(free(seen) @ free(seen)) * (1.0 - share) / share
    return alternating * np.sqrt(power / float(alternating @ alternating))


def everywhere(share):
    wind = 0.15 * CLIMBED
    return [climbing(wind + rough(wind, share)) for _ in range(5)]


@pytest.mark.parametrize(("share", "is_found"), [(0.155, False), (0.185, True)])
def test_heights_must_explain_17_percent_of_the_air_speed(share, is_found):
    found = wind_shear(everywhere(share))
    assert (found is not None) == is_found
    if found is not None:
        assert found.share == pytest.approx(share, abs=0.01)
        assert found.gradient_per_s == pytest.approx(0.15, rel=0.03)


@pytest.mark.parametrize(("share", "is_found"), [(0.155, False), (0.185, True)])
def test_heights_must_explain_17_percent_in_a_layer(share, is_found):
    """Three manoeuvres fly in the layer, and three below it in calm air. All heights explain half as much."""
    wind = 0.2 * CLIMBED
    air = rough(wind, share)
    inside = [climbing(wind + air, height_m=200.0) for _ in range(3)]
    below = [climbing(1e-3 * air, height_m=100.0) for _ in range(3)]
    found = wind_shear(inside + below)
    assert (found is not None) == is_found


@pytest.mark.parametrize(("gradient", "agreed"), [(0.079, False), (-0.081, True)])
def test_a_gradient_below_a_knot_in_six_metres_does_not_matter(gradient, agreed):
    assert Shear(gradient, 0.0, 0.5, maneuvers=5).is_agreed == agreed
