"""What is no regular file is refused before anything waits for it or reads without end."""

import os

import pytest

from tests.conftest import Advisor


@pytest.mark.parametrize("command", ["analyze", "doctor", "gap", "replay"])
@pytest.mark.parametrize("what", ["pipe", "folder", "device"])
def test_what_is_no_file_is_one_sentence_and_exit_code_3(command, what, advisor, tmp_path):
    place = tmp_path / "flight.tlog"
    if what == "pipe":
        os.mkfifo(place)
    elif what == "folder":
        place.mkdir()
    else:
        place.symlink_to("/dev/zero")
    run = advisor(command, place)
    assert run.returncode == 3
    assert run.stderr.count("\n") == 1
    assert ("folder" if what == "folder" else "not a file") in run.stderr


@pytest.mark.parametrize("command", ["analyze", "gap", "replay"])
@pytest.mark.parametrize("place", ["", ".", "/"])
def test_a_path_without_a_name_is_a_folder(command: str, place: str, advisor: Advisor) -> None:
    run = advisor(command, place)
    assert run.returncode == 3
    assert "is a folder" in run.stderr
