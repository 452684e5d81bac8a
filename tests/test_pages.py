"""Made pages are what the code and the scored runs make of them, and links lead somewhere."""

import json
import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft_effects import LEAST
from advisor.gap.candidates.traits import TRAITS
from advisor.gap.result import Trace
from benchmarks.pages import decisions, effects, results
from benchmarks.pages.__main__ import DATA, DOCS, made, main
from benchmarks.pages.example import excerpt, foresight, transcript
from benchmarks.pages.figure import figure
from tests.gap.test_report_screen import diagnosis

PAGES = sorted([DOCS.parent / "README.md", *DOCS.rglob("*.md")])


@pytest.mark.parametrize("page", ["effects.md", "decisions-of-the-gap.md", "gap-results.md"])
def test_a_made_page_is_as_the_code_makes_it(page):
    path = DOCS / page
    assert path.read_text(encoding="utf-8") == made()[path], "stale: run make pages"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_link_of_a_page_leads_to_a_file(page):
    targets = re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8"))
    local = [target for target in targets if "://" not in target]
    assert [target for target in local if not (page.parent / target).exists()] == []


@pytest.fixture(scope="module")
def page_of_effects():
    return effects.page()


@pytest.mark.parametrize("effect", TRAITS)
def test_the_page_of_effects_has_every_parameter_of_an_effect(page_of_effects, effect):
    section = page_of_effects.split(f"### `{effect}`\n")[1].split("\n### ")[0]
    assert re.findall(r"^  \| `(\w+)`", section, re.MULTILINE) == list(LEAST[effect])


def test_a_bound_that_no_flight_changes_is_a_number_and_one_that_does_is_the_flights(page_of_effects):
    section = page_of_effects.split("### `cg_shift`\n")[1].split("\n### ")[0]
    assert "| `step` | share | −0.9 | 3 |" in section
    assert "| `rate_per_s` | 1/s | by the flight | by the flight |" in section


@pytest.fixture
def room(tmp_path):
    """A folder of one module, whose source is given."""

    def with_module(source):
        (tmp_path / "module.py").write_text(source, encoding="utf-8")
        return tmp_path

    return with_module


def test_a_constant_stands_on_the_page_with_the_docstring_below_it(room):
    page = decisions.page(room('_LEAST = 0.3\n"""Share of the peak\nthat counts."""\n'))
    assert "| `module.py` | `_LEAST` | `0.3` | Share of the peak that counts. |" in page
    assert "1 constants" in page


def test_two_constants_of_one_assignment_have_a_value_each(room):
    (row,) = decisions.rows_of(room('_FEW, _MANY = 3, 5.0\n"""Of each."""\n') / "module.py")
    assert row.values == (("_FEW", "3"), ("_MANY", "5.0"))


def test_an_index_of_an_array_and_a_description_are_no_decision(room):
    assert (
        list(
            decisions.rows_of(
                room("SPEED, HEIGHT = range(2)\nSIZE = Size(3)\nFIRST = ALL[:3]\n") / "module.py"
            )
        )
        == []
    )


def test_the_page_of_decisions_has_every_number_of_the_diagnosis_with_its_value():
    page = decisions.page()
    for path in decisions.ROOM.rglob("*.py"):
        numbers = re.findall(r"^([A-Z_]+) = (-?[0-9.]+)$", path.read_text(encoding="utf-8"), re.MULTILINE)
        for name, value in numbers:
            assert f"`{name}`" in page, path
            assert f"`{value}`" in page, path


RUNS = results.read(DOCS / DATA)


@pytest.mark.parametrize("run", RUNS, ids=lambda run: f"{run.set} {run.seed or ''}".strip())
def test_a_run_has_known_figures_and_no_more_hits_than_trials(run):
    assert run.figures.keys() <= results.FIGURES.keys()
    shares = [figure for figure in run.figures.values() if figure.hits is not None]
    assert all(0 <= share.hits <= share.trials for share in shares)


def test_runs_of_one_set_are_added_up_and_outside_ones_come_first():
    share = results.Figure
    own = [
        results.Run("A", "g", True, 10, seed, "c", "2026-01-01", "", {"two": share(10, hits)})
        for seed, hits in ((1, 4), (2, 6))
    ]
    outside = results.Run("B", "h", False, 5, 3, "d", "2026-01-02", "", {"two": share(5, 5)})
    rows = results.table([*own, outside]).splitlines()
    assert any(
        row.startswith("| two effects: both named | 5/5, 100.0 %") and "10/20, 50.0 %" in row for row in rows
    )
    assert [row.split(" | ")[0] for row in rows[-2:]] == ["| B", "| A"]


