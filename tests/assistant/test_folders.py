"""An assistant reads files inside its folders only."""

from pathlib import Path

import pytest

from advisor.assistant.folders import Folders, RefusedError, folders_of


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


@pytest.mark.parametrize("name", ["deep", "none.tlog", "--help"])
def test_what_is_no_file_is_refused(folders: Folders, name: str) -> None:
    with pytest.raises(RefusedError, match="no file"):
        folders.file(name)


def test_a_file_above_the_limit_is_refused(folders: Folders) -> None:
    (folders.roots[0] / "large.bin").write_bytes(b"12345678901")
    with pytest.raises(RefusedError, match="reads at most"):
        folders.file("large.bin")


def test_logs_are_listed_without_links_that_lead_out(folders: Folders) -> None:
    assert [path.name for path in folders.logs()] == ["one.tlog"]
