"""The file beside a log: read as it was written, whole whenever power fails, its mistakes told."""

import os
from pathlib import Path

import pytest

from advisor.analysis.marks_file import keep_by_hand, path_beside, read_by_hand, write_by_hand
from advisor.campaign.state import NOTHING, ByHand, Remark
from advisor.flight.maneuvers.marks import Mark
from advisor.words.problems import ConfigurationError

DECIDED = ByHand(
    marks=(Mark(312.4, 330.117, 0), Mark(5.0, 9.0, 1)),
    excluded=(Remark(82.3, "böige Luft: gust"),),
    notes=(Remark(113.36, "rough hands"), Remark(113.36, "again\nrough", 1)),
    remarks=(Remark(100.0, "flaps"),),
)


def times(by_hand: ByHand) -> list[tuple[float, float, int]]:
    return [(mark.start_s, mark.end_s, mark.boot or 0) for mark in by_hand.marks]


def test_its_name_is_that_of_the_log(tmp_path: Path) -> None:
    assert path_beside(tmp_path / "flight.tlog") == tmp_path / "flight.maneuvers.yaml"
    assert path_beside(tmp_path / "00000001.BIN") == tmp_path / "00000001.maneuvers.yaml"


def test_what_was_written_is_read_again(tmp_path: Path) -> None:
    log = tmp_path / "flight.tlog"
    write_by_hand(log, DECIDED)
    read = read_by_hand(log)
    assert times(read) == times(DECIDED)
    assert (read.excluded, read.notes, read.remarks) == (DECIDED.excluded, DECIDED.notes, DECIDED.remarks)


def test_without_a_file_nothing_was_decided(tmp_path: Path) -> None:
    assert read_by_hand(tmp_path / "flight.tlog") == NOTHING


def test_a_file_without_entries_decides_nothing(tmp_path: Path) -> None:
    log = tmp_path / "flight.tlog"
    write_by_hand(log, NOTHING)
    assert read_by_hand(log) == NOTHING


def test_a_mark_written_by_hand_needs_no_number_of_the_power_on(tmp_path: Path) -> None:
    log = tmp_path / "flight.tlog"
    path_beside(log).write_text("maneuvers: [{start_s: 12, end_s: 24.5}]", encoding="utf-8")
    (mark,) = read_by_hand(log).marks
    assert (mark.start_s, mark.end_s, mark.boot) == (12.0, 24.5, None)


def test_a_failure_while_writing_leaves_the_old_file_and_nothing_else(tmp_path, monkeypatch):
    log = tmp_path / "flight.tlog"
    write_by_hand(log, DECIDED)
    before = path_beside(log).read_bytes()

    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    assert "cannot be kept" in keep_by_hand(log, NOTHING)
    assert path_beside(log).read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["flight.maneuvers.yaml"]


def test_it_is_on_the_disk_before_it_takes_the_place_of_the_old_one(tmp_path, monkeypatch):
    done: list[str] = []
    replaced = Path.replace
    monkeypatch.setattr(os, "fsync", lambda descriptor: done.append("on the disk"))
    monkeypatch.setattr(Path, "replace", lambda a, b: (done.append("renamed"), replaced(a, b))[1])
    write_by_hand(tmp_path / "flight.tlog", DECIDED)
    assert done == ["on the disk", "renamed"]


MISTAKES = {
    "maneuvers: [": "not a YAML file, line",
    "- 1": "file: must hold keys with values",
    "marks: []": "marks: unknown key",
    "maneuvers: 3": "maneuvers: input should be a valid list",
    "maneuvers: [{start_s: 3, end: 4}]": "maneuvers[0].end: unknown key",
    "maneuvers: [{start_s: three, end_s: 4}]": "maneuvers[0].start_s: must be a number",
    "maneuvers: [{start_s: 5, end_s: 4}]": "end_s must lie after start_s",
    "maneuvers: [{start_s: 5, end_s: 400}]": "by at most 100 s",
    "maneuvers: [{start_s: 5, end_s: 9, boot: x}]": "maneuvers[0].boot: must be the number",
    "notes: [{at_s: 5}]": "notes[0].text: field required",
    "excluded: [{at_s: .nan, because: gust}]": "excluded[0].at_s: must be a number",
}


@pytest.mark.parametrize("content", MISTAKES)
def test_a_mistake_is_told_with_its_place_and_a_mend(tmp_path: Path, content: str) -> None:
    log = tmp_path / "flight.tlog"
    path_beside(log).write_text(content, encoding="utf-8")
    with pytest.raises(ConfigurationError) as told:
        read_by_hand(log)
    assert MISTAKES[content] in str(told.value)
    assert str(told.value).endswith("Fix the file, move it away, or give --no-marks.")
