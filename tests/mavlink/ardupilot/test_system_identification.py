"""SystemID's own records: each sweep is said, and marks its stretch where the vehicle's texts are lost."""

import numpy as np
import pytest

from advisor.flight.maneuvers.maneuver import Notice, VehicleSaid
from advisor.flight.maneuvers.markers import SWEPT
from advisor.mavlink.ardupilot.log_health import health, lost_texts, sweeps
from advisor.mavlink.records.stretches import RecordTable
from tests.heard import hear_log
from tests.mavlink.ardupilot.test_autopilot_logs import dataflash_flight

SETTINGS = {"Ax": 21, "Mag": 5.0, "FSt": 0.5, "FSp": 5.0, "TR": 20.0}


def record(at_s, **fields):
    at = np.asarray(at_s, dtype=np.float64)
    columns = {name: np.broadcast_to(np.asarray(y), at.shape) for name, y in fields.items()}
    return RecordTable((100.0 * at).astype(np.int64), {"TimeUS": (1e6 * at).astype(np.int64), **columns})


def two_sweeps(*texts):
    """Sweeps of 20 s from 10 and from 50 s on, with these texts of the vehicle."""
    tables = {
        "SIDS": record([10.0, 50.0], **SETTINGS),
        "SIDD": record(np.r_[10.1:30.0:0.1, 50.1:70.0:0.1], Targ=0.0),
    }
    said = np.array([text.encode() for text in texts], dtype="S64")
    return {**tables, "MSG": record(10.0 + np.arange(len(texts)), Message=said)}


def test_a_sweep_is_said_with_its_axis_range_and_length():
    first, second = sweeps(two_sweeps())
    assert first.time_us == 10_000_000
    assert second.text == (
        "SystemID sweeps the pitch angle (SID_AXIS 21) from 0.5 to 5 Hz in 20 s, magnitude 5"
    )


def test_a_log_without_system_id_says_nothing_of_sweeps():
    assert list(sweeps({})) == []
    assert list(lost_texts({})) == []


def test_lost_texts_mark_each_sweep_from_its_settings_to_its_last_sample():
    found = [(round(1e-6 * time_us, 1), text) for _, time_us, text in lost_texts(two_sweeps())]
    begins, ends = b"SystemID Starting: axis=21", b"SystemID stopped"
    assert found == [(10.0, begins), (29.9, ends), (50.0, begins), (69.9, ends)]


def test_texts_that_the_log_holds_are_not_written_twice():
    whole = ["SystemID Starting: axis=21", "SystemID stopped"] * 2
    assert list(lost_texts(two_sweeps(*whole))) == []
    assert len(list(lost_texts(two_sweeps(*whole[:-1])))) == 4


def test_a_sweep_without_samples_has_no_end_to_mark():
    tables = two_sweeps()
    tables["SIDD"] = tables["SIDD"][tables["SIDD"].order < 4000]
    assert len(list(lost_texts(tables))) == 2


@pytest.mark.parametrize("mode", [0, 5])
def test_a_log_whose_texts_are_lost_has_the_sweep_as_a_manoeuvre(tmp_path, mode):
    log = tmp_path / "swept.bin"
    log.write_bytes(dataflash_flight(changes={10.0: mode}, swept_axis=23))
    heard = hear_log(log)
    (maneuver,) = heard.maneuvers
    assert maneuver.span.closed_by == SWEPT
    assert maneuver.span.end_s == pytest.approx(26.0, abs=0.05)
    said = [event.text for event in heard.events if isinstance(event, VehicleSaid | Notice)]
    assert any("SystemID sweeps the elevator (SID_AXIS 23)" in text for text in said)


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
