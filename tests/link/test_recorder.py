import os
import time
from datetime import UTC, datetime
from pathlib import Path

import pytest

from advisor.mavlink.recorder import Recorder, default_recording
from advisor.problems import UnusableInputError
from tests.link.builders import wait_until


def test_what_was_written_is_on_the_disk_within_a_second_without_closing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
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


def test_a_full_disk_ends_the_recording_and_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(handle: int) -> None:
        raise OSError(28, "No space left on device")

    recorder = Recorder(tmp_path / "a.tlog")
    monkeypatch.setattr(os, "fsync", full)
    recorder.write(b"record")
    wait_until(lambda: recorder.problem is not None, timeout_s=2.0)
    recorder.write(b"more")
    recorder.close()
    assert recorder.problem is not None
    assert "No space left on device" in recorder.problem


def test_recordings_are_named_by_their_start() -> None:
    path = default_recording(datetime(2026, 11, 20, 9, 5, 7, tzinfo=UTC))
    assert path.name == "2026-11-20T09-05-07Z.tlog"
    assert path.parent.name == "recordings"
