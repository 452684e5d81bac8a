"""A file that is replaced is whole, old or new, and no link in a shared folder leads the writing astray."""

import os
import secrets
from pathlib import Path

import pytest

from advisor.process.atomic_file import write_atomically


def test_a_link_under_the_temporary_name_is_not_followed(tmp_path, monkeypatch):
    victim = tmp_path / "victim"
    victim.write_text("as before")
    monkeypatch.setattr(secrets, "token_hex", lambda size: "foreseen")
    (tmp_path / ".page.html.foreseen").symlink_to(victim)
    with pytest.raises(FileExistsError):
        write_atomically(tmp_path / "page.html", "new")
    assert victim.read_text() == "as before"


def test_a_link_of_the_final_name_is_replaced_and_its_target_stays(tmp_path: Path) -> None:
    victim, page = tmp_path / "victim", tmp_path / "page.html"
    victim.write_text("as before")
    page.symlink_to(victim)
    write_atomically(page, "new")
    assert (page.read_text(), page.is_symlink(), victim.read_text()) == ("new", False, "as before")


def test_a_file_is_written_with_the_permissions_that_the_user_gives_to_new_files(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        write_atomically(tmp_path / "page.html", b"new")
    finally:
        os.umask(before)
    assert (tmp_path / "page.html").stat().st_mode & 0o777 == 0o640
    assert [path.name for path in tmp_path.iterdir()] == ["page.html"]
