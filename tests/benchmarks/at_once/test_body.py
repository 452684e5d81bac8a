"""The rigid body of the benchmark: its stated derivatives are those of its equations of motion."""

from collections.abc import Mapping

import numpy as np
import pytest

from benchmarks.at_once.body import FLEET, Body, draw_body
from benchmarks.at_once.motion import level_state, rates

STEP = 1e-5
PLACES = {"alpha": 2, "q": 4, "beta": 1, "p": 3, "r": 5}
"""Index in the state of what moves each angle of the air and rate."""
SURFACES = {"delta_e": 0, "delta_a": 1, "delta_r": 2}


def _slopes(body: Body, ending: str) -> Mapping[str, float]:
    """Return the slopes of forces over mass and speed, and of the angular accelerations."""
    trim, surfaces = level_state(body.speed, body.alpha), np.array([body.elevator, 0.0, 0.0])
    ends = []
    for side in (-1.0, 1.0):
        x, u = trim.copy(), surfaces.copy()
        if ending in SURFACES:
            u[SURFACES[ending]] += side * STEP
        elif ending == "alpha":
            x[[0, 2]] = body.speed * np.array(
                [np.cos(body.alpha + side * STEP), np.sin(body.alpha + side * STEP)]
            )
        else:
            x[PLACES[ending]] += side * STEP * (body.speed if ending == "beta" else 1.0)
        out, felt = rates(x, u, body.numbers)
        alpha = np.arctan2(x[2], x[0])
        lift = felt[2] * np.cos(alpha) - felt[0] * np.sin(alpha)
        ends.append(np.array([lift / body.speed, out[4], felt[1] / body.speed, out[3], out[5]]))
    return dict(zip("ZMYLN", (ends[1] - ends[0]) / (2.0 * STEP), strict=True))


@pytest.mark.parametrize("kind", [0, 4, 8])
def test_the_stated_derivatives_are_the_slopes_of_the_equations_of_motion(kind: int) -> None:
    body = draw_body(np.random.default_rng(kind), kind)
    told = body.derivatives(body.speed)
    for name, value in told.items():
        slope = _slopes(body, name[2:])[name[0]]
        assert value == pytest.approx(slope, rel=2e-3, abs=1e-6), name


@pytest.mark.parametrize("kind", range(len(FLEET)))
def test_every_aircraft_of_the_fleet_is_in_trim(kind: int) -> None:
    body = draw_body(np.random.default_rng(kind), kind)
    out, _ = rates(level_state(body.speed, body.alpha), np.array([body.elevator, 0.0, 0.0]), body.numbers)
    assert np.max(np.abs(out)) < 1e-6
