"""A sample flight comes with the program, in the repository and in a wheel."""

import shlex
from fnmatch import fnmatch
from pathlib import Path

from advisor.aircraft_file.read import load_aircraft
from advisor.process.installed import SAMPLE, SLOW_SAMPLE
from tests.conftest import Advisor

ROOT = Path(__file__).parents[2]


def test_the_sample_is_written_with_its_aircraft_file(advisor: Advisor, tmp_path: Path) -> None:
    assert advisor("sample", tmp_path / "trial").returncode == 0
    assert (tmp_path / "trial" / "arduplane-calm.tlog").stat().st_size > 1_000_000
    assert (tmp_path / "trial" / "arduplane-default-rates.tlog").stat().st_size > 100_000
    assert load_aircraft(tmp_path / "trial" / "arduplane-calm.yaml").elevator.output == 2


def test_the_commands_that_are_printed_name_the_files_that_were_written(advisor, tmp_path):
    folder = tmp_path / "a trial"
    told = advisor("sample", folder).stdout.splitlines()
    printed = [shlex.split(line) for line in told if line.startswith("  advisor ")]
    assert [words[1] for words in printed] == ["doctor", "replay", "gap"]
    for words in printed:
        assert words[2:] == [str(folder / f"{SAMPLE}.tlog"), "--aircraft", str(folder / f"{SAMPLE}.yaml")]


def test_a_file_of_that_name_is_kept(advisor: Advisor, tmp_path: Path) -> None:
    (tmp_path / "arduplane-calm.yaml").write_text("mine")
    assert advisor("sample", tmp_path).returncode == 2
    assert (tmp_path / "arduplane-calm.yaml").read_text() == "mine"


def test_the_version_is_that_of_the_installed_package(advisor: Advisor) -> None:
    assert advisor("--version").stdout.startswith("advisor, version ")


def test_the_source_archive_holds_every_file_of_the_sample() -> None:
    rules = (ROOT / "MANIFEST.in").read_text(encoding="utf-8").splitlines()
    excluded = [pattern for rule in rules if rule.startswith("exclude ") for pattern in rule.split()[1:]]
    assert any(fnmatch("logs/bundled-demo.tlog", pattern) for pattern in excluded)
    for name in (f"{SAMPLE}.tlog", f"{SAMPLE}.yaml", f"{SLOW_SAMPLE}.tlog"):
        assert not any(fnmatch(f"logs/{name}", pattern) for pattern in excluded), name
