"""From the command to the surface: solved piece by piece, it is what small steps make of it."""

import numpy as np
import pytest

from advisor.gap.simulator.layout import EFFECT_ENTRIES, ENTRIES, INDEX
from advisor.gap.simulator.surface import surface

H, SMALL, DURATION = 0.005, 2e-5, 0.8
OF_THE_SURFACE = (
    "delay_s", "latency_s", "lag_s", "lag_damping", "slowness_s_rad",
    "half_play_rad", "play_side", "half_deadband_rad", "neutral_rad", "stop_up_rad", "stop_down_rad",
    "breakaway_rad", "sliding_share", "loop_s",
)  # fmt: skip


def test_what_the_surface_reads_stands_first_so_that_entries_added_later_do_not_move_it():
    assert EFFECT_ENTRIES[: len(OF_THE_SURFACE)] == OF_THE_SURFACE


def in_small_steps(t_u, u, held, late, rate, lag, play, dead):
    """Return the mean deflection over each step of ``H`` by the definitions of servo, linkage and band."""
    t = (np.arange(round(DURATION / SMALL)) + 0.5) * SMALL - late
    before = np.clip(np.searchsorted(t_u, t, side="right") - 1, 0, None)
    command = u[before] if held else np.interp(t, t_u, u)
    command = np.sign(command) * np.maximum(np.abs(command) - dead, 0.0)
    servo = link = command[0]
    flown = np.empty(len(t))
    for i, want in enumerate(command):
        wanted = (want - servo) * SMALL / lag if lag > 0.0 else want - servo
        servo += min(max(wanted, -rate * SMALL), rate * SMALL)
        link = min(max(link, servo - play), servo + play)
        flown[i] = link
    return flown.reshape(-1, round(H / SMALL)).mean(axis=1)


@pytest.mark.parametrize("held", [True, False])
@pytest.mark.parametrize(("holds", "share", "lag"), [(0.03, 0.3, 0.03), (0.01, 0.0, 0.01), (0.05, 0.8, 0.08)])
def test_a_surface_with_dry_friction_does_what_it_does_in_small_steps(held, holds, share, lag):
    rng = np.random.default_rng(9)
    t_u = np.arange(0.0, DURATION, 0.02)
    u = np.cumsum(rng.uniform(-0.02, 0.02, len(t_u))) + 0.08 * (t_u > 0.3)
    p = np.zeros(len(ENTRIES))
    p[[INDEX["breakaway_rad"], INDEX["sliding_share"], INDEX["loop_s"]]] = holds, share, lag
    p[INDEX["play_side"]] = -0.5
    t = (np.arange(round(DURATION / SMALL)) + 0.5) * SMALL
    before = np.clip(np.searchsorted(t_u, t, side="right") - 1, 0, None)
    command = u[before] if held else np.interp(t, t_u, u)
    at, way, flown = command[0] - 0.5 * holds, 0.0, np.empty(len(t))
    for i, want in enumerate(command):
        if way == 0.0 and abs(want - at) > holds:
            way = np.sign(want - at)
        pulled = way * (want - at) - share * holds
        way = way if pulled > 0.0 else 0.0
        at += way * pulled * SMALL / lag
        flown[i] = at
    expected = flown.reshape(-1, round(H / SMALL)).mean(axis=1)
    moved = surface(H, round(DURATION / H), t_u, u, held, 0.0, p)
    assert moved == pytest.approx(expected, abs=2e-4)
    assert np.ptp(expected) > 0.05


