"""``advisor analyze`` and ``advisor report`` on a flight without a test input."""

import json
from pathlib import Path

import pytest

from tests.conftest import Advisor
from tests.flights import recorded

pytestmark = pytest.mark.usefixtures("recorded_analyses")


@pytest.fixture(scope="module")
def untested() -> Path:
    """A log of ten seconds of level flight, in which no control moves."""
    return recorded("uav", 1.0, maneuvers=())


def test_the_answer_is_the_next_input_drawn_and_what_the_telemetry_tells(advisor: Advisor, untested) -> None:
    told = advisor("analyze", untested)
    assert told.returncode == 3
    assert "No test input of the elevator has been flown." in told.stdout
    assert "next        3-2-1-1" in told.stdout
    assert "pull     ┌" in told.stdout
    assert "next        aileron doublet" in told.stdout
    assert "m/s read in flight" in told.stdout
    assert "Even so, " in told.stdout
    assert "CONTINUE" not in told.stdout
    assert "No test manoeuvre was found" in told.stderr


def test_the_document_says_that_no_test_input_was_flown(advisor: Advisor, untested) -> None:
    document = json.loads(advisor("analyze", untested, "--json").stdout)
    assert document["flight_test"]["sentence"] == "No test input of the elevator has been flown."
    assert document["lateral"]["flight_test"]["sentence"].startswith("No test input of the aileron")


def test_the_report_is_a_page_without_tables_of_nothing(advisor: Advisor, untested, tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    assert advisor("report", untested, "-o", page).returncode == 3
    text = page.read_text(encoding="utf-8")
    assert [line for line in text.splitlines() if line.startswith("## ")] == [
        "## Verdict", "## Telemetry", "## What was assumed", "## Where this comes from",
    ]  # fmt: skip
    assert "No test input of the elevator has been flown." in text
