"""Any pane can be copied, and saved beside the log."""

import csv
import re
from dataclasses import replace
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from textual.app import App

from advisor.session.conducting import Tempo, view_before_first
from advisor.tui.panes.courses import Courses
from advisor.tui.panes.fit import Fit
from advisor.tui.panes.pane import TableRows
from advisor.tui.settings import Settings
from advisor.tui.taking import drawn, log_of
from tests.campaign.states import changed
from tests.tui import flights
from tests.tui.stage import Stage, stage

ENGINEER = Settings(screen="engineer")


def table(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(StringIO(text)))


def notice(here: Stage) -> str:
    """What comes up above the last line, without its breaks."""
    return "".join(line.partition("▌")[2].strip(" ┃") for line in here.page().split("\n"))


def test_what_is_not_known_stands_as_nothing_in_a_row():
    assert (
        TableRows(("a", "b", "c"), ((1, np.nan, None), ("x, y", 0.5, 2.0))).csv()
        == 'a,b,c\n1,,\n"x, y",0.5,2\n'
    )


def test_files_are_named_after_the_log_of_the_manoeuvre_that_the_pane_shows():
    view = view_before_first(flights.AIRCRAFT, "udpin:127.0.0.1:0", None, (Path("a.tlog"), Path("b.tlog")))
    second = replace(flights.judged(1), maneuver=replace(flights.judged(1).maneuver, flight=1))
    view = replace(view, state=changed(view.state, maneuvers=(second,)))
    assert log_of(Fit(), view) == Path("b.tlog")
    assert log_of(Courses(), view) == Path("a.tlog")


def test_without_a_log_at_hand_files_are_named_after_the_replay_or_the_advisor():
    live = view_before_first(flights.AIRCRAFT, "udpin:127.0.0.1:0", None)
    page = view_before_first(flights.AIRCRAFT, "one.tlog, other.tlog", Tempo())
    assert log_of(Courses(), live) == Path("advisor")
    assert log_of(Courses(), page) == Path("one.tlog")


async def test_every_pane_can_be_copied():
    async with stage(flights.state(4), settings=ENGINEER, size=(80, 24)) as here:
        copied = {}
        for key in "1234567890hu":
            await here.press(key, "c")
            copied[key] = here.app.clipboard
        assert table(copied["1"])[1]["verdict"] == "✗ REJECTED"
        assert copied["2"].startswith("✓ ACCEPTED  manoeuvre 4")
        assert table(copied["3"])[5]["parameter"] == "M_α 1/s²"
        assert {row["channel"] for row in table(copied["4"])} == {"elevator", "alpha", "q", "a_z", "theta"}
        assert "No manoeuvre is being flown" in copied["5"]
        assert {row["series"] for row in table(copied["6"])} == {"continuous", "separate", "information"}
        assert "AOA_SSA.AOA" in copied["7"]
        assert "manoeuvre 4 judged" in copied["8"]
        assert {row["output"] for row in table(copied["9"])} == {"alpha", "q", "a_z", "theta"}
        assert {row["estimate"] for row in table(copied["0"])} == {"joint", "manoeuvre 4"}
        assert {row["manoeuvre"] for row in table(copied["h"])} == {"1", "2", "3", "4"}
        assert "lying qualities" in copied["u"]


async def test_a_pane_is_saved_beside_the_log_as_numbers_and_as_a_picture(tmp_path: Path):
    async with stage(
        flights.state(4), settings=ENGINEER, size=(100, 30), logs=[tmp_path / "flight.tlog"]
    ) as here:
        await here.press("4", "s")
        assert sorted(path.name for path in tmp_path.iterdir()) == ["flight.fit-4.csv", "flight.fit-4.svg"]
        svg = (tmp_path / "flight.fit-4.svg").read_text(encoding="utf-8")
        assert "<circle" in svg
        assert "elevator" in svg
        await here.press("8", "s")
        assert "manoeuvre 4 judged" in (tmp_path / "flight.log.txt").read_text(encoding="utf-8")
        await here.until(lambda: "flight.log.txt" in here.page())


async def test_a_place_that_cannot_be_written_is_one_sentence(tmp_path: Path):
    nowhere = tmp_path / "gone" / "flight.tlog"
    async with stage(flights.state(2), settings=ENGINEER, size=(200, 60), logs=[nowhere]) as here:
        await here.press("h", "s")
        said = "flight.history.csv and flight.history.svg cannot be written in"
        await here.until(lambda: said in " ".join(here.page().split()))
        assert "No such file or directory; key c copies instead" in " ".join(here.page().split())


async def test_a_long_path_is_told_in_full_on_a_narrow_terminal(tmp_path: Path):
    folder = tmp_path / f"[bold]{'a' * 70}"
    folder.mkdir()
    logs = [folder / "flight.tlog"]
    async with stage(flights.state(2), settings=ENGINEER, size=(80, 24), logs=logs) as here:
        await here.press("h", "s")
        await here.until(lambda: folder.name in notice(here))


async def test_a_browser_is_offered_the_files_and_the_server_keeps_none(tmp_path, monkeypatch):
    offered: dict[str, str] = {}
    monkeypatch.setattr(App, "is_web", True)
    monkeypatch.setattr(
        App, "deliver_text", lambda app, file, save_filename: offered.update({save_filename: file.read()})
    )
    async with stage(
        flights.state(2), settings=ENGINEER, size=(80, 24), logs=[tmp_path / "flight.tlog"]
    ) as here:
        await here.press("h", "s", "c")
        assert list(offered) == ["flight.history.csv", "flight.history.svg"]
        assert list(tmp_path.iterdir()) == []
        assert here.app.clipboard == ""


def run_of(text: str) -> str:
    place = f'x="12.2" y="18.5" textLength="{12.2 * len(text):.1f}"'
    return f'<text class="r1" {place} clip-path="url(#a)">{text}</text>'


def test_each_braille_dot_becomes_a_circle_in_its_place():
    circles = re.findall(r'<circle cx="([\d.]+)" cy="([\d.]+)"', drawn(run_of("⠁⢀")))
    assert [(float(x), float(y)) for x, y in circles] == [
        pytest.approx((12.2 * 1.25, 24.4 / 8.0), abs=0.06),
        pytest.approx((12.2 * 2.75, 24.4 * 7.0 / 8.0), abs=0.06),
    ]


def test_blocks_become_bars_without_gaps():
    bars = re.findall(r'<rect x="([\d.]+)" y="0.0" width="([\d.]+)"', drawn(run_of("██&#160;█")))
    assert bars == [("12.2", "24.4"), ("48.8", "12.2")]


def test_words_begin_where_they_stood():
    assert 'x="36.6"' in drawn(run_of("&#160;&#160;t&lt;s"))
    assert "t&lt;s" in drawn(run_of("&#160;&#160;t&lt;s"))


async def test_a_picture_of_the_application_fetches_nothing():
    async with stage(flights.state(3)) as here:
        svg = drawn(here.app.export_screenshot())
        assert "url(http" not in svg
        assert "<rect" in svg
        assert "█" not in svg
