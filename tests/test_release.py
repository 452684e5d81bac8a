"""`make release`: the heading in CHANGELOG.md, one commit and its tag, or a sentence and nothing else.

Every change and every night have their trials. What is handed on carries its licence."""

import re
import shutil
import subprocess
import tomllib
from pathlib import Path
from typing import Any, cast

import pymavlink
import pytest
import yaml

ROOT = Path(__file__).parents[1]
SCRIPT = ROOT / ".ci" / "release"
CHANGELOG = "# Changelog\n\n## Unreleased\n\n- A command is new.\n\n## 0.1.0 (2026-01-01)\n\n- All is new.\n"


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A repository with the script, a changelog and the tag of an older release."""
    (tmp_path / ".ci").mkdir()
    shutil.copy(SCRIPT, tmp_path / ".ci" / "release")
    (tmp_path / "CHANGELOG.md").write_text(CHANGELOG, encoding="utf-8")
    git(tmp_path, "init", "--quiet")
    for key, value in {"user.name": "A Developer", "user.email": "dev@example.org"}.items():
        git(tmp_path, "config", key, value)
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "--quiet", "--message", "Begin")
    git(tmp_path, "tag", "v0.1.0")
    return tmp_path


def test_release_moves_the_entries_under_a_heading_that_the_tag_holds(checkout: Path) -> None:
    assert release(checkout, "0.2.0").returncode == 0
    tagged = git(checkout, "show", "v0.2.0:CHANGELOG.md")
    unreleased, released = tagged.split("\n## 0.2.0 (")
    assert unreleased.endswith("## Unreleased\n")
    assert released.split("\n")[2] == "- A command is new."
    assert git(checkout, "cat-file", "-t", "v0.2.0") == "tag\n"
    assert git(checkout, "status", "--porcelain") == ""


@pytest.mark.parametrize(
    ("version", "reason"),
    [("", "three numbers"), ("0.2", "three numbers"), ("0.1.0", "exists"), ("0.0.9", "lower than 0.1.0")],
)
def test_release_refuses_a_version_that_cannot_follow(checkout: Path, version: str, reason: str) -> None:
    assert_refused(checkout, version, reason)


def test_release_refuses_files_that_no_commit_holds(checkout: Path) -> None:
    (checkout / "new.txt").write_text("x", encoding="utf-8")
    assert_refused(checkout, "0.2.0", "files differ")


def test_release_refuses_a_changelog_without_entries(checkout: Path) -> None:
    assert release(checkout, "0.2.0").returncode == 0
    assert_refused(checkout, "0.3.0", "no entry")


def test_every_action_of_a_workflow_is_pinned_by_a_commit() -> None:
    workflows = [path.read_text(encoding="utf-8") for path in (ROOT / ".github" / "workflows").iterdir()]
    actions = [action for text in workflows for action in re.findall(r"uses: (.*)", text)]
    loose = [action for action in actions if not re.fullmatch(r"\S+@[0-9a-f]{40} # v\d+\.\d+\.\d+", action)]
    assert (len(actions) >= 5, loose) == (True, [])


def test_every_python_that_is_promised_has_its_run_of_the_suite_and_of_the_wheel() -> None:
    known = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["classifiers"]
    promised = [name for one in known if re.fullmatch(r"3\.\d+", name := one.rpartition(" ")[2])]
    jobs = workflow("check.yml")["jobs"]
    for job in ("check", "install"):
        assert jobs[job]["strategy"]["matrix"]["python"] == promised, job


def test_every_night_tries_the_lowest_versions_known_weaknesses_and_damaged_logs() -> None:
    job = workflow("nightly.yml")["jobs"]["nightly"]
    assert {"lowest", "audit", "damage", "nightly"} <= set(job["strategy"]["matrix"]["target"])
    assert job["steps"][-1]["run"] == "make ${{ matrix.target }}"


def test_each_package_that_is_installed_stands_on_the_page_of_the_installation() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    names = {re.split(r"[<>=]", one)[0] for one in project["dependencies"]}
    page = (ROOT / "docs" / "how-to" / "install.md").read_text(encoding="utf-8")
    assert {name for name in names if name.lower() not in page.lower()} == set()


def test_the_container_hands_on_the_licence_of_each_package_that_asks_for_it() -> None:
    text = (ROOT / "Containerfile").read_text(encoding="utf-8")
    (search,) = re.findall(r"\$\((find .*?-type f)\)", text)
    packages = Path(pymavlink.__file__).parents[1]
    found = subprocess.run(["sh", "-c", search], cwd=packages, capture_output=True, text=True, check=True)
    assert any(re.search(r"/pymavlink-[^/]*/(licenses/)?COPYING", line) for line in found.stdout.split())
    assert "common-licenses/*GPL-3 " in text


def workflow(name: str) -> dict[str, Any]:
    """The jobs of a workflow."""
    text = (ROOT / ".github" / "workflows" / name).read_text(encoding="utf-8")
    return cast("dict[str, Any]", yaml.safe_load(text))


def assert_refused(checkout: Path, version: str, reason: str) -> None:
    before = git(checkout, "log", "--decorate", "--oneline")
    done = release(checkout, version)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert reason in done.stderr
    assert git(checkout, "log", "--decorate", "--oneline") == before


def release(checkout: Path, version: str) -> subprocess.CompletedProcess[str]:
    command = [checkout / ".ci" / "release", version]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def git(folder: Path, *arguments: str) -> str:
    done = subprocess.run(["git", *arguments], cwd=folder, capture_output=True, text=True, check=True)
    return done.stdout
