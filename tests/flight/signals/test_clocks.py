"""The vehicle's clock: wraps, reboots, late and wild stamps."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from advisor.flight.signals.clocks import BootClock, place

WRAP_32_US_S = 2**32 / 1e6


def advanced(*stamps_ms):
    clock = BootClock()
    return clock.advance(np.array(stamps_ms, dtype=np.int64)), clock


def test_milliseconds_run_on_through_the_wrap_after_fifty_days():
    stamps, clock = advanced(2**32 - 40, 2**32 - 20, 0, 20)
    assert np.diff(stamps.t) == pytest.approx([0.02, 0.02, 0.02])
    assert clock.boot == 0


def test_a_late_packet_keeps_its_own_time_and_is_no_reboot():
    stamps, clock = advanced(60_000, 60_020, 59_900, 60_040)
    assert stamps.t.tolist() == [60.0, 60.02, 59.9, 60.04]
    assert clock.boot == 0


def test_a_reboot_starts_another_boot_once_three_stamps_agree():
    stamps, clock = advanced(300_000, 300_020, 1_000, 1_020, 1_040, 1_060)
    assert np.isnan(stamps.t[2:4]).all()
    assert stamps.t[4:].tolist() == [1.04, 1.06]
    assert stamps.boot.tolist() == [0, 0, 0, 0, 1, 1]
    assert clock.newest_s == 1.06


def test_one_wild_stamp_changes_nothing():
    stamps, clock = advanced(60_000, 60_020, 4_000_000_000, 60_040, 5, 60_060)
    assert stamps.t[[0, 1, 3, 5]].tolist() == [60.0, 60.02, 60.04, 60.06]
    assert np.isnan(stamps.t[[2, 4]]).all()
    assert clock.boot == 0


def test_after_a_long_silence_time_goes_on_in_the_same_boot():
    stamps, clock = advanced(60_000, 400_000, 400_020, 400_040, 400_060)
    assert stamps.t[3:].tolist() == [400.04, 400.06]
    assert clock.boot == 0


@given(
    boot_s=st.floats(1.0, 4.0e6),
    late_s=st.floats(-1.0, 1.0),
)
def test_a_wrapped_counter_is_placed_where_it_belongs_at_any_time_since_boot(boot_s, late_s):
    ticks = np.array([int(boot_s * 1e6) % 2**32])
    placed = place(ticks, 1e-6, np.array([boot_s + late_s]))
    assert placed[0] == pytest.approx(boot_s, abs=2e-6)


def test_a_counter_that_does_not_wrap_is_left_alone():
    boot_s = 3 * WRAP_32_US_S + 5.0
    assert place(np.array([int(boot_s * 1e6)]), 1e-6, np.array([boot_s]))[0] == pytest.approx(boot_s)


@pytest.mark.parametrize("ticks", [0, 1_790_000_000_000_000])
def test_a_stamp_that_says_nothing_of_the_boot_gives_way_to_the_time_of_arrival(ticks):
    assert place(np.array([ticks]), 1e-6, np.array([100.0]))[0] == 100.0


def test_a_stamp_of_another_clock_is_not_believed():
    assert np.isnan(place(np.array([50_000_000]), 1e-6, np.array([100.0]))[0])
    assert np.isnan(place(np.array([50_000_000]), 1e-6, np.array([np.nan]))[0])


@pytest.mark.parametrize("late_ms", [2_500, 15_000])
def test_packets_of_a_path_that_is_seconds_late_are_left_out_and_are_no_reboot(late_ms):
    late = [300_000 - late_ms + 20 * i for i in range(5)]
    stamps, clock = advanced(300_000, *late, 300_020)
    assert np.isnan(stamps.t[1:6]).all()
    assert stamps.t[6] == 300.02
    assert clock.boot == 0


@pytest.mark.parametrize(("age_s", "boot"), [(19, 0), (21, 1)])
def test_stamps_of_a_second_path_up_to_20_s_old_are_no_reboot_and_older_ones_are(age_s, boot):
    old = [60_000 - 1000 * age_s + 20 * k for k in range(4)]
    stamps, clock = advanced(60_000, 60_020, *old)
    assert clock.boot == boot
    assert np.isnan(stamps.t[2:4]).all()
