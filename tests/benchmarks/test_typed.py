"""The commands of README, tutorial and how-to pages, which the program takes as they stand."""

from pathlib import Path

import pytest

from benchmarks.typed import PAGES, lines_of
from tests.printed import taken

COMMANDS = [(page.name, line) for page in PAGES for line in lines_of(page)]
NAMED = (
    "flight.tlog", "my-aircraft.yaml", "arduplane-calm.tlog", "arduplane-calm.yaml", "battery-1.tlog",
    "battery-2.bin", "fleet.yaml", "crew.txt", "logs/arduplane-calm.tlog", "logs/arduplane-calm.yaml",
    "flights/one.tlog",
)  # fmt: skip


def test_comments_and_prompts_are_no_part_of_a_command(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(
        "```sh\n$ advisor doctor a.tlog   # says whether\nadvisor gap \\\n  a.tlog\n```\nadvisor x\n"
    )
    assert list(lines_of(page)) == ["advisor doctor a.tlog", "advisor gap    a.tlog"]


@pytest.mark.parametrize(("page", "line"), COMMANDS)
def test_the_program_takes_the_command_of_a_page(page, line, tmp_path, monkeypatch):
    for name in NAMED:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    monkeypatch.chdir(tmp_path)
    assert taken(line.partition(" > ")[0].partition(" | ")[0].replace("~/", "")) is not None
