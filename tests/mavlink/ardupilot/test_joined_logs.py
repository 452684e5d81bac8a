"""Two logs joined into one file are two logs, however each numbers its types."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from advisor.flight.signals.messages import Columns
from advisor.mavlink.logs.formats import dataflash
from advisor.mavlink.logs.logs import open_log
from advisor.mavlink.records import record_scan
from advisor.mavlink.records.record_scan import known_lengths, scan_records
from advisor.mavlink.records.stretches import RecordTable, read_stretches
from tests.mavlink.ardupilot.test_autopilot_logs import dataflash_flight
from tests.mavlink.dataflash_writer import rewritten

BASE = Path(__file__).parents[2] / "cases" / "base.bin"
FMT = 0x80


def renumbered(log: bytes) -> bytes:
    """The log with the types of its records interchanged."""
    stream = np.frombuffer(log, dtype=np.uint8).copy()
    starts = np.empty(len(stream) // 4 + 1, dtype=np.int64)
    starts = starts[: scan_records(stream, starts, known_lengths(), True)[0]]
    definitions = starts[stream[starts + 2] == FMT]
    numbers = sorted({int(n) for n in stream[definitions + 3]} - {FMT})
    other = dict(zip(numbers, [*numbers[1:], numbers[0]], strict=True)) | {FMT: FMT}
    for at in starts.tolist():
        if stream[at + 2] == FMT:
            stream[at + 3] = other[int(stream[at + 3])]
        else:
            stream[at + 2] = other[int(stream[at + 2])]
    return stream.tobytes()


def joined(tmp_path: Path) -> Path:
    log = BASE.read_bytes()
    path = tmp_path / "joined.bin"
    path.write_bytes(log + renumbered(log))
    return path


def logs(path: Path, names: Sequence[str]) -> list[dict[str, RecordTable]]:
    """The records of each log, in one stretch."""
    return [stretch.tables for stretch in read_stretches(path, names, length=np.inf)]


def test_each_of_two_joined_logs_keeps_its_own_types(tmp_path: Path) -> None:
    (alone,) = logs(BASE, ["ATT", "RCOU"])
    first, second = logs(joined(tmp_path), ["ATT", "RCOU"])
    for name in ("ATT", "RCOU"):
        for field, values in alone[name].fields.items():
            assert first[name].fields[field].tolist() == values.tolist()
            assert second[name].fields[field].tolist() == values.tolist()


def test_the_messages_of_both_joined_logs_arrive_one_log_after_the_other(tmp_path: Path) -> None:
    first, second = open_log(joined(tmp_path))
    assert {c.name: len(c) for c in first} == {c.name: len(c) for c in second}
    assert max(int(c.order[-1]) for c in first) < min(int(c.order[0]) for c in second)


@pytest.mark.parametrize("window", [300, 1000, 4096, 100_003])
def test_a_file_read_in_small_windows_gives_the_records_of_one_large_window(tmp_path, monkeypatch, window):
    path = joined(tmp_path)
    damaged = bytearray(path.read_bytes())
    for at in np.random.default_rng(3).integers(5_000, len(damaged), 200).tolist():
        damaged[at] ^= 0x41
    path.write_bytes(damaged)
    names = ("ATT", "IMU", "RCOU", "PARM", "MSG", "GPS")
    whole = logs(path, names)
    monkeypatch.setattr(record_scan, "WINDOW_BYTES", window)
    parts = logs(path, names)
    assert [tables.keys() for tables in parts] == [tables.keys() for tables in whole]
    for one, other in zip(parts, whole, strict=True):
        for name, table in one.items():
            np.testing.assert_array_equal(table.order, other[name].order)
            for field, values in table.fields.items():
                np.testing.assert_array_equal(values, other[name].fields[field])


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
