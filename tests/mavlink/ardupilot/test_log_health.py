"""Dropped records and a clock that GPS time contradicts are faults of the log, and are said."""

import numpy as np
import pytest

from advisor.mavlink.ardupilot.log_health import health
from advisor.mavlink.records.dataflash import RecordTable


def gps(clock_speed: float, jitter_s: float = 0.02, seconds: float = 60.0) -> RecordTable:
    """GPS records at 5 Hz, written by a clock of this speed, late by a random time."""
    true_s = np.arange(0.0, seconds, 0.2)
    late_s = np.random.default_rng(4).uniform(0.0, jitter_s, len(true_s))
    boot_us = (1e6 * (100.0 + clock_speed * true_s + late_s)).astype(np.int64)
    week = np.full(len(true_s), 2300)
    fields = {"TimeUS": boot_us, "GWk": week, "GMS": (1e3 * (5000.0 + true_s)).astype(np.int64)}
    return RecordTable(np.arange(len(true_s)), fields)


def dsf(*dropped: int) -> RecordTable:
    n = len(dropped)
    return RecordTable(np.arange(n), {"TimeUS": np.arange(n) * 1_000_000, "Dp": np.array(dropped)})


@pytest.mark.parametrize(("speed", "said"), [(1.03, "runs 3.0 % fast"), (0.97, "runs 3.0 % slow")])
def test_a_clock_that_gps_time_contradicts_is_said(speed: float, said: str) -> None:
    (one,) = health({"GPS": gps(speed)})
    assert said in one.text


def test_a_right_clock_is_not_mentioned() -> None:
    assert list(health({"GPS": gps(1.0)})) == []
    assert list(health({"GPS": gps(1.0001)})) == []


def test_a_few_late_records_do_not_make_a_wrong_clock() -> None:
    assert list(health({"GPS": gps(1.0, jitter_s=0.5, seconds=5.0)})) == []


def test_a_log_without_a_fix_says_nothing_of_the_clock() -> None:
    table = gps(1.03)
    table.fields["GWk"][:] = 0
    assert list(health({"GPS": table})) == []


def test_dropped_records_are_said_with_their_number() -> None:
    (one,) = health({"DSF": dsf(0, 0, 37, 37)})
    assert "dropped 37 records" in one.text
    assert one.time_us == 2_000_000
    assert list(health({"DSF": dsf(0, 0)})) == []
