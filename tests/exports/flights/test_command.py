"""``advisor export`` on bad input: one sentence, the exit code, and nothing half-written."""

import sys
from pathlib import Path

import pytest

from advisor.exports.flights.formats import staged
from advisor.words.problems import ConfigurationError
from tests.conftest import Advisor
from tests.flights import TWO, recorded
from tests.full_disk import files_of_at_most

pytestmark = pytest.mark.usefixtures("recorded_analyses")


def test_the_default_is_csv(advisor: Advisor, tmp_path: Path) -> None:
    run = advisor("export", recorded("linear", 1.0, maneuvers=TWO), "-o", tmp_path / "out")
    assert run.returncode == 0
    assert "manoeuvres: 2; formats: csv." in run.stdout
    assert (tmp_path / "out" / "maneuvers.csv").exists()
    assert {path.suffix for path in (tmp_path / "out").iterdir()} == {"", ".csv", ".json"}


@pytest.fixture
def of_two_logs(advisor: Advisor, tmp_path: Path) -> Path:
    """Return the folder into which two logs were exported."""
    logs = [recorded("linear", 1.0, seed, TWO[:1]) for seed in (11, 12)]
    assert advisor("export", *logs, "-o", tmp_path / "out").returncode == 0
    return tmp_path / "out"


def test_two_logs_are_two_records_of_one_campaign(of_two_logs: Path) -> None:
    rows = (of_two_logs / "maneuvers.csv").read_text(encoding="utf-8").splitlines()[1:]
    assert [row.split(",")[:2] for row in rows] == [["1", "1"], ["2", "2"]]
    assert (of_two_logs / "record_2" / "grid.csv").exists()


def test_an_unknown_format_is_refused_with_those_that_are(advisor: Advisor, tmp_path: Path) -> None:
    run = advisor("export", "none.tlog", "-o", tmp_path, "--format", "csv,xlsx")
    assert run.returncode == 2
    assert run.stderr == (
        "--format: xlsx is no format; the formats are csv, parquet, mat, mcap, jsbsim, ardupilot, "
        "matlab, aircraft.\n"
    )


def test_a_model_for_another_program_lies_next_to_the_tables(advisor: Advisor, tmp_path: Path) -> None:
    log = recorded("linear", 1.0, maneuvers=TWO)
    run = advisor("export", log, "-o", tmp_path / "out", "--format", "csv,matlab")
    assert run.returncode == 0
    assert "A = [" in (tmp_path / "out" / "matlab.m").read_text(encoding="utf-8")
    assert (tmp_path / "out" / "maneuvers.csv").exists()


def test_what_a_model_lacks_is_named_before_the_log_is_read(advisor: Advisor, tmp_path: Path) -> None:
    run = advisor("export", "none.tlog", "-o", tmp_path, "--format", "ardupilot")
    assert run.returncode == 2
    assert "give them under reference: in the aircraft file" in run.stderr


@pytest.mark.parametrize(("name", "library"), [("parquet", "pyarrow"), ("mcap", "mcap")])
def test_a_missing_library_is_one_sentence_with_the_line_that_installs_it(
    name: str, library: str, advisor: Advisor, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setitem(sys.modules, library, None)
    run = advisor("export", "x.tlog", "-o", tmp_path, "--format", name)
    assert run.returncode == 2
    assert run.stderr == f"--format {name} needs {library}: pip install 'inflight-advisor[export]'.\n"


def test_a_log_that_cannot_be_used_is_told_with_exit_code_3_and_no_folder_is_made(advisor, tmp_path):
    (tmp_path / "flight.tlog").write_bytes(b"")
    run = advisor("export", tmp_path / "flight.tlog", "-o", tmp_path / "out")
    assert run.returncode == 3
    assert run.stderr.count("\n") == 1
    assert "empty" in run.stderr
    assert not (tmp_path / "out").exists()


def test_a_place_below_a_file_is_refused_in_one_sentence(exported, advisor, tmp_path):
    (tmp_path / "file").write_text("")
    run = advisor("export", exported.log, "-o", tmp_path / "file" / "out")
    assert run.returncode == 2
    assert f"lies below the file {tmp_path / 'file'}; name a folder elsewhere." in run.stderr
    assert "Traceback" not in run.stderr


def test_a_disk_that_is_full_in_the_middle_leaves_nothing_behind(exported, advisor, tmp_path):
    """The smaller tables fit, the grid does not."""
    with files_of_at_most(300_000):
        run = advisor("export", exported.log, "-o", tmp_path / "out")
    assert run.returncode == 2
    assert "File too large. Make room or name another place." in run.stderr
    assert "Traceback" not in run.stderr
    assert not (tmp_path / "out").exists()


def test_files_that_stood_there_stay_as_they_were_when_an_export_fails(tmp_path: Path) -> None:
    (tmp_path / "maneuvers.csv").write_text("old")

    def fail_in_the_middle() -> None:
        with staged(tmp_path) as stage:
            (stage / "maneuvers.csv").write_text("new")
            raise OSError(28, "No space left on device")

    with pytest.raises(ConfigurationError, match="No space left"):
        fail_in_the_middle()
    assert [path.name for path in tmp_path.iterdir()] == ["maneuvers.csv"]
    assert (tmp_path / "maneuvers.csv").read_text() == "old"
