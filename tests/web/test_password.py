"""The password of the pages: its sources, and what is said of a file that others can read."""

import os
from pathlib import Path

import pytest

from advisor.web.access import VARIABLE, read_password


@pytest.fixture
def crew(tmp_path: Path) -> Path:
    file = tmp_path / "crew.txt"
    file.write_text("windsock-27\nsecond line\n")
    return file


@pytest.mark.skipif(os.name != "posix", reason="permissions of other users exist on POSIX only")
@pytest.mark.parametrize(
    ("mode", "others_read"),
    [(0o600, False), (0o400, False), (0o640, True), (0o604, True), (0o620, True), (0o610, True)],
)
def test_a_file_that_the_group_or_others_reach_is_named_with_its_mend(crew, capsys, mode, others_read):
    crew.chmod(mode)
    assert read_password(crew, "") == "windsock-27"
    said = f"other users can read {crew}: chmod 600 {crew}\n"
    assert capsys.readouterr().err == (said if others_read else "")


def test_the_variable_gives_the_password_and_is_removed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, "from-the-variable")
    assert read_password(None, "") == "from-the-variable"
    assert VARIABLE not in os.environ


def test_a_file_comes_before_the_variable(crew: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    crew.chmod(0o600)
    monkeypatch.setenv(VARIABLE, "from-the-variable")
    assert read_password(crew, "") == "windsock-27"


def test_no_password_is_needed_on_this_computer(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    assert read_password(None, "") is None
