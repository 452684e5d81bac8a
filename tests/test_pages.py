"""Pages that the code makes hold what the code holds, and the README what the data hold."""

import json
import re
import shutil
from dataclasses import fields, replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from mkdocs.exceptions import PluginError

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft_file.read import load_aircraft
from advisor.cli.group import COMMANDS
from advisor.gap.effects import EFFECTS
from advisor.gap.result import Trace
from benchmarks.pages import (
    aircraft_file,
    commands,
    decision_records,
    decisions,
    documents,
    effects,
    fragments,
    hooks,
    readme,
    results,
    words,
)
from benchmarks.pages.__main__ import DATA, ROOT, main
from benchmarks.pages.example import EXAMPLES, FILES, Part, shown, transcripts
from benchmarks.pages.figure import errors, svg
from benchmarks.pages.generated import SAMPLES
from benchmarks.pages.hooks import on_page_content
from benchmarks.pages.signs import signs
from sim.effects.fitting import flight_of
from sim.scenario import read_scenario
from sim.sealed.judge import judge
from sim.sealed.score import in_time, score
from tests.gap.test_report_screen import diagnosis
from tests.schemas import SCHEMAS

DOCS = ROOT / "docs"
OUTSIDE = [*ROOT.glob("*.md"), ROOT / "logs" / "README.md", DOCS / "status.md"]
"""Pages that are not part of the site, whose strict build checks its own links."""


def test_the_blocks_of_the_readme_are_as_the_data_have_them():
    page = (ROOT / "README.md").read_text(encoding="utf-8")
    assert readme.filled(page) == page, "stale: run make pages"


@pytest.mark.parametrize("page", OUTSIDE, ids=lambda page: page.name)
def test_every_link_of_a_page_leads_to_a_file(page):
    targets = re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8"))
    local = [target for target in targets if "://" not in target]
    assert [target for target in local if not (page.parent / target).exists()] == []


def test_every_fragment_that_a_page_asks_for_is_there():
    pages = [page.read_text(encoding="utf-8") for page in words.pages(ROOT)]
    asked = {name for page in pages for name in re.findall(r"<!-- made: ([a-z-]+) -->", page)}
    assert asked == fragments.FRAGMENTS.keys()


def test_a_fragment_takes_the_place_of_the_line_that_asks_for_it():
    page = fragments.filled("before\n\n<!-- made: real -->\n\nafter")
    assert page.startswith("before\n\n| record | flown | asked | got | holds |")
    assert page.endswith("\n\nafter")


def test_the_page_of_commands_has_the_help_of_every_command_and_of_the_simulator():
    page = commands.page()
    assert [name for name in COMMANDS if f"### advisor {name}\n" not in page] == []
    assert "### python -m sim record\n" in page
    assert "--request-rates" in page


def test_the_page_of_the_aircraft_file_has_every_key_and_its_default():
    page = aircraft_file.page()
    assert [f.name for f in fields(Aircraft) if f"`{f.name}`" not in page] == []
    assert "| `tolerance_percent` | number, % | `5.0` |" in page
    assert "## `elevator.outputs[]`" in page


def test_every_key_of_the_aircraft_file_has_a_meaning():
    rows = [row.split(" | ") for row in aircraft_file.page().splitlines() if row.startswith("| `")]
    assert [row[0] for row in rows if len(row[-1].strip(" |")) == 0] == []


def test_the_page_of_documents_has_the_keys_of_lists_and_mappings():
    page = documents.page(SCHEMAS)
    assert "<code>maneuvers[].<wbr>estimates.<wbr>*.<wbr>std_cr</code>" in page
    assert "(schemas/gap.json)" in page


def test_the_list_of_decision_records_has_their_titles(tmp_path):
    (tmp_path / "0001-one.md").write_text("# 1. One path\n\ntext", encoding="utf-8")
    assert decision_records.page(tmp_path).endswith("\n- [1. One path](0001-one.md)\n")


def test_an_equation_becomes_mathml_with_its_number_at_the_right():
    page = (
        r'<p><div class="arithmatex">\[x &lt; 2 \tag{10}\]</div><span class="arithmatex">\(b_i\)</span></p>'
    )
    shown = on_page_content(page, None, None, None)
    assert shown.count("<math") == 2
    assert '<span class="number">(10)</span>' in shown
    assert "tag" not in shown


