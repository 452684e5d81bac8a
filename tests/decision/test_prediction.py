"""The predicted response to what was flown, and its band."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.bundled.study.campaigns import Scene, as_maneuver, fly_named, follow
from advisor.decision.history import CandidateManeuver
from advisor.decision.pooling import DERIVATIVES
from advisor.decision.prediction import missed_percent, predict, response_to
from advisor.flight.signals.record import Channel
from advisor.oem.surface import Servo
from advisor.process.arrays import FloatArray
from tests.decision.campaigns import THETA, estimate

SCENE = Scene()
FLIGHT = fly_named(SCENE, "3211")
MANEUVER = as_maneuver(FLIGHT)
MOMENTS_S = np.linspace(FLIGHT.t[0], FLIGHT.t[-1], 200)  # the moments of a prediction
DERIVED = THETA[list(DERIVATIVES)]
ONE = CandidateManeuver(estimate(), maneuver=MANEUVER)


def at_speed(airspeed_m_s: float) -> CandidateManeuver:
    """The same input, flown at a measured speed."""
    speed = Channel("airspeed", FLIGHT.t, np.full(len(FLIGHT.t), airspeed_m_s))
    return replace(ONE, maneuver=replace(MANEUVER, channels={**MANEUVER.channels, "airspeed": speed}))


def moved(k: int, by: float) -> FloatArray:
    """All derivatives, number ``k`` multiplied by one plus ``by``."""
    changed = DERIVED.copy()
    changed[k] *= 1.0 + by
    return changed


def test_the_response_is_the_simulators_deviation_from_trim() -> None:
    response = response_to(ONE, DERIVED, None)
    assert response is not None
    for k in range(2):
        true = np.interp(MOMENTS_S, FLIGHT.t, FLIGHT.response[:, k] - FLIGHT.trim[k])
        np.testing.assert_allclose(response.values[k], true, atol=2e-3 * np.max(np.abs(true)))


def test_the_servo_of_the_estimate_lies_before_the_surface() -> None:
    surface, _, _ = Servo(0.2).move(FLIGHT.t, FLIGHT.elevator, FLIGHT.t)
    lagging = follow(SCENE, FLIGHT.t, surface)
    response = response_to(replace(ONE, servo=Servo(0.2)), DERIVED, None)
    assert response is not None
    true = np.interp(MOMENTS_S, FLIGHT.t, lagging.response[:, 1])
    np.testing.assert_allclose(response.values[1], true, atol=3e-3 * np.max(np.abs(true)))


@pytest.mark.parametrize("k", range(6))
def test_the_slopes_are_the_change_of_the_response_with_each_derivative(k: int) -> None:
    here, less, more = (
        response_to(at_speed(80.0), d, 100.0) for d in (DERIVED, moved(k, -1e-4), moved(k, 1e-4))
    )
    assert here is not None
    assert less is not None
    assert more is not None
    change = (more.values - less.values) / (2e-4 * DERIVED[k])
    for output in range(3):
        np.testing.assert_allclose(
            here.slopes[output, :, k], change[output], atol=1e-4 * np.max(np.abs(change[output]))
        )


def test_at_another_speed_the_derivatives_are_scaled_with_it() -> None:
    # Z_alpha, Z_delta_e, M_q go with V, M_alpha and M_delta_e with its square.
    slower = response_to(at_speed(50.0), DERIVED, 100.0)
    scaled = response_to(ONE, DERIVED * [0.5, 1.0, 0.5, 0.25, 0.5, 0.25], None)
    assert slower is not None
    assert scaled is not None
    np.testing.assert_allclose(slower.values, scaled.values)


def test_the_band_is_that_of_responses_drawn_from_the_covariance() -> None:
    rng = np.random.default_rng(7)
    root = 0.01 * np.diag(np.abs(DERIVED)) @ rng.standard_normal((6, 6)) / np.sqrt(6.0)
    covariance = root @ root.T
    band = predict([ONE], DERIVED, None).percent(covariance)
    here = response_to(ONE, DERIVED, None)
    assert here is not None
    drawn = [response_to(ONE, d, None) for d in rng.multivariate_normal(DERIVED, covariance, 1500)]
    spread = np.std([r.values for r in drawn if r is not None], axis=0)
    for k, name in ((0, "alpha"), (1, "q")):
        widest = 196.0 * np.max(spread[k]) / here.peak[k]
        assert band[name] == pytest.approx(widest, rel=0.08)


def test_only_outputs_that_the_estimate_used_are_judged() -> None:
    fits = estimate().fits[0]
    blind = replace(ONE, estimate=replace(estimate(), fits=({"q": fits["q"], "a_z": fits["alpha"]},)))
    assert set(predict([ONE], DERIVED, None).slopes) == {"alpha", "q"}
    assert set(predict([blind], DERIVED, None).slopes) == {"q", "a_z"}


def test_a_derivative_of_which_nothing_is_known_leaves_the_response_unknown() -> None:
    covariance = np.diag((0.01 * DERIVED) ** 2)
    covariance[4, 4] = np.inf
    assert predict([ONE], DERIVED, None).percent(covariance) == {"alpha": np.inf, "q": np.inf}


def test_an_unstable_aircraft_is_predicted_until_a_deviation_has_doubled() -> None:
    unstable = np.array([-1.42, 0.0, -0.1, 9.64, -3.71, -12.0])
    growth = np.max(np.linalg.eigvals([[-1.42, 1.0], [9.64, -3.71]]).real)
    response = response_to(ONE, unstable, None)
    assert response is not None
    # The first step comes after one second; it is a step, so q begins as M_delta_e times its size.
    step_s = (1.0 + np.log(2.0) / growth) / 199.0
    moving = np.argmax(np.abs(response.values[1]) > 0.0)
    assert moving * step_s == pytest.approx(1.0, abs=0.05)
    band = predict([ONE], unstable, None).percent(np.diag((0.02 * unstable) ** 2))
    assert max(band.values()) < 10.0


def test_a_model_that_runs_away_predicts_nothing() -> None:
    wild = predict([ONE], 1e3 * np.abs(DERIVED), None)
    assert set(wild.percent(np.diag(DERIVED**2)).values()) == {np.inf}


def test_what_was_missed_is_the_largest_distance_over_the_peak() -> None:
    assert missed_percent(ONE, DERIVED, DERIVED, None) == 0.0
    # All inputs made stronger by a tenth: so is the response.
    stronger = DERIVED * [1.0, 1.0, 1.1, 1.0, 1.0, 1.1]
    assert missed_percent(ONE, stronger, DERIVED, None) == pytest.approx(10.0)


def test_without_knowing_what_was_flown_no_response_is_judged() -> None:
    assert predict([CandidateManeuver(estimate())], DERIVED, None).percent(np.eye(6)) == {}
    assert np.isnan(missed_percent(CandidateManeuver(estimate()), DERIVED, DERIVED, None))
