"""From the command to the surface: solved piece by piece, it is what small steps make of it."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.gap_flights import maneuvers_of
from advisor.gap.simulator.layout import EFFECT_ENTRIES, ENTRIES, INDEX
from advisor.gap.simulator.surface import surface
from sim.effects.fitting import flight_of
from sim.record import record
from sim.scenario import read_scenario
from tests.gap.diagnosed import diagnose
from tests.gap.generator import Setup, fly

pytestmark = pytest.mark.study
"""Whole diagnoses, run by ``make study-gap``."""

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


def test_a_dead_band_that_moves_with_the_trim_is_one_as_well():
    rested_at = (0.0, 0.03, -0.02, 0.01, -0.03, 0.02)
    flown = []
    for maneuver, above in zip(fly(Setup(maneuvers=6, switches={"deadband": 0.012})), rested_at, strict=True):
        command = maneuver.channels["elevator"]
        shifted = replace(command, y=command.y + above)
        flown.append(replace(maneuver, channels={**maneuver.channels, "elevator": shifted}))
    found = diagnose(flown, Aircraft())
    (cause,) = [c for c in found.causes if c.present]
    assert cause.effect == "actuator_deadband"
    assert cause.parameters["half_width_rad"].value == pytest.approx(0.012, rel=0.05)
    assert "around its trim" in found.sentence


def test_play_below_a_tenth_of_a_degree_has_a_name_in_a_quiet_record():
    found = diagnose(fly(Setup(maneuvers=6, switches={"play": 0.0012}, noise=0.002, seed=71)), Aircraft())
    (cause,) = [c for c in found.causes if c.present]
    assert cause.effect == "actuator_backlash"
    assert cause.parameters["half_width_rad"].value == pytest.approx(0.0012, rel=0.05)


def test_a_dead_band_below_a_tenth_of_a_degree_has_none_in_noise():
    loud = diagnose(fly(Setup(maneuvers=6, switches={"deadband": 0.0012}, noise=0.02, seed=71)), Aircraft())
    assert not any(c.present for c in loud.causes)


def test_a_servo_at_its_limit_is_no_later_for_steps_that_lie_anywhere_between_two_stamps(tmp_path):
    limited = (
        "aircraft: uav\nseed: 2\nloop_hz: 250\nunit_s: 0.36\n"
        "noise: {alpha_deg: 0.03, pitch_rate_deg_s: 0.1, pitch_deg: 0.03, accelerometer_m_s2: 0.03}\n"
        'maneuvers: ["3211", "rev", doublet, "rev", "3211"]\n'
        "effects: {actuator_rate_limit: {rate_rad_s: 1.2}}\n"
    )
    (tmp_path / "uav.yaml").write_text(limited)
    record(flight_of(read_scenario(tmp_path / "uav.yaml")), tmp_path / "uav.tlog")
    found = diagnose(maneuvers_of([tmp_path / "uav.tlog"], Aircraft()).maneuvers, Aircraft())
    (cause,) = [c for c in found.causes if c.present]
    assert cause.effect == "actuator_rate_limit"


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