@pytest.fixture
def docs(tmp_path):
    """A copy of what the command rewrites."""
    place = tmp_path / "docs"
    (place / DATA.parent).mkdir(parents=True)
    shutil.copy(DOCS / DATA, place / DATA)
    shutil.copy(DOCS / "gap-results.md", place / "gap-results.md")
    return place


def scored(place: Path, **changes):
    """The arguments that add a score, which is written beside the pages."""
    figures = [{"name": "right cause first, clean", "trials": 40, "hits": 39}]
    score = {
        "schema": "score/1",
        "cases": 100,
        "answers_sha256": "0123456789ab",
        "figures": figures,
    } | changes
    path = place / "score.json"
    path.write_text(json.dumps(score), encoding="utf-8")
    return [
        "add",
        str(path),
        "--set",
        "of a test",
        "--generator",
        "g",
        "--own",
        "--seed",
        "1",
        "--commit",
        "abc",
    ]


def test_a_scored_run_is_added_and_stands_in_the_table(docs):
    assert main(scored(docs), docs) == 0
    assert "| of a test | 100 | abc, " in (docs / "gap-results.md").read_text(encoding="utf-8")
    newest = results.read(docs / DATA)[0]
    assert (newest.hash, newest.figures["cause_clean"]) == ("01234567", results.Figure(40, 39))


def test_a_run_that_stands_there_is_refused_in_a_sentence(docs, capsys):
    assert main(scored(docs), docs) == 0
    assert main(scored(docs), docs) == 2
    assert (
        capsys.readouterr().err
        == "error: set of a test, seed 1, commit abc stands in the data file already\n"
    )


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [({"schema": "x"}, "no score"), ({"figures": []}, "no figure that the page knows")],
)
def test_what_is_no_score_is_refused_and_changes_nothing(docs, capsys, changes, sentence):
    before = (docs / DATA).read_bytes()
    assert main(scored(docs, **changes), docs) == 2
    assert sentence in capsys.readouterr().err
    assert (docs / DATA).read_bytes() == before


def test_a_file_that_is_no_json_or_is_not_there_is_refused_in_a_sentence(docs, capsys):
    arguments = scored(docs)
    Path(arguments[1]).write_text("{", encoding="utf-8")
    assert main(arguments, docs) == 2
    Path(arguments[1]).unlink()
    assert main(arguments, docs) == 2
    first, second = capsys.readouterr().err.splitlines()
    assert first.endswith("no score; write it with `score --json` or `reveal --json`")
    assert second.endswith("No such file or directory; give a file that is there")


def test_every_row_of_the_two_scores_that_the_page_wants_exists_there():
    root = DOCS.parent
    sources = [root / "sim" / "blind" / "score.py", root / "benchmarks" / "second_generator" / "score.py"]
    text = "\n".join(path.read_text(encoding="utf-8") for path in sources)
    rows = [row for kind in results.FIGURES.values() for row in kind.rows]
    made_of_two = {"CPU seconds at most 5", *(r for r in rows if r.startswith("one named effect, "))}
    assert [row for row in rows if row not in text and row not in made_of_two] == []


def test_the_example_shows_the_verdict_the_place_and_the_causes():
    head, causes = "CAUSE FOUND\n╭─ where: here ─╮\n", "cause  prob.\n● lag  100 %\n"
    output = f"{head}╭─ where in the flight ─╮\nx\n{causes}● part of it\n"
    assert excerpt(output) == "CAUSE FOUND\n╭─ where: here ─╮\n[...]\ncause  prob.\n● lag  100 %"


@pytest.mark.study
@pytest.mark.parametrize(("page", "told"), [("gap.md", transcript), ("foresee.md", foresight)])
def test_a_worked_example_is_what_the_command_says_today(page, told):
    assert told() in (DOCS / page).read_text(encoding="utf-8"), "stale: run make examples"


def test_the_figure_has_both_errors_of_every_channel():
    flown = diagnosis()
    number = max(flown.gap.by_maneuver, key=lambda row: row[1])[0]
    t = np.linspace(0.0, 5.0, 20)
    traces = tuple(Trace(number, channel, t, np.sin(t), 0.5 * t, 0.1 * t) for channel in ("alpha", "q"))
    drawn = figure(replace(flown, traces=traces))
    assert drawn.count("<polyline") == 4
    assert f"manoeuvre {number}" in drawn
