"""A sample flight comes with the program, in the repository and in a wheel."""

from pathlib import Path

from advisor.aircraft_file.read import load_aircraft
from tests.conftest import Advisor


def test_the_sample_is_written_with_its_aircraft_file(advisor: Advisor, tmp_path: Path) -> None:
    assert advisor("sample", tmp_path / "trial").returncode == 0
    assert (tmp_path / "trial" / "arduplane-calm.tlog").stat().st_size > 1_000_000
    assert (tmp_path / "trial" / "arduplane-default-rates.tlog").stat().st_size > 100_000
    assert load_aircraft(tmp_path / "trial" / "arduplane-calm.yaml").elevator.output == 2


def test_a_file_of_that_name_is_kept(advisor: Advisor, tmp_path: Path) -> None:
    (tmp_path / "arduplane-calm.yaml").write_text("mine")
    assert advisor("sample", tmp_path).returncode == 2
    assert (tmp_path / "arduplane-calm.yaml").read_text() == "mine"


def test_the_version_is_that_of_the_installed_package(advisor: Advisor) -> None:
    assert advisor("--version").stdout.startswith("advisor, version ")
