"""Which channels cannot be right, by what the others say."""

import numpy as np
import pytest

from advisor.flight.signals.record import Channel
from advisor.flight.signals.trust import distrusted, frozen

T = np.arange(0.0, 8.0, 0.02)
THETA = np.radians(4.0) * np.sin(4.0 * T)
Q = np.radians(16.0) * np.cos(4.0 * T)


def channels(**changed: np.ndarray) -> dict[str, Channel]:
    flown = {
        "q": Q,
        "theta": THETA,
        "a_z": -9.8 - 3.0 * Q,
        "alpha": 0.05 + 0.2 * THETA,
        "airspeed": 20.0 - THETA,
        "elevator": np.zeros(len(T)),
    }
    return {name: Channel(name, T, y) for name, y in (flown | changed).items()}


def test_a_flight_that_agrees_with_itself_is_trusted() -> None:
    assert distrusted(channels()) == []


@pytest.mark.parametrize("name", ["q", "a_z", "alpha", "airspeed"])
def test_a_channel_that_stands_still_in_flight_is_named(name: str) -> None:
    (found,) = distrusted(channels(**{name: np.full(len(T), 7.0)}))
    assert (found.code, found.channel) == ("frozen", name)
    assert "stands still" in found.text
    assert found.stops == (name == "q")


@pytest.mark.parametrize(("factor", "ratio"), [(-1.0, -1.0), (57.3, 0.0175), (0.1, 10.0)])
def test_a_pitch_rate_in_another_unit_or_sense_contradicts_the_pitch_angle(
    factor: float, ratio: float
) -> None:
    (found,) = distrusted(channels(q=factor * Q))
    assert (found.code, found.stops) == ("contradiction", True)
    assert found.value == pytest.approx(ratio, rel=0.01)


def test_a_steady_turn_is_no_contradiction() -> None:
    bank, turn = np.radians(50.0), 0.5
    told = channels(q=Q / np.cos(bank) + turn * np.sin(bank))
    told |= {
        "r": Channel("r", T, np.full(len(T), turn * np.cos(bank))),
        "bank": Channel("bank", T, np.full(len(T), bank)),
    }
    assert distrusted(told) == []


def test_what_stands_still_on_the_ground_is_left_alone() -> None:
    at_rest = np.zeros(len(T))
    assert distrusted(channels(q=at_rest, theta=at_rest, a_z=at_rest - 9.8, alpha=at_rest)) == []


def test_nothing_flies_at_rest_so_a_carried_aircraft_has_no_dead_tube() -> None:
    assert frozen({"theta": (0.0, 0.3), "airspeed": (0.0, 0.0), "alpha": (0.0, 0.0)}) == []


def test_a_gap_leaves_the_pitch_rate_without_an_integral() -> None:
    kept = (T < 2.0) | (T > 5.0)
    torn = {name: Channel(name, T[kept], c.y[kept]) for name, c in channels(q=-Q).items()}
    assert distrusted(torn) == []
