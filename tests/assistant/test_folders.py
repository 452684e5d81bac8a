"""An assistant reads files inside its folders only."""

import os
from pathlib import Path

import pytest

from advisor.assistant.server import Folders, RefusedError, folders_of


@pytest.fixture
def folders(tmp_path: Path) -> Folders:
    inside = tmp_path / "flights"
    (inside / "deep").mkdir(parents=True)
    (inside / "deep" / "one.tlog").write_bytes(b"12345")
    (inside / "notes.txt").write_bytes(b"")
    (tmp_path / "secret.tlog").write_bytes(b"")
    (inside / "out.tlog").symlink_to(tmp_path / "secret.tlog")
    return folders_of([inside], most_bytes=10)


def test_a_file_is_found_by_its_path_and_relative_to_a_folder(folders: Folders) -> None:
    found = folders.file("deep/one.tlog")
    assert folders.file(str(found)) == found


@pytest.mark.parametrize("name", ["../secret.tlog", "/etc/passwd", "out.tlog", "deep/../../secret.tlog"])
def test_a_path_that_leaves_the_folders_is_refused(folders: Folders, name: str) -> None:
    with pytest.raises(RefusedError, match="outside the folders"):
        folders.file(name)


@pytest.mark.parametrize("name", ["none.tlog", "--help"])
def test_what_is_no_file_is_refused(folders: Folders, name: str) -> None:
    with pytest.raises(RefusedError, match="no file"):
        folders.file(name)


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("deep", "deep is a folder: name a log in it."),
        ("fifo.tlog", "fifo.tlog is a pipe, socket or device, not a file."),
        ("", "The name of the file is empty: give a path inside the folders of this server."),
        ("a\0b", "The name of the file holds a zero byte, which no path may hold."),
        ("circle.tlog", "circle.tlog cannot be read: its links lead in a circle."),
        ("x" * 300, f"{'x' * 100} cannot be read: File name too long."),
    ],
)
def test_each_refusal_is_one_sentence_with_its_reason(folders: Folders, name: str, why: str) -> None:
    os.mkfifo(folders.roots[0] / "fifo.tlog")
    (folders.roots[0] / "circle.tlog").symlink_to("circle.tlog")
    with pytest.raises(RefusedError) as refused:
        folders.file(name)
    assert str(refused.value) == why


def test_large_sizes_are_said_in_gigabytes(tmp_path: Path) -> None:
    with (tmp_path / "sparse.bin").open("wb") as file:
        file.truncate(2_500_000_000)
    with pytest.raises(RefusedError, match=r"has 2\.5 GB, and this server reads at most 2 GB\."):
        folders_of([tmp_path], 2_000_000_000).file("sparse.bin")


def test_a_file_above_the_limit_is_refused(folders: Folders) -> None:
    (folders.roots[0] / "large.bin").write_bytes(b"12345678901")
    with pytest.raises(RefusedError, match="reads at most"):
        folders.file("large.bin")


def test_logs_are_listed_without_links_that_lead_out(folders: Folders) -> None:
    assert [path.name for path in folders.logs()] == ["one.tlog"]