def test_words_of_made_blocks_and_marks_of_tables_are_no_words_written_by_hand():
    page = "one two\n<!-- a-b: begin -->\nmany words here\n<!-- a-b: end -->\n| three |\n|---|"
    assert words.words_in(page) == 3


def test_the_documentation_is_within_its_limits():
    assert words.main() == 0


def test_an_example_shows_the_parts_of_the_output_and_says_where_something_is_left_out():
    lines = ["VERDICT", "╭─ where ─╮", "x", "cause  prob.", "● lag", "● part of it"]
    told = shown("gap a.tlog", lines, [Part(until="╭─ where"), Part("cause", "● part")])
    assert told == "$ advisor gap a.tlog\nVERDICT\n[...]\ncause  prob.\n● lag\n[...]\n"


def test_a_part_that_the_output_does_not_have_is_refused():
    with pytest.raises(ValueError, match="no line begins with 'cause'"):
        shown("gap a.tlog", ["VERDICT"], [Part("cause")])


def test_every_example_is_a_file_and_every_file_an_example():
    names = {f"{name}.txt" for example in EXAMPLES for name in example.parts} | FILES.keys()
    assert {path.name for path in (DOCS / "data" / "examples").iterdir()} == names


@pytest.mark.study
def test_the_worked_examples_are_what_the_commands_say_today():
    kept = {path.name: path.read_text(encoding="utf-8") for path in (DOCS / "data" / "examples").iterdir()}
    assert dict(transcripts()) == kept, "stale: run make examples"


@pytest.fixture(scope="module")
def page_of_effects():
    return effects.page()


@pytest.mark.parametrize("effect", EFFECTS)
def test_the_page_of_effects_has_every_parameter_of_an_effect(page_of_effects, effect):
    section = page_of_effects.split(f"### `{effect}`\n")[1].split("\n### ")[0]
    assert re.findall(r"^  \| `(\w+)`", section, re.MULTILINE) == list(EFFECTS[effect].keys)


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
    assert "| `module.py` | `_LEAST` | `0.3` | **decides** | Share of the peak that counts. |" in page
    assert "Of 1 constants 1 decide" in page


def test_two_constants_of_one_assignment_have_a_value_each(room):
    page = decisions.page(room('_FEW, _MANY = 3, 5.0\n"""Of each."""\n'))
    assert "| `module.py` | `_FEW`<br>`_MANY` | `3`<br>`5.0` | **decides** | Of each. |" in page


def test_an_index_of_an_array_and_a_description_are_no_decision(room):
    page = decisions.page(room("SPEED, HEIGHT = range(2)\nSIZE = Size(3)\nFIRST = ALL[:3]\n"))
    assert "Of 0 constants 0 decide" in page


def test_the_page_of_decisions_has_every_number_of_the_diagnosis_with_its_value():
    page = decisions.page()
    for path in decisions.ROOM.rglob("*.py"):
        numbers = re.findall(r"^([A-Z_]+) = (-?[0-9.]+)$", path.read_text(encoding="utf-8"), re.MULTILINE)
        for name, value in numbers:
            assert f"`{name}`" in page, path
            assert f"`{value}`" in page, path


RUNS = results.read(fragments.GAP_RESULTS)


@pytest.mark.parametrize("run", RUNS, ids=lambda run: f"{run.set} {run.seed or ''}".strip())
def test_a_run_has_known_figures_and_no_more_hits_than_trials(run):
    assert run.figures.keys() <= results.FIGURES.keys()
    shares = [figure for figure in run.figures.values() if figure.hits is not None]
    assert all(0 <= share.hits <= share.trials for share in shares)


def run_of(name, own, seed, commit, two, digest="01234567"):
    return results.Run(
        name, "g", own, 10, seed, commit, "2026-01-01", digest, {"two": results.Figure(10, two)}
    )


def test_the_figures_are_those_of_the_newest_commit_whose_answers_are_kept():
    runs = [
        run_of("records", False, None, "d", 0, digest=""),
        run_of("B", False, 3, "c", 10),
        run_of("A", True, 1, "c", 4),
        run_of("A", True, 2, "c", 6),
        run_of("B", False, 4, "b", 0),
    ]
    assert {run.commit for run in results.newest(runs)} == {"c"}
    figures = results.figures_table(runs).splitlines()
    (row,) = (row for row in figures if row.startswith("| two effects: both named |"))
    assert "10/10, 100.0 %" in row
    assert "10/20, 50.0 %" in row
    assert figures[-1].startswith("Commit `c`, 2026-01-01: B (10 flights, answers `01234567`); A (10 flights")


