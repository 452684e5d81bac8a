"""A long log becomes messages stretch by stretch, and each stretch gives what the whole log would."""

from pathlib import Path

import numpy as np
import pytest

from advisor.flight.signals.messages import Columns
from advisor.mavlink.logs.formats import dataflash
from advisor.mavlink.logs.logs import open_log
from advisor.mavlink.records import record_scan
from tests.mavlink.ardupilot.test_autopilot_logs import dataflash_flight
from tests.mavlink.dataflash_writer import rewritten

FLIGHT_S = 40.0
WINDOW_BYTES = 6_000
"""Some two seconds of the flight: eight windows make a stretch of a quarter of a minute."""


def messages(path: Path) -> tuple[int, dict[str, list[Columns]]]:
    """The number of batches, and the messages by name."""
    batches = list(open_log(path))
    found: dict[str, list[Columns]] = {}
    for columns in (c for batch in batches for c in batch):
        found.setdefault(columns.name, []).append(columns)
    return len(batches), found


@pytest.mark.parametrize(
    "made",
    [
        lambda log: log,
        lambda log: rewritten(log, unhealthy={"ARSP": (12.0, 35.0)}),
        lambda log: rewritten(log, later_us=1_400_000_000_000_000),
        lambda log: rewritten(log, drop={"IMU"}),
    ],
    ids=["sound", "without a sound air speed for two stretches", "stamps from 1970", "rates from the angles"],
)
def test_a_log_in_stretches_gives_the_messages_of_the_whole(tmp_path, monkeypatch, made):
    path = tmp_path / "flight.bin"
    path.write_bytes(made(dataflash_flight(FLIGHT_S)))
    batches, whole = messages(path)
    assert batches == 1
    monkeypatch.setattr(record_scan, "WINDOW_BYTES", WINDOW_BYTES)
    batches, parts = messages(path)
    assert batches > 2
    assert parts.keys() == whole.keys()
    for name, (one,) in whole.items():
        np.testing.assert_array_equal(np.concatenate([c.order for c in parts[name]]), one.order)
        np.testing.assert_array_equal(np.concatenate([c.arrival_s for c in parts[name]]), one.arrival_s)
        for field, values in one.fields.items():
            np.testing.assert_array_equal(np.concatenate([c.fields[field] for c in parts[name]]), values)


def test_the_stretches_of_a_log_come_one_after_the_other(tmp_path, monkeypatch):
    path = tmp_path / "flight.bin"
    path.write_bytes(dataflash_flight(FLIGHT_S))
    monkeypatch.setattr(record_scan, "WINDOW_BYTES", WINDOW_BYTES)
    newest = -1
    for batch in dataflash.read_dataflash(path):
        assert min(int(c.order[0]) for c in batch) > newest
        newest = max(int(c.order[-1]) for c in batch)
