"""The page stands alone, repeats to the byte, and is whole or not there."""

import re
import sys
from pathlib import Path

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.cli.options import LogsAsked
from advisor.cli.page_content import gather
from advisor.report.page import drawing
from advisor.report.page.render import page
from tests.conftest import Advisor
from tests.flights import SHIPPED
from tests.full_disk import files_of_at_most
from tests.report.conftest import Reported

USELESS = SHIPPED / "arduplane-default-rates.tlog"
pytestmark = pytest.mark.xdist_group("report")


def test_the_page_loads_nothing_and_runs_nothing(reported: Reported) -> None:
    assert "script" not in reported.page.tags
    loading = {"src", "href", "xlink:href", "data", "action", "poster"}
    loaded = [value for _, name, value in reported.page.attributes if name in loading]
    assert loaded
    assert all(value.startswith("#") for value in loaded)
    assert not [name for _, name, _ in reported.page.attributes if name.startswith("on")]
    assert not re.search(r"url\((?!#)|@import|@font-face", reported.written)


def test_names_from_outside_are_text_and_no_markup(reported: Reported) -> None:
    assert 'paper> & "twin"' in reported.page.text
    assert "paper" not in reported.page.tags


def test_every_reference_within_the_page_has_its_one_target(reported: Reported) -> None:
    ids = [value for _, name, value in reported.page.attributes if name == "id"]
    wanted = {v[1:] for _, n, v in reported.page.attributes if n in ("href", "xlink:href")}
    wanted |= set(re.findall(r"url\(#([^)]+)\)", reported.written))
    assert len(ids) == len(set(ids))
    assert wanted <= set(ids)


def test_the_same_flight_gives_the_same_page_to_the_byte_with_the_gap_that_gap_says(reported, monkeypatch):
    """The pictures are those of the page: that one is drawn alike is the fact of another test."""
    pictures = iter(re.findall(r"<svg.*?</svg>", reported.written, re.DOTALL))
    monkeypatch.setattr(drawing, "draw", lambda *_: next(pictures))
    assert page(reported.content, "html") == reported.written


def test_the_page_names_the_command_that_made_it(reported: Reported) -> None:
    *_, command = re.findall(r"<pre>([^<]+)</pre>", reported.written)
    assert command.startswith(f"advisor report {reported.log} --aircraft {reported.aircraft} --gap -o ")


def test_a_figure_is_drawn_alike_each_time_and_names_no_date_and_no_program() -> None:
    def paint(figure: drawing.Drawing) -> None:
        figure.suptitle("one").set_color("black")
        figure.add_subplot().plot([0.0, 1.0], [0.0, 1.0], clip_on=True)

    svg, again = (drawing.draw("one", 2.0, 1.0, paint) for _ in range(2))
    assert svg == again
    assert svg.startswith("<svg ")
    assert "metadata" not in svg
    assert "Matplotlib" not in svg


def test_a_log_that_cannot_be_used_leaves_no_page(advisor: Advisor, tmp_path: Path) -> None:
    answer = advisor("report", USELESS, "-o", tmp_path / "page.html")
    assert answer.returncode == 3
    assert "too slow to identify a short period" in answer.stderr
    assert not list(tmp_path.iterdir())


def test_a_log_next_to_a_good_one_is_left_out_and_said(reported: Reported) -> None:
    content, said = gather(LogsAsked((reported.short_log, USELESS)), Aircraft(), False)
    assert any("arduplane-default-rates.tlog" in one and "too slow to identify" in one for one in said)
    assert said[-1] in page(content, "md")


def test_the_page_does_not_replace_an_input(advisor: Advisor, reported: Reported) -> None:
    for given in (reported.log, reported.aircraft):
        answer = advisor("report", reported.log, "--aircraft", reported.aircraft, "-o", given)
        assert answer.returncode == 2
        assert "is an input of the report" in answer.stderr


def test_a_place_that_does_not_exist_is_refused_before_the_work(advisor, reported, tmp_path):
    answer = advisor("report", reported.log, "-o", tmp_path / "nowhere" / "page.html")
    assert answer.returncode == 2
    assert "there is no folder" in answer.stderr


def test_a_missing_library_is_named_with_the_line_that_installs_it(advisor, reported, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "jinja2", None)
    answer = advisor("report", reported.log, "-o", tmp_path / "page.html")
    assert answer.returncode == 2
    assert answer.stderr.strip() == "advisor report needs jinja2: pip install 'inflight-advisor[report]'."


def test_a_full_disk_leaves_the_old_page_and_no_half_one(advisor, reported, tmp_path):
    out = tmp_path / "page.md"
    out.write_text("the page of yesterday", encoding="utf-8")
    with files_of_at_most(5_000):
        answer = advisor("report", reported.short_log, "-o", out)
    assert (answer.returncode, answer.stderr.count("\n")) == (2, 1)
    assert answer.stderr.startswith(f"-o: {out} cannot be written to: File too large.")
    assert [path.name for path in tmp_path.iterdir()] == ["page.md"]
    assert out.read_text(encoding="utf-8") == "the page of yesterday"