def test_every_set_stands_in_the_table_and_the_outside_ones_first():
    runs = [run_of("A", True, 1, "c", 4), run_of("B", False, 3, "b", 10)]
    assert [row.split(" | ")[0] for row in results.sets_table(runs).splitlines()[-2:]] == ["| B", "| A"]


@pytest.fixture
def root(tmp_path):
    """A copy of what the command rewrites."""
    (tmp_path / DATA).mkdir(parents=True)
    shutil.copy(fragments.GAP_RESULTS, tmp_path / DATA)
    return tmp_path


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


def test_a_scored_run_is_added_and_stands_in_the_table(root):
    assert main(scored(root), root) == 0
    runs = results.read(root / DATA / "gap-results.json")
    assert "| of a test | 100 | abc, " in results.sets_table(runs)
    newest = runs[0]
    assert (newest.hash, newest.figures["cause_clean"]) == ("01234567", results.Figure(40, 39))


def test_a_run_that_stands_there_is_refused_in_a_sentence(root, capsys):
    assert main(scored(root), root) == 0
    assert main(scored(root), root) == 2
    assert (
        capsys.readouterr().err
        == "error: set of a test, seed 1, commit abc stands in the data file already\n"
    )


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [({"schema": "x"}, "no score"), ({"figures": []}, "no figure that the page knows")],
)
def test_what_is_no_score_is_refused_and_changes_nothing(root, capsys, changes, sentence):
    before = (root / DATA / "gap-results.json").read_bytes()
    assert main(scored(root, **changes), root) == 2
    assert sentence in capsys.readouterr().err
    assert (root / DATA / "gap-results.json").read_bytes() == before


def test_a_file_that_is_no_json_or_is_not_there_is_refused_in_a_sentence(root, capsys):
    arguments = scored(root)
    Path(arguments[1]).write_text("{", encoding="utf-8")
    assert main(arguments, root) == 2
    Path(arguments[1]).unlink()
    assert main(arguments, root) == 2
    first, second = capsys.readouterr().err.splitlines()
    assert first.endswith("no score; write it with `python -m sim reveal --json`")
    assert second.endswith("No such file or directory; give a file that is there")


def test_every_row_that_the_page_wants_is_a_row_of_the_score():
    cases = [
        {
            "kind": "one",
            "condition": name,
            "effects": {"icing": {}},
            "blocks": [],
            "gap": None,
            "background": [],
        }
        for name in ("clean", "hard", "filtered", "JSBSim")
    ]
    rates = [*score([judge(case, {}) for case in cases]), in_time([1.0])]
    wanted = {kind.row for kind in results.FIGURES.values() if kind.row}
    assert wanted - {rate.name.strip() for rate in rates} == set()


def test_the_figure_has_both_errors_of_every_channel():
    flown = diagnosis()
    number = max(flown.gap.by_maneuver, key=lambda row: row[1])[0]
    t = np.linspace(0.0, 5.0, 20)
    traces = tuple(Trace(number, channel, t, np.sin(t), 0.5 * t, 0.1 * t) for channel in ("alpha", "q"))
    drawn = svg(errors(replace(flown, traces=traces)))
    assert drawn.count("<polyline") == 4
    assert f"manoeuvre {number}" in drawn


def test_a_sample_page_that_is_not_written_is_named_with_the_command(monkeypatch, tmp_path):
    monkeypatch.setattr(hooks, "BUILT_SAMPLES", tmp_path)
    with pytest.raises(PluginError, match="run `make site`"):
        hooks.sample("report.html")


def test_the_makefile_writes_every_sample_page_that_the_site_shows():
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert [name for name in SAMPLES if f"build/samples/{name}" not in makefile] == []


def test_the_sample_gaps_aircraft_file_holds_the_simulators_derivatives():
    flown = flight_of(read_scenario(ROOT / "sim" / "scenarios" / "late-command.yaml"))
    stated = load_aircraft(ROOT / "docs" / "data" / "late-command.yaml").model
    assert stated == pytest.approx(flown.engine.truth.as_dict(), rel=0.003)


def test_the_picture_of_the_signs_has_each_angle_rate_and_surface():
    words = {text.text for text in ElementTree.fromstring(signs()).iter("text")}
    assert {"+α", "+q", "+δe", "+a_z", "+β", "+p", "+r", "+δa", "+δr"} <= words
