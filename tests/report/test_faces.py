"""One number for one thing: every face of a flight states the same value under the same name."""

import re
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import replace
from io import StringIO
from math import degrees

import pytest
from rich.console import Console
from textual.widgets import DataTable

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS
from advisor.gap.document import gap_document
from advisor.report.document import analysis_document
from advisor.report.gap_screen import GapScreen
from advisor.report.page.blocks import Paragraph
from advisor.report.page.gap import answer
from advisor.report.text import AnalysisText
from advisor.tui.panes.gap import answer_rows
from advisor.tui.settings import Settings
from advisor.words.digits import with_half
from advisor.words.quantities import PARAMETERS as QUANTITIES
from tests.campaign.side_builders import judged as side_judged
from tests.campaign.side_builders import state as side_state
from tests.gap.test_report_screen import EVIDENCE, diagnosis
from tests.report.conftest import Reported
from tests.schemas import breaches
from tests.tui import flights
from tests.tui.stage import stage

HALF = 1.959963984540054
"""Half of a 95 % interval, in standard deviations."""
pytestmark = pytest.mark.xdist_group("report")

Named = Iterator[tuple[str, str]]
"""Names of things, each with its value as a face writes it."""


def terminal(reported: Reported) -> str:
    """Return the text of ``advisor analyze``."""
    content = reported.content
    out = StringIO()
    console = Console(file=out, width=100, color_system=None, highlight=False)
    console.print(AnalysisText(content.state, content.names, content.aircraft), soft_wrap=True)
    return out.getvalue()


def of_the_document(reported: Reported) -> Named:
    for name in PARAMETERS:
        entry = reported.analysis["model"][name]
        factor = degrees(1.0) if name in ("Z_0", "M_0") else 1.0
        yield QUANTITIES[name].symbol, with_half(factor * entry["value"], factor * HALF * entry["std"])
    speed = reported.analysis["model"]["reference_airspeed_m_s"]
    yield "air speed of the derivatives", f"{speed:.1f}"
    yield "decision", reported.analysis["flight_test"]["sentence"]
    yield "advice", reported.analysis["flight_test"]["next"]["advice"].removeprefix("next: ")


def of_the_terminal(reported: Reported) -> Named:
    text = terminal(reported)
    for quantity in QUANTITIES.values():
        found = re.search(rf"^{quantity.symbol} +(\S+) +(\S+) ", text, re.MULTILINE)
        assert found is not None
        yield quantity.symbol, f"{found[1]} ± {found[2]}"
    for speed in re.findall(r"(?:Joint estimate.*|Flying qualities) at ([\d.]+) m/s", text):
        yield "air speed of the derivatives", speed
    decision, advice, *_ = text.splitlines()
    yield "decision", decision[2:]
    yield "advice", advice.strip().removeprefix("next: ").partition("; ")[0]


def of_the_page(reported: Reported) -> Named:
    for row in reported.page.tables["joint"][1:]:
        yield row[0], row[1]
    for speed in re.findall(r"Joint estimate from[^;]* at ([\d.]+) m/s", reported.page.text):
        yield "air speed of the derivatives", speed
    for mark in re.findall(r"[■▶] ([^\n<]+)", reported.page.text):
        yield "decision", mark


async def of_the_screen(reported: Reported) -> list[tuple[str, str]]:
    engineer = Settings(screen="engineer")
    found: list[tuple[str, str]] = []
    async with stage(reported.content.state, settings=engineer, size=(140, 45)) as here:
        await here.press("3")
        table = here.app.screen.query_one("ParametersPane DataTable", DataTable)
        await here.until(lambda: table.row_count == len(PARAMETERS))
        for n in range(table.row_count):
            name, estimate = (str(cell).strip() for cell in table.get_row_at(n)[:2])
            found.append((name.split()[0], estimate))
    return found


async def test_every_number_and_sentence_of_a_flight_has_one_value_on_every_face(reported: Reported) -> None:
    values: dict[str, dict[str, set[str]]] = defaultdict(lambda: defaultdict(set))
    faces: Mapping[str, list[tuple[str, str]]] = {
        "document": list(of_the_document(reported)),
        "terminal": list(of_the_terminal(reported)),
        "page": list(of_the_page(reported)),
        "screen": await of_the_screen(reported),
    }
    for face, named in faces.items():
        for name, value in named:
            values[name][" ".join(value.split())].add(face)
    assert {name: dict(said) for name, said in values.items() if len(said) > 1} == {}
    told = {name: set.union(*said.values()) for name, said in values.items()}
    assert all(told[QUANTITIES[name].symbol] == set(faces) for name in PARAMETERS)
    assert told["decision"] == told["air speed of the derivatives"] == {"document", "terminal", "page"}


def test_the_answer_of_a_gap_has_one_title_one_sentence_and_one_probability_on_every_face() -> None:
    found = diagnosis(evidence=EVIDENCE)
    document = gap_document(found)
    out = StringIO()
    Console(file=out, width=120, color_system=None, highlight=False).print(GapScreen(found))
    lines = [line.strip("│ ") for line in out.getvalue().splitlines()]
    page = [block.text for block in answer(document) if isinstance(block, Paragraph)]
    pane = [text for _, text in answer_rows(document | {"next": []})]
    assert document["title"] == "LIKELY CAUSE"
    assert lines[0].startswith(f"╭─ {document['title']} ")
    assert lines[1] == document["sentence"]
    assert page[0] == pane[0] == f"{document['title']}: {document['sentence']}"
    assert lines[2] == page[1] == pane[1]


def test_the_plan_of_both_axes_names_one_input_on_every_face() -> None:
    state = replace(flights.state(7), lateral=side_state(side_judged(1, "aileron")))
    plan = state.plan
    assert plan is not None
    assert state.flight_test.decision == "stop"
    out = StringIO()
    console = Console(file=out, width=200, color_system=None, highlight=False)
    console.print(AnalysisText(state, ["flight.tlog"], Aircraft()), soft_wrap=True)
    document = analysis_document(state, ["flight.tlog"], Aircraft())
    assert document["plan"]["next"] == plan.advice
    assert breaches("analyze", document) == []
    said = [line.strip() for line in out.getvalue().splitlines()]
    assert [line for line in said if line.startswith(("next:", "no further"))] == [plan.advice]
    assert f"Both axes: {document['plan']['sentence']}" in said
