"""The study's own linear aircraft: exact, and noisy as the chosen reading says."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from advisor.bundled.study.campaigns import NOISE_READINGS, ORDER, TABLE_1, Scene, fly_named, noise_scale

SCENE = Scene()


def test_the_response_is_that_of_the_differential_equations() -> None:
    flight = fly_named(SCENE, "3211")
    p = SCENE.aircraft

    def rates(t: float, x: np.ndarray) -> list[float]:
        elevator = np.interp(t, flight.t, flight.elevator)
        return [
            p.Z_0 + p.Z_alpha * x[0] + (1.0 + p.Z_q) * x[1] + p.Z_delta_e * elevator,
            p.M_0 + p.M_alpha * x[0] + p.M_q * x[1] + p.M_delta_e * elevator,
        ]

    checked = slice(0, 200)
    solved = solve_ivp(
        rates, (0.0, 4.0), flight.response[0], t_eval=flight.t[checked], rtol=1e-10, atol=1e-12, max_step=0.01
    )
    np.testing.assert_allclose(flight.response[checked], solved.y.T, atol=1e-8)


def test_a_manoeuvre_begins_and_ends_at_trim() -> None:
    for name in set(ORDER):
        flight = fly_named(SCENE, name)
        np.testing.assert_allclose(flight.response[0], flight.trim)
        excursion = np.abs(flight.response - flight.trim).max(axis=0)
        assert np.all(np.abs(flight.response[-1] - flight.trim) < 0.02 * excursion)


def test_the_reverse_is_the_mirror_image_about_trim() -> None:
    up, down = fly_named(SCENE, "3211"), fly_named(SCENE, "rev")
    np.testing.assert_allclose(up.response - up.trim, -(down.response - down.trim), atol=1e-12)


@pytest.mark.parametrize("reading", NOISE_READINGS)
def test_noise_is_a_share_of_what_the_reading_names(reading: str) -> None:
    flight = fly_named(SCENE, "3211")
    scale = noise_scale(flight, reading)  # type: ignore[arg-type]
    deviation = flight.response - flight.trim
    if reading == "sample":
        np.testing.assert_array_equal(scale, np.abs(deviation))
    else:
        assert scale.shape == (2,)
        assert np.all(scale <= np.abs(flight.response).max(axis=0) * 1.0001)


def test_the_papers_table_has_both_rules_at_three_noise_levels() -> None:
    assert len(TABLE_1) == 6
    assert TABLE_1["continuous", 5.0].needed is None
    assert TABLE_1["separate", 5.0].error_percent["Z_q"] == 30.85
