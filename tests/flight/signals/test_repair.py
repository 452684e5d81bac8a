"""Single samples that no aircraft can have flown are left out and said; everything else stays."""

import numpy as np
import pytest

from advisor.flight.signals.record import Channel
from advisor.flight.stream.maneuver_records import repaired
from tests.rows import row

T = 0.02 * np.arange(401)
MOTION = 0.06 * np.exp(-0.3 * T) * np.sin(3.0 * T) + 1e-3 * np.random.default_rng(2).standard_normal(len(T))


def channel(y: np.ndarray, name: str = "q") -> Channel:
    return Channel(name, T, y)


def test_wild_samples_are_left_out_and_counted() -> None:
    y = MOTION.copy()
    wild = [40, 100, 250, 390]
    y[wild] = [3.0, -3.0, 3.0, 3.0]
    found = repaired(channel(y))
    assert found.channel.t.tolist() == np.delete(T, wild).tolist()
    assert found.channel.y.tolist() == np.delete(MOTION, wild).tolist()
    assert found.said == ("4 of 401 pitch rate samples are wild and left out.",)


def test_a_sound_motion_stays_as_it_is() -> None:
    found = repaired(channel(MOTION))
    assert found.channel.y is MOTION
    assert found.said == ()


def test_an_angle_of_attack_counted_from_0_to_360_deg_is_put_right() -> None:
    """An angle that goes through zero."""
    found = repaired(channel(np.mod(MOTION, 2.0 * np.pi), "alpha"))
    assert found.channel.y == pytest.approx(MOTION, abs=1e-12)
    assert "from 0 to 360 deg" in found.said[0]


def test_an_air_speed_that_drops_out_is_bridged_and_named() -> None:
    y = 25.0 + np.sin(T)
    dead = (T > 3.0) & (T < 4.5)
    y[dead] = 0.0
    found = repaired(channel(y, "airspeed"))
    assert found.channel.t.tolist() == T[~dead].tolist()
    assert "drops out from 0:03.0 to 0:04.5 and is bridged" in found.said[0]


K = np.arange(len(T))
CALM = 1e-4 * np.random.default_rng(3).standard_normal(len(T))


@row("a step in a calm record is no wild sample", "q", CALM + 0.2 * (K >= 200))
@row("a channel full of spikes is left to the other checks", "q", MOTION + 3.0 * (K % 10 == 0))
@row("the elevator may jump", "elevator", 0.3 * (K == 100))
@row("an aircraft on the ground has no drop-out", "airspeed", 1.0 * (T >= 6.0) + 0.01 * np.sin(50.0 * T))
def test_no_sample_is_left_out(name: str, y: np.ndarray) -> None:
    assert len(repaired(channel(y, name)).channel) == len(T)