@pytest.mark.parametrize("held", [True, False])
@pytest.mark.parametrize(
    ("rate", "lag", "play", "dead"),
    [
        (1.1, 0.0, 0.0, 0.0), (0.5, 0.03, 0.0, 0.0), (np.inf, 0.0, 0.012, 0.0), (np.inf, 0.03, 0.012, 0.0),
        (2.0, 0.02, 0.008, 0.0), (np.inf, 0.0, 0.0, 0.015), (2.0, 0.0, 0.01, 0.0),
    ],
)  # fmt: skip
def test_a_servo_with_limits_does_what_it_does_in_small_steps(held, rate, lag, play, dead):
    rng = np.random.default_rng(8)
    t_u = np.arange(0.0, DURATION, 0.02)
    u = np.zeros(len(t_u))
    for step in rng.uniform(0.1, 0.6, 4):
        u[t_u > step] += rng.uniform(-0.1, 0.1)
    late = float(rng.uniform(0.0, 0.03))
    p = np.zeros(len(ENTRIES))
    names = ("delay_s", "lag_s", "slowness_s_rad", "half_play_rad", "half_deadband_rad")
    p[[INDEX[name] for name in names]] = late, lag, 1.0 / rate, play, dead
    found = surface(H, round(DURATION / H), t_u, u, held, 0.0, p)
    expected = in_small_steps(t_u, u, held, late, rate, lag, play, dead)
    assert np.sum(found - expected) * H == pytest.approx(0.0, abs=2e-5)
    assert found == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize("held", [True, False])
def test_a_surface_moves_from_its_trim_as_far_as_its_stops_and_no_further(held):
    rng = np.random.default_rng(9)
    t_u = np.arange(0.0, DURATION, 0.02)
    u = 0.02 + rng.uniform(-0.1, 0.1, len(t_u)).cumsum() * 0.4
    p = np.zeros(len(ENTRIES))
    p[INDEX["stop_up_rad"]], p[INDEX["stop_down_rad"]] = 0.03, 0.05
    found = surface(H, round(DURATION / H), t_u, u, held, 0.02, p)
    t = (np.arange(round(DURATION / SMALL)) + 0.5) * SMALL
    command = u[np.searchsorted(t_u, t, side="right") - 1] if held else np.interp(t, t_u, u)
    stopped = np.clip(command - 0.02, -0.05, 0.03).reshape(len(found), -1).mean(axis=1)
    assert found == pytest.approx(stopped, abs=2e-4)
    assert np.max(found) <= 0.03 + 1e-12
    assert np.min(found) >= -0.05 - 1e-12


@pytest.mark.parametrize("play", [0.0, 0.01])
@pytest.mark.parametrize("held", [True, False])
def test_a_command_before_the_record_moves_the_surface_until_it_begins(held: bool, play: float) -> None:
    rng = np.random.default_rng(10)
    t_u = np.arange(-1.0, DURATION, 0.02)
    u = rng.uniform(-0.1, 0.1, len(t_u)).cumsum() * 0.2
    p = np.zeros(len(ENTRIES))
    p[INDEX["lag_s"]], p[INDEX["half_play_rad"]] = 0.14, play
    whole = surface(H, round((1.0 + DURATION) / H), t_u + 1.0, u, held, 0.0, p)
    found = surface(H, round(DURATION / H), t_u, u, held, 0.0, p)
    assert found == pytest.approx(whole[round(1.0 / H) :], abs=1e-9)


def test_a_servo_of_second_order_trails_a_ramp_by_its_lag_and_overshoots_as_its_damping_says():
    p = np.zeros(len(ENTRIES))
    p[INDEX["lag_s"]], p[INDEX["lag_damping"]] = 0.1, 0.7
    h, n = 0.001, 2000
    ramp = surface(h, n, np.array([0.0, 10.0]), np.array([0.0, 10.0]), False, 0.0, p)
    assert ramp[-1] == pytest.approx((n - 0.5) * h - 0.1, abs=1e-3)
    step = surface(h, n, np.array([0.0, 0.1, 0.100001, 10.0]), np.array([0.0, 0.0, 1.0, 1.0]), False, 0.0, p)
    assert step.max() - 1.0 == pytest.approx(np.exp(-np.pi * 0.7 / np.sqrt(1.0 - 0.7**2)), rel=0.02)


def test_a_dead_band_off_the_trim_swallows_one_side_only():
    p = np.zeros(len(ENTRIES))
    p[INDEX["half_deadband_rad"]], p[INDEX["neutral_rad"]] = 0.01, 0.01
    t = np.array([0.0, 0.4, 0.400001, 1.0])

    def answer(level: float) -> float:
        u = np.array([0.0, 0.0, level, level])
        return float(surface(0.005, 200, t, u, False, 0.0, p)[-1])

    assert answer(0.015) == pytest.approx(0.0)
    assert answer(0.03) == pytest.approx(0.01)
    assert answer(-0.02) == pytest.approx(-0.02)
