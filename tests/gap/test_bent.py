"""A curve has its own angle: at other speeds the same wing is flown on another part of it."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.candidates.known import variants_for
from advisor.gap.records.prepare import prepare
from advisor.gap.simulator.layout import ENTRIES, INDEX
from tests.gap.generator import UAV, Setup, fly


def test_the_same_curve_about_another_angle_is_the_same_moment():
    flights = prepare(fly(Setup(maneuvers=4, speed_change=0.2, seed=9)), Aircraft())
    about_trims = next(v for v in variants_for(flights) if v.effect == "nonlinear_pitching_moment")
    (about_one,) = about_trims.likewise
    p = np.zeros((4, len(ENTRIES)))
    about_one.apply(p, (50.0, -700.0), flights)
    trims = np.array([f.alpha_trim for f in flights.flights])
    x = np.linspace(-0.05, 0.05, 5)[:, None]

    def curve(angle):
        return 50.0 * angle**2 - 700.0 * angle**3

    apart = trims - np.median(trims)
    made = p[:, INDEX["M_alpha"]] * x + p[:, INDEX["M_alpha2"]] * x**2 + p[:, INDEX["M_alpha3"]] * x**3
    assert np.max(np.abs(apart)) > 0.02
    assert made == pytest.approx(curve(x + apart) - curve(apart), abs=1e-12)


def test_trims_that_are_all_alike_leave_nothing_to_tell_apart():
    flights = prepare(fly(Setup(maneuvers=3, seed=10)), Aircraft(airspeed_m_s=UAV.speed))
    bent = [
        v for v in variants_for(flights) if v.effect in ("nonlinear_pitching_moment", "elevator_nonlinearity")
    ]
    assert [v.likewise for v in bent] == [(), ()]
