"""``advisor study`` as a user calls it."""

import json
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from advisor.aircraft.aircraft import Aircraft
from advisor.bundled.study.figure import Curve, draw
from advisor.cli import demo
from advisor.cli.study import command
from advisor.process.tasks import processes
from advisor.process.tasks.processes import run_here
from advisor.words.problems import ConfigurationError
from tests.full_disk import files_of_at_most
from tests.schemas import breaches

# The study runs once for each figure.
pytestmark = pytest.mark.xdist_group("study")
Work = Callable[[object], object]
Results = Iterator[tuple[object, object]]
ALONE = ("--workers", "1")
"""In this process."""


@pytest.fixture(scope="module")
def pictured(tmp_path_factory: pytest.TempPathFactory) -> dict[Path, Result]:
    """What the same study printed beside each of two figures; the second's results come last first."""
    folder = tmp_path_factory.mktemp("figures")
    arguments = ["--campaigns", "10", "--seed", "4", "--json"]

    def last_first(work: Work, tasks: Sequence[object], workers: int) -> Results:
        return run_here(work, tasks[::-1])

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(processes, "run_in_processes", last_first)
        return {
            path: CliRunner().invoke(command, [*arguments, *workers, "--figure", str(path)])
            for path, workers in ((folder / "figure.svg", ALONE), (folder / "figure.png", ("--workers", "2")))
        }


def test_json_is_one_document_and_nothing_else(pictured: dict[Path, Result]) -> None:
    result = next(iter(pictured.values()))
    assert result.exit_code == 0
    document = json.loads(result.stdout)
    assert breaches("study", document) == []
    assert {(r["rule"], r["noise_percent"]) for r in document["rows"] if "paper" in r} == {
        (rule, noise) for rule in ("continuous", "separate") for noise in (1.0, 2.5, 5.0)
    }


def test_the_same_seed_gives_the_same_study_in_whatever_order_its_results_come(pictured):
    one, other = (result.stdout for result in pictured.values())
    assert one == other


def test_figure_five_is_written_as_a_picture(pictured: dict[Path, Result]) -> None:
    assert [path.read_bytes()[:5] for path in pictured] == [b"<?xml", b"\x89PNG\r"]


def test_a_disk_that_fills_up_leaves_the_old_figure_and_no_half_one(tmp_path: Path) -> None:
    figure = tmp_path / "figure.svg"
    figure.write_text("the figure of yesterday")
    with files_of_at_most(5_000), pytest.raises(OSError, match="File too large"):
        draw([Curve("continuous", 1.0, (None, (1.0, 2.0, 3.0)))], figure)
    assert [path.read_text() for path in tmp_path.iterdir()] == ["the figure of yesterday"]


@pytest.mark.usefixtures("pictured")  # which compiles what a study needs
def test_without_json_it_is_told_in_lines() -> None:
    result = CliRunner().invoke(command, ["--campaigns", "10", *ALONE])
    assert "continuous" in result.stdout
    assert "schema" not in result.stdout
    assert "30 of 30 campaigns, " in result.stderr
    assert max(map(len, result.stdout.split("\n"))) <= 80


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--figure", "missing/figure.png"], "there is no folder missing"),
        (["--figure", "."], "is a folder; name a file in it"),
        (["--figure", "figure.doc"], "no picture ends in .doc; name a .png or .svg file"),
    ],
)
def test_a_figure_that_cannot_be_drawn_is_refused_before_a_campaign_is_flown(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, arguments: list[str], sentence: str
) -> None:
    monkeypatch.chdir(tmp_path)
    # So many campaigns would take an hour.
    result = CliRunner().invoke(command, ["--campaigns", "20000", *arguments])
    assert isinstance(result.exception, ConfigurationError)
    assert sentence in str(result.exception)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("options", "rule", "said"),
    [
        ([], "continuous", "rule continuous decides: the paper's rule of continuous improvement"),
        (["--rule", "information"], "information", "rule information decides: the rule for real flights"),
    ],
)
def test_the_demonstration_decides_by_the_papers_rule_unless_told_otherwise_and_says_so(
    monkeypatch: pytest.MonkeyPatch, options: list[str], rule: str, said: str
) -> None:
    asked: list[Aircraft] = []
    monkeypatch.setattr(demo, "advise", lambda source, title, aircraft: asked.append(aircraft))
    said_so = CliRunner().invoke(demo.command, options)
    assert [aircraft.campaign.rule for aircraft in asked] == [rule]
    assert said_so.stdout.startswith(said)
