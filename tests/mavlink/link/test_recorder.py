import errno
import os
import shutil
import struct
import threading
import time
from datetime import UTC, datetime
from itertools import accumulate
from pathlib import Path

import pytest

from advisor.mavlink.link import recorder as recorder_module
from advisor.mavlink.link.recorder import Recorder, default_recording
from advisor.words.problems import UnusableInputError
from tests.mavlink.link.builders import Sender, attitude, wait_until


def test_what_was_written_is_on_the_disk_within_a_second_without_closing(tmp_path, monkeypatch):
    synced: list[int] = []
    monkeypatch.setattr(os, "fsync", lambda handle: synced.append(handle))
    recorder = Recorder(tmp_path / "a.tlog")
    recorder.write(b"one whole record")
    began = time.monotonic()
    wait_until(lambda: recorder.path.read_bytes() == b"one whole record", timeout_s=1.0)
    wait_until(lambda: len(synced) == 1, timeout_s=1.0)
    assert time.monotonic() - began < 1.0
    recorder.close()


def test_an_older_recording_is_never_overwritten(tmp_path: Path) -> None:
    (tmp_path / "a.tlog").write_bytes(b"old")
    recorder = Recorder(tmp_path / "a.tlog")
    recorder.write(b"new")
    recorder.close()
    assert (tmp_path / "a.tlog").read_bytes() == b"old"
    assert recorder.path.name == "a-2.tlog"
    assert recorder.path.read_bytes() == b"new"
    assert recorder.bytes_written == 3


def test_a_place_where_nothing_can_be_written_is_refused_with_what_to_do(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(UnusableInputError, match="--no-record"):
        Recorder(tmp_path / "file" / "a.tlog")


def test_what_a_full_disk_does_not_take_waits_and_is_written_when_there_is_room(tmp_path, monkeypatch):
    write, room = os.write, [6]

    def full(handle: int, data: bytes) -> int:
        if not room[0]:
            raise OSError(errno.ENOSPC, "No space left on device")
        taken = write(handle, data[: room[0]])
        room[0] -= taken
        return taken

    recorder = Recorder(tmp_path / "a.tlog")
    monkeypatch.setattr(os, "write", full)
    recorder.write(b"one whole record")
    wait_until(lambda: recorder.problem is not None, timeout_s=2.0)
    assert "No space left on device" in " ".join(recorder.take_notices())
    assert recorder.path.read_bytes() == b""
    assert recorder.recorded().unsaved == b"one whole record"
    room[0] = 1000
    recorder.write(b", and another")
    wait_until(lambda: recorder.problem is None, timeout_s=3.0)
    assert recorder.path.read_bytes() == b"one whole record, and another"
    assert "nothing is lost" in " ".join(recorder.take_notices())
    recorder.close()


def test_a_disk_that_does_not_answer_is_told_of_while_it_hangs(tmp_path, monkeypatch):
    free = threading.Event()
    monkeypatch.setattr(recorder_module, "OLD_AFTER_S", 0.2)
    monkeypatch.setattr(os, "fsync", lambda handle: free.wait(10.0))
    recorder = Recorder(tmp_path / "a.tlog")
    recorder.write(b"one whole record")
    wait_until(lambda: recorder.problem is not None, timeout_s=5.0)
    assert "the disk has not answered for 0 s; what is heard waits in memory" in recorder.take_notices()[0]
    recorder.write(b", and another")
    assert recorder.recorded().unsaved == b", and another"
    free.set()
    wait_until(lambda: recorder.problem is None, timeout_s=5.0)
    assert recorder.take_notices() == [f"recording to {recorder.path}: the disk answers again"]
    recorder.close()
    assert recorder.path.read_bytes() == b"one whole record, and another"


def test_little_space_is_said_at_the_start(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    usage = shutil.disk_usage(tmp_path)
    monkeypatch.setattr(shutil, "disk_usage", lambda path: usage._replace(free=150_000_000))
    recorder = Recorder(tmp_path / "a.tlog")
    assert "only 150 MB are free" in " ".join(recorder.take_notices())
    recorder.close()


@pytest.mark.parametrize("cut", range(0, 60, 3))
def test_a_recording_goes_on_behind_its_last_whole_record(tmp_path: Path, cut: int) -> None:
    sender = Sender()
    records = [
        struct.pack(">Q", 0xFD_FE_00_00 * 1_000_000 + i) + sender.pack(attitude(20 * i)) for i in range(40)
    ]
    path = tmp_path / "a.tlog"
    path.write_bytes(b"".join(records)[: -cut or None])
    ends = list(accumulate(map(len, records)))
    whole = sum(end <= path.stat().st_size for end in ends)
    recorder = Recorder(path, goes_on=True)
    recorder.write(records[0])
    recorder.close()
    assert recorder.before == ends[whole - 1]
    assert path.read_bytes() == b"".join([*records[:whole], records[0]])


def test_nothing_is_appended_to_what_is_no_telemetry_log(tmp_path: Path) -> None:
    (tmp_path / "a.tlog").write_bytes(b"an essay " * 100)
    with pytest.raises(UnusableInputError, match="nothing is appended"):
        Recorder(tmp_path / "a.tlog", goes_on=True)
    assert (tmp_path / "a.tlog").read_bytes() == b"an essay " * 100


def test_two_recorders_never_share_a_file(tmp_path: Path) -> None:
    first = Recorder(tmp_path / "a.tlog")
    with pytest.raises(UnusableInputError, match="being recorded by another program"):
        Recorder(tmp_path / "a.tlog", goes_on=True)
    first.close()


def test_recordings_are_named_by_their_start() -> None:
    path = default_recording(now=datetime(2026, 11, 20, 9, 5, 7, tzinfo=UTC))
    assert path.name == "2026-11-20T09-05-07Z.tlog"
    assert path.parent.name == "recordings"
