"""A pitch gyro that is mounted askew reads a part of the roll."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft import Aircraft
from advisor.gap.diagnose import diagnose
from tests.gap.generator import Setup, fly


def with_roll(flown, leaks, felt=0.0, seed=5):
    """The same manoeuvres with a roll rate in the log of which the pitch rate reads a part."""
    rng = np.random.default_rng(seed)
    rolling = []
    for m in flown:
        q, theta = m.channels["q"], m.channels["theta"]
        hz, phase = rng.uniform(0.3, 1.2, 3), rng.uniform(0.0, 6.0, 3)
        angles = 2.0 * np.pi * np.outer(q.t, hz) + phase
        p, bank = 0.15 * np.sum(np.cos(angles), axis=1), 0.15 * np.sin(angles) @ (0.5 / np.pi / hz)
        channels = {
            **m.channels,
            "p": replace(q, y=p + 0.002 * rng.standard_normal(len(p))),
            "q": replace(q, y=q.y + leaks * p),
            "theta": replace(theta, y=theta.y + felt * np.interp(theta.t, q.t, bank)),
        }
        rolling.append(replace(m, channels=channels))
    return rolling


@pytest.mark.parametrize("leaks", [0.1, -0.08])
def test_a_part_of_the_roll_rate_in_the_pitch_rate_is_unknown_in_its_gyro(leaks):
    found = diagnose(with_roll(fly(Setup(maneuvers=5)), leaks), Aircraft())
    assert (found.verdict, found.where.block) == ("unknown", "pitch_rate_sensor")
    assert any(f"reads {100.0 * leaks:+.0f} % of the roll rate" in note for note in found.notes)
    assert found.gap.before > 1.0


@pytest.mark.parametrize("leaks", [0.0, 0.03])
def test_a_gyro_that_is_mounted_as_gyros_are_is_no_cause(leaks):
    assert diagnose(with_roll(fly(Setup(maneuvers=5)), leaks), Aircraft()).verdict == "none"


def test_a_roll_that_pitches_the_aircraft_is_no_fault_of_the_gyro():
    found = diagnose(with_roll(fly(Setup(maneuvers=5)), 0.1, felt=0.1), Aircraft())
    assert not any("mounted askew" in note for note in found.notes)
