from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.controls import Elevator
from advisor.aircraft.reference import PARAMETERS
from advisor.oem.estimator import estimate
from advisor.oem.missing import in_words, price
from advisor.oem.problem import OutputErrorProblem, Record
from advisor.oem.rows import Signal
from advisor.oem.solution import solve
from tests.oem.builders import UAV, elevator_3211, flown, simulate, trim_alpha, trim_elevator

SPEED_M_S = 25.0
NOISE = 0.02


def record(*outputs):
    """Return the small aircraft's manoeuvre: all channels equally clear, and ``outputs`` handed over."""
    rng = np.random.default_rng(3)
    t = np.arange(0.0, 8.0, 0.02)
    u = elevator_3211(t, trim=trim_elevator(UAV), amplitude=0.03, unit_s=0.4)
    x = simulate(UAV, [trim_alpha(UAV), 0.0], t, u, t)
    alpha_dot = UAV[0] + UAV[1] * x[:, 0] + (1.0 + UAV[2]) * x[:, 1] + UAV[3] * u
    clean = {"alpha": x[:, 0], "q": x[:, 1], "theta": x[:, 2]}
    clean["a_z"] = SPEED_M_S * (alpha_dot - x[:, 1]) - 9.80665
    noisy = {n: Signal(t, y + NOISE * y.std() * rng.standard_normal(len(t))) for n, y in clean.items()}
    speed = Signal(t[[0, -1]], np.full(2, SPEED_M_S))
    return Record(Signal(t, u), {n: noisy[n] for n in outputs}, airspeed=speed)


def errors(*outputs):
    return np.sqrt(np.diag(solve(OutputErrorProblem((record(*outputs),))).covariance_cr))


def test_the_price_of_missing_acceleration_is_what_the_fit_with_it_shows():
    without = solve(OutputErrorProblem((record("alpha", "q"),)))
    real = errors("alpha", "q") / errors("alpha", "q", "a_z")
    np.testing.assert_allclose(price(without), real, rtol=0.1)


def test_without_air_speed_the_price_of_acceleration_is_unknown_and_nothing_is_said():
    without = solve(OutputErrorProblem((replace(record("alpha", "q"), airspeed=None),)))
    assert price(without) is None
    assert in_words(None) == ""


def test_a_channel_that_would_bring_nothing_is_said_to():
    assert "more than 5 % larger" in in_words(np.ones(len(PARAMETERS)))


def test_the_notes_of_an_estimate_put_the_price_beside_the_missing_channel():
    known = Aircraft(elevator=Elevator(lag_s=0.0), airspeed_m_s=SPEED_M_S)
    found = estimate(flown(UAV, unit_s=0.4, noise=0.02, length_s=8.0), known)
    note = next(note for note in found.notes if "The fit lacks the vertical acceleration" in note)
    assert "by factors" in note or "more than 5 %" in note
