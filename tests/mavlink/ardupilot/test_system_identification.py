"""SystemID's own records: each sweep is said, and marks its stretch where the vehicle's texts are lost."""

import numpy as np
import pytest

from advisor.flight.maneuvers.events import Notice, VehicleSaid
from advisor.flight.maneuvers.markers import SWEPT
from advisor.mavlink.ardupilot.log_health import lost_texts, sweeps
from advisor.mavlink.records.dataflash import RecordTable
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
