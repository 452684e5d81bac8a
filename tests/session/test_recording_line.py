"""What the crew sees of the recording of a link."""

from pathlib import Path

from advisor.mavlink.link.health import LinkStatistics
from advisor.session import live


def test_the_recording_is_told_with_its_size_and_the_free_disk(tmp_path: Path, monkeypatch) -> None:
    usage = type("Usage", (), {"free": 41_400_000_000})
    monkeypatch.setattr(live, "disk_usage", lambda folder: usage)
    link = LinkStatistics(recording=tmp_path / "x.tlog", recorded_bytes=3_240_000)
    assert live.recording_line(link) == "REC 3.2 MB, 41 GB free"
    usage.free = 900_000_000
    assert live.recording_line(link) == "REC 3.2 MB, 0.9 GB free"


def test_a_link_without_a_recording_says_so() -> None:
    assert live.recording_line(LinkStatistics()) == "NOT RECORDED"


def test_a_recording_that_the_disk_refuses_is_no_recording(tmp_path: Path) -> None:
    link = LinkStatistics(recording=tmp_path / "x.tlog", recording_problem="the disk is full")
    assert live.recording_line(link) == "REC STOPPED at 0.0 MB"
