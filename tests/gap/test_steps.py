"""An instrument that reads in steps is at fault, though in quiet it rests on one of them."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft import Aircraft
from advisor.gap.diagnose import diagnose
from advisor.gap.records.prepare import prepare
from tests.gap.generator import Setup, fly

pytestmark = pytest.mark.study
"""Whole diagnoses, run by ``make study-gap``."""


def rounded(flown, channel, step, noise=0.0, seed=0):
    """The same with one channel rounded to a step, and noise added after that."""
    rng = np.random.default_rng(seed)

    def read(c):
        steps = step * np.round(c.y / step)
        return replace(c, y=steps + noise * rng.standard_normal(len(c.y)))

    return [replace(m, channels={**m.channels, channel: read(m.channels[channel])}) for m in flown]


@pytest.mark.parametrize(
    ("channel", "block", "step", "noise"),
    [
        ("q", "pitch_rate_sensor", 0.025, 0.002),
        ("alpha", "alpha_sensor", 0.006, 0.0005),
        # So coarse, and without noise, that it repeats itself for most of the time.
        ("alpha", "alpha_sensor", 0.02, 0.0),
    ],
)
def test_an_instrument_that_reads_in_steps_is_unknown_and_its_step_is_said(channel, block, step, noise):
    flown = rounded(fly(Setup(maneuvers=6, noise=0.005, seed=71)), channel, step, noise)
    found = diagnose(flown, Aircraft())
    assert found.verdict == "unknown"
    assert found.where.block == block
    [said] = [note for note in found.notes if "steps of" in note]
    percent = float(said.split("steps of ")[1].split(" %")[0])
    flights = prepare(flown, Aircraft())
    peak = flights.peaks[flights.channels.index(channel)]
    assert percent == pytest.approx(100.0 * step / peak, rel=0.05)


def test_errors_that_go_up_and_down_with_a_reading_that_may_be_anything_are_no_steps():
    bent = []
    for m in fly(Setup(maneuvers=6, noise=0.005, seed=71)):
        q = m.channels["q"]
        wavy = replace(q, y=q.y + 0.005 * np.sin(2.0 * np.pi * q.y / 0.025))
        bent.append(replace(m, channels={**m.channels, "q": wavy}))
    assert not any("steps of" in note for note in diagnose(bent, Aircraft()).notes)


def test_steps_as_fine_as_a_messages_resolution_are_none():
    flown = fly(Setup(maneuvers=6, noise=0.005, seed=71))
    assert diagnose(rounded(flown, "q", 0.001), Aircraft()).verdict == "none"


def test_beside_an_effect_that_explains_nearly_all_a_coarse_reading_is_not_asked_about():
    iced = fly(Setup(maneuvers=6, noise=0.002, switches={"ice": 0.4}, ice_after=3, seed=71))
    found = diagnose(rounded(iced, "alpha", 0.003), Aircraft())
    assert found.verdict == "effect"
    assert found.causes[0].effect == "icing"
