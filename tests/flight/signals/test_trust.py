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


def test_what_stands_still_on_the_ground_is_left_alone() -> None:
    at_rest = np.zeros(len(T))
    assert distrusted(channels(q=at_rest, theta=at_rest, a_z=at_rest - 9.8, alpha=at_rest)) == []


def test_nothing_flies_at_rest_so_a_carried_aircraft_has_no_dead_tube() -> None:
    assert frozen({"theta": (0.0, 0.3), "airspeed": (0.0, 0.0), "alpha": (0.0, 0.0)}) == []


@pytest.mark.parametrize(("name", "refuses"), [("a_z", False), ("alpha", False), ("q", True)])
def test_a_channel_that_stands_still_is_an_instrument_that_contradicts(name: str, refuses: bool) -> None:
    (still,) = frozen({"theta": (0.0, 0.3), name: (1.0, 1.0)})
    found = still.finding
    assert (found.code, found.contradicts, found.refuses) == (f"{name}_rate", True, refuses)
    assert "stands still" in found.text
