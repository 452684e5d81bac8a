"""Whole logs: recorded ones against pymavlink, and files that are no logs."""

import struct
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from advisor.mavlink.logs.formats.telemetry import read_tlog, scan_tlog
from advisor.mavlink.logs.logs import open_log
from advisor.mavlink.wire.definitions import DEFINITIONS
from advisor.mavlink.wire.frames import FrameScanner
from advisor.words.problems import UnusableInputError
from tests.mavlink.builders import LOGS, START_US, Sender, by_pymavlink, one_by_one, random_message, record

SHORT = "arduplane-default-rates.tlog"
"""A recorded flight that pymavlink reads in a quarter of a second."""


def small_log(count: int = 50) -> bytes:
    rng = np.random.default_rng(0)
    sender = Sender()
    names = list(DEFINITIONS)
    return b"".join(
        record(sender.frame(random_message(names[i % len(names)], rng)), START_US + 20_000 * i)
        for i in range(count)
    )


def read(path: Path) -> list[object]:
    return list(one_by_one([column for columns in open_log(path) for column in columns]))


@pytest.mark.parametrize(
    "path",
    [p if p.name == SHORT else pytest.param(p, marks=pytest.mark.study) for p in LOGS],
    ids=lambda path: path.name,
)
def test_a_recorded_flight_reads_field_for_field_as_by_pymavlink(path: Path) -> None:
    columns = [column for batch in read_tlog(path) for column in batch]
    theirs = by_pymavlink(path)
    assert one_by_one(columns) == [message for _, message in theirs]
    stamps = np.concatenate([column.arrival_s for column in columns])
    order = np.concatenate([column.order for column in columns])
    np.testing.assert_array_equal(stamps[np.argsort(order)], [stamp for stamp, _ in theirs])


@pytest.mark.parametrize("path", LOGS, ids=lambda path: path.name)
def test_a_recorded_flight_has_no_damage(path: Path) -> None:
    scanner = FrameScanner(wanted=["HEARTBEAT"])
    assert list(scan_tlog(path, scanner))
    assert scanner.statistics.damaged == 0
    assert scanner.statistics.skipped_bytes == 0


def test_the_size_of_the_chunks_has_no_influence(tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    path.write_bytes(small_log())
    whole = [column for batch in read_tlog(path) for column in batch]
    for chunk_bytes in (1, 7, 64, 1000):
        pieces = [column for batch in read_tlog(path, chunk_bytes=chunk_bytes) for column in batch]
        assert one_by_one(pieces) == one_by_one(whole)


def peak_memory_of_reading(path: Path) -> int:
    tracemalloc.start()
    for _ in read_tlog(path, chunk_bytes=1 << 16):
        pass
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return peak


def test_a_log_ten_times_as_long_streams_through_the_same_memory(tmp_path: Path) -> None:
    path = tmp_path / "long.tlog"
    path.write_bytes(small_log() * 200)
    peak_memory_of_reading(path)  # loads the compiled scanner
    short = peak_memory_of_reading(path)
    path.write_bytes(small_log() * 2000)
    assert peak_memory_of_reading(path) < 1.1 * short


@pytest.mark.parametrize("lost_bytes", [1, 5, 9, 20])
def test_a_log_cut_off_inside_a_frame_reads_up_to_the_cut(tmp_path: Path, lost_bytes: int) -> None:
    path = tmp_path / "cut.tlog"
    whole = small_log()
    path.write_bytes(whole)
    before = read(path)
    path.write_bytes(whole[:-lost_bytes])
    assert read(path) == before[:-1]


def test_the_name_of_a_log_does_not_matter(tmp_path: Path) -> None:
    path = tmp_path / "flight.dat"
    path.write_bytes(small_log())
    assert len(read(path)) == 50


def test_a_raw_recording_without_time_stamps_is_read_too(tmp_path: Path) -> None:
    sender, rng = Sender(), np.random.default_rng(0)
    path = tmp_path / "flight.tlog.raw"
    path.write_bytes(b"".join(sender.frame(random_message("ATTITUDE", rng)) for _ in range(5)))
    assert len(read(path)) == 5


def unusable(path: Path) -> UnusableInputError:
    with pytest.raises(UnusableInputError) as caught:
        list(open_log(path))
    assert caught.value.problem.fix
    assert path.name in caught.value.problem.text
    return caught.value


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    assert unusable(tmp_path / "nowhere.tlog").problem.code == "no_such_file"


def test_a_folder_is_no_log(tmp_path: Path) -> None:
    assert unusable(tmp_path).problem.code == "not_a_file"


def test_an_empty_file_is_said_to_be_empty(tmp_path: Path) -> None:
    path = tmp_path / "empty.tlog"
    path.touch()
    assert unusable(path).problem.code == "empty"


@pytest.mark.parametrize(
    "content",
    [
        b"a note of the flight\n" * 500,
        bytes(5000),
        np.random.default_rng(0).bytes(300_000),
        b"\xfd",
        struct.pack(">Q", START_US),
    ],
    ids=["text", "zeros", "noise", "one byte", "a stamp alone"],
)
def test_a_file_without_mavlink_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "some.tlog"
    path.write_bytes(content)
    assert unusable(path).problem.code == "not_a_tlog"
