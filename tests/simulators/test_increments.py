"""Increments of force and moment, held against the simulation in which the diagnosis finds effects."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.records.prepare import prepare
from advisor.gap.simulator.layout import DERIVATIVES, ENTRIES, INDEX
from advisor.simulators.as_given import Flying, added, beyond
from advisor.simulators.linear import LinearSimulator
from advisor.simulators.surrogate import Surrogate
from tests.simulators.nonlinear import flown

MODEL = dict(zip(DERIVATIVES, (-2.7, 0.02, -0.15, -23.0, -3.4, -29.0), strict=True))
HEIGHTS, NO_CONTROLS = {1: 300.0, 2: 300.0}, {1: {}, 2: {}}


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"M_alpha": -30.0, "M_q": -2.5, "Z_alpha": -3.3, "M_delta_e": -25.0},
        {"M_delta2": 60.0, "M_delta3": 900.0},
        {"M_alpha2": 60.0, "M_alpha3": -300.0},
        {"Z_alpha2": 9.0, "Z_alpha3": -60.0},
        {"stall_rad": 0.06, "stall_sharpness": 20.0},
        {"lift_share": 0.3, "lift_lag_s": 0.15, "moment_share": 0.3},
        {"lift_h": 0.2, "M_h": 1.5, "scale_m": 300.0},
        {"alpha_scale": 0.1, "alpha_lag_s": 0.05, "vane_arm_m": 0.4},
        {"q_bias": 0.01, "q_scale": 0.05, "imu_arm_m": 0.3},
        {"mode_rate_gain": 0.4, "mode_rad_s": 25.0, "mode_damping": 0.05, "mode_attitude": 1.0},
        {"alpha_skew_s": 0.03, "q_skew_s": -0.02},
        {"delay_s": 0.04, "lag_s": 0.06},
        {"half_play_rad": 0.006},
    ],
    ids=lambda changes: "-".join(changes) or "none",
)
def test_an_effect_added_to_the_linear_simulator_is_that_of_the_diagnosis(changes):
    flights = prepare(flown(maneuvers=2), Aircraft())
    simulator = LinearSimulator(MODEL, flights.reference_m_s)
    flying = Flying(simulator, flights, HEIGHTS, NO_CONTROLS, None, lambda *_: None)
    p = np.zeros((len(flights), len(ENTRIES)))
    p[:, : len(MODEL)] = list(MODEL.values())
    as_given = p[0, : len(MODEL)].copy()
    for name, value in changes.items():
        p[:, INDEX[name]] = value
    began = flying.as_flown(flying.replays(p, held=False))
    replays = flying.replays(p, False, added(began, p, as_given))
    apart = beyond(flying, replays, p)
    moved = EffectProblem(replace(flights, flights=tuple(began)), p)
    for grid, flight, numbers in zip(apart, began, p, strict=True):
        size = np.ptp(moved.fly(flight, numbers), axis=1)
        assert np.max(np.abs(grid), axis=1) / size == pytest.approx(0.0, abs=0.02)


def test_without_an_effect_the_linear_simulator_and_its_surrogate_are_one():
    flights = prepare(flown(maneuvers=2), Aircraft())
    flying = Flying(
        LinearSimulator(MODEL, flights.reference_m_s), flights, HEIGHTS, NO_CONTROLS, None, lambda *_: None
    )
    p = np.zeros((len(flights), len(ENTRIES)))
    p[:, : len(MODEL)] = list(MODEL.values())
    assert np.max(np.abs(beyond(flying, flying.replays(p, held=False), p))) < 1e-9
    assert Surrogate(MODEL, flights.reference_m_s).lag_s == 0.0
