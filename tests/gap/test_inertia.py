"""Rolling with yawing pitches an aircraft by its moments of inertia, in every model of the diagnosis."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.signals.record import Channel
from advisor.gap.candidates.known import INERTIA, rolls
from advisor.gap.records.flights import PreparedManeuver, PreparedManeuvers
from advisor.gap.records.prepare import prepare
from advisor.gap.search.baseline import fit_unfiltered
from advisor.gap.simulator.layout import INDEX, ROLL_YAW, SQUARES
from advisor.oem.rows import Signal
from tests.gap.generator import Setup, fly

P_RAD_S, R_RAD_S = 0.8, 0.5


def _rolling(maneuvers: int = 1) -> PreparedManeuvers:
    """Manoeuvres in which the aircraft rolls and yaws at two rates of its own."""
    rolled = []
    for m in fly(Setup(maneuvers=maneuvers)):
        t = m.channels["q"].t
        rates = {"p": P_RAD_S * np.sin(2.0 * t), "r": R_RAD_S * np.sin(3.0 * t + m.number)}
        channels = {name: Channel(name, t, y) for name, y in rates.items()}
        rolled.append(replace(m, channels={**m.channels, **channels}))
    return prepare(rolled, Aircraft())


def _turning(flight: PreparedManeuver, row: int, value: float) -> PreparedManeuver:
    """The manoeuvre with one constant product of its rates, and without the other."""
    slow = flight.slow.copy()
    slow[[ROLL_YAW, SQUARES]] = 0.0
    slow[row] = value
    return replace(flight, slow=slow)


def _change(numbers: dict[str, float], row: int, value: float) -> dict[str, np.ndarray]:
    """Change of each output by a constant product of the rates."""
    flights = _rolling()
    problem, fitted = fit_unfiltered(flights, Aircraft())
    p = problem.driving(fitted.point)
    p[0, [INDEX[name] for name in numbers]] = list(numbers.values())
    flight = flights.flights[0]
    still, turning = (problem.fly_and_read(_turning(flight, row, size), p)[:, 0] for size in (0.0, value))
    ends = np.cumsum([len(flight.outputs[name].t) for name in flights.channels])[:-1]
    return dict(zip(flights.channels, np.split(turning - still, ends), strict=True))


@pytest.mark.parametrize(("entry", "row"), [("inertia_share", ROLL_YAW), ("inertia_product", SQUARES)])
def test_a_product_of_the_rates_accelerates_the_pitch_rate(entry, row):
    numbers = {"inertia_share": 0.0, "inertia_product": 0.0, "M_alpha": 0.0, "M_q": 0.0} | {entry: 0.6}
    q = _change(numbers, row, 0.1)["q"][:50]
    assert np.polyfit(0.02 * np.arange(50), q, 1)[0] == pytest.approx(0.06, rel=0.01)


def test_an_accelerometer_ahead_of_the_centre_of_gravity_turns_with_both_rates():
    numbers = {"inertia_share": 0.0, "inertia_product": 0.0, "imu_arm_m": 2.0}
    assert _change(numbers, ROLL_YAW, 0.1)["a_z"][0] == pytest.approx(0.2, rel=0.02)


def test_a_record_tells_the_products_of_its_rates():
    flight = _rolling().flights[0]
    t = flight.started_s + (np.arange(flight.n) + 0.5) * flight.h
    p, r = P_RAD_S * np.sin(2.0 * t), R_RAD_S * np.sin(3.0 * t + flight.number)
    assert flight.slow[ROLL_YAW] == pytest.approx(p * r, abs=2e-3)
    assert flight.slow[SQUARES] == pytest.approx(r**2 - p**2, abs=2e-3)


def test_the_fit_finds_the_moments_of_inertia_next_to_the_derivatives():
    flights = _rolling(3)
    problem, fitted = fit_unfiltered(flights, Aircraft())
    p = problem.driving(fitted.point)
    p[:, INDEX["inertia_share"]], p[:, INDEX["inertia_product"]] = 0.9, 0.08
    rng = np.random.default_rng(4)
    flown = []
    for flight, numbers in zip(flights.flights, p, strict=True):
        read = problem.fly_and_read(flight, numbers[None])[:, 0]
        outputs, at = dict(flight.outputs), 0
        for name in flights.channels:
            t = flight.outputs[name].t
            noise = 0.002 * (10.0 if name == "a_z" else 1.0)
            outputs[name] = Signal(t, read[at : at + len(t)] + noise * rng.standard_normal(len(t)))
            at += len(t)
        flown.append(replace(flight, outputs=outputs))
    _, again = fit_unfiltered(replace(flights, flights=tuple(flown)), Aircraft())
    share, product = again.point.values[again.point.effects.index(INERTIA)]
    assert 0.5 + share == pytest.approx(0.9, abs=0.05)
    assert product == pytest.approx(0.08, abs=0.02)


@pytest.mark.parametrize(("share", "free"), [(1.0, True), (0.2, True), (0.01, False)])
def test_moments_of_inertia_are_free_where_the_gyro_shows_them(share, free):
    """A fifth of the rates shows in all samples together, and in none alone; noise hides a hundredth."""
    flights = _rolling()
    less = [replace(f, slow=f.slow * np.where(_rows(f), share**2, 1.0)) for f in flights.flights]
    assert rolls(replace(flights, flights=tuple(less))) is free


def _rows(flight: PreparedManeuver) -> np.ndarray:
    return np.isin(np.arange(len(flight.slow)), [ROLL_YAW, SQUARES])[:, None]
