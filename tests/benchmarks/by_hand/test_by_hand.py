"""Flights by hand: the motion in still air is the rigid body's, and a case says what acts in its log."""

from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft_file.read import load_aircraft
from benchmarks.at_once.body import FLEET, Body, draw_body
from benchmarks.at_once.motion import level_state, rates, rates_in_gust
from benchmarks.by_hand.cases import KINDS, cases, draw_withheld
from benchmarks.by_hand.flight import Servos, fly, inputs_of
from sim.sealed.cases import SealedCase, write_case

SURFACES = np.array([0.01, -0.02, 0.03])


@pytest.fixture(scope="module", autouse=True)
def first() -> SealedCase:
    """The first flight of a seed, which compiles the motion on a new machine."""
    return next(iter(cases(2, 8)))


@pytest.fixture(scope="module")
def body() -> Body:
    return draw_body(np.random.default_rng(1), 4)


def test_in_still_air_the_motion_is_the_rigid_bodys(body: Body) -> None:
    x = level_state(body.speed, body.alpha) + np.array([0.5, 0.3, 0.2, 0.4, 0.1, 0.2, 0.05, 0.02, 0.0])
    still, felt = rates_in_gust(x, SURFACES, np.zeros(3), body.numbers)
    out, own = rates(x, SURFACES, body.numbers)
    assert still == pytest.approx(out)
    assert felt == pytest.approx(own)


def test_an_aircraft_that_drifts_with_a_steady_wind_flies_as_in_still_air(body: Body) -> None:
    """Newton's laws hold in a frame that moves at a constant speed: a wind changes the path alone."""
    x = level_state(body.speed, body.alpha) + np.array([0.0, 0.3, 0.2, 0.4, 0.1, 0.2, 0.0, 0.0, 0.0])
    wind = np.array([3.0, -1.0, 2.0])
    drifting = x.copy()
    drifting[:3] += wind
    out, felt = rates_in_gust(drifting, SURFACES, wind, body.numbers)
    still, own = rates(x, SURFACES, body.numbers)
    assert felt == pytest.approx(own)
    assert out[3:8] == pytest.approx(still[3:8])
    turning = np.cross(wind, x[3:6])
    assert out[:3] == pytest.approx(still[:3] + turning)


def test_the_hands_keep_every_aircraft_near_level_flight_between_the_tests() -> None:
    for kind in range(len(FLEET)):
        rng = np.random.default_rng(kind)
        aircraft = draw_body(rng, kind)
        tests = inputs_of(aircraft, "pitch", rng)
        flown = fly(aircraft, tests, Servos(dict.fromkeys(("elevator", "aileron", "rudder"), 0.04)), 0.0, rng)
        bank = flown.state[flown.t < tests[0].begin_s, 6]
        assert np.max(np.abs(bank)) < np.radians(10.0)


def test_play_holds_a_surface_back_by_half_its_width() -> None:
    withheld = draw_withheld("backlash", "lateral", np.random.default_rng(3))
    name, block, size = withheld.effect("lateral")
    assert name == f"{withheld.control}_actuator_backlash"
    assert block == withheld.control
    assert size["half_width_rad"] == 0.5 * withheld.servos.plays_rad[withheld.control]


def test_equal_seeds_give_equal_flights_and_each_file_is_read(first: SealedCase, tmp_path: Path) -> None:
    assert next(iter(cases(2, 8))).log == first.log
    write_case(first, tmp_path / "case")
    aircraft = load_aircraft(tmp_path / "case" / "aircraft.yaml")
    assert aircraft.model["M_alpha"] == pytest.approx(first.truth["derivatives"]["M_alpha"], rel=1e-4)


def test_a_third_of_the_kinds_has_nothing_withheld() -> None:
    assert KINDS.count("none") / len(KINDS) == pytest.approx(0.3)
