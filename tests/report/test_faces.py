"""One number for one thing: every face of a flight states the same value under the same name."""

import json
import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from io import StringIO
from math import degrees
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console
from textual.widgets import DataTable

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS
from advisor.assistant.server import written
from advisor.campaign.campaign import ManeuverJudged
from advisor.cli.live import _announce
from advisor.gap.alternative import Alternative, AlternativeEvidence
from advisor.mavlink.link.announce import Announcer
from advisor.report.document import analysis_document
from advisor.report.gap_document import gap_document
from advisor.report.gap_screen import GapScreen
from advisor.report.page.blocks import Paragraph
from advisor.report.page.gap import answer
from advisor.report.text import AnalysisText
from advisor.tui.advice import advise
from advisor.tui.panes.courses import _rows as criterion_rows
from advisor.tui.panes.gap import answer_rows
from advisor.tui.settings import Settings
from advisor.words.quantities import PARAMETERS as QUANTITIES
from advisor.words.quantities import with_half
from tests.campaign.side_builders import judged as side_judged
from tests.campaign.side_builders import state as side_state
from tests.campaign.states import changed
from tests.gap.test_report_screen import EVIDENCE, diagnosis
from tests.report.conftest import Reported, said_of
from tests.schemas import breaches
from tests.tui import flights
from tests.tui.stage import stage

HALF = 1.959963984540054
"""Half of a 95 % interval, in standard deviations."""
Document = dict[str, Any]
BUNDLED = (
    b"model: {Z_alpha: -0.483, Z_q: 0.104, Z_delta_e: 0.676, M_alpha: -6.0, M_q: -2.01, M_delta_e: -7.21}"
)
LOGS = Path(__file__).parents[2] / "logs"
FLIGHTS = LOGS.parents[1] / "shared" / "flights"
"""Records of aircraft and autopilots that nobody here made, where they are at hand."""
pytestmark = pytest.mark.xdist_group("report")

Named = Iterator[tuple[str, str]]
"""Names of things, each with its value as a face writes it."""


def of_the_documents(analysis: Document, gap: Document, doctor: Document) -> Named:
    for name in PARAMETERS:
        symbol, factor = QUANTITIES[name].symbol, degrees(1.0) if name in ("Z_0", "M_0") else 1.0
        yield f"expected error of {symbol}", f"{factor * HALF * doctor['expected_std'][name]:.2g}"
        if analysis["model"] is not None:
            entry = analysis["model"][name]
            yield symbol, with_half(factor * entry["value"], factor * HALF * entry["std"])
    for name, channel in analysis["log"]["channels"].items():
        yield f"rate of {name}", f"{channel['rate_hz']:.1f}"
    yield "decision", analysis["flight_test"]["sentence"]
    yield from of_advice((analysis["plan"] or {}).get("next") or analysis["flight_test"]["next"]["advice"])
    if analysis["flight_test"]["criterion_percent"] is not None:
        yield "criterion", f"{analysis['flight_test']['criterion_percent']:.1f}"
    yield "verdict", f"{gap['title']}: {gap['sentence']}"
    yield "gap before", digits(gap["gap"]["before"])
    yield "gap after", digits(gap["gap"]["after"])
    by_name: dict[str, float] = defaultdict(float)
    for one in gap["evidence"]:
        by_name[one["name"]] += one["probability"]
    if by_name:
        yield "probability", f"{min(100.0 * max(by_name.values()), 99.0):.0f}"  # never 100
    if gap["shrink"] is not None:
        yield "shrink", f"{gap['shrink']['percent']:.1f}"
    if analysis["model"] is not None:
        yield from of_the_joint_estimate(analysis["model"])


def of_the_joint_estimate(model: Document) -> Named:
    yield "air speed of the derivatives", f"{model['reference_airspeed_m_s']:.1f}"
    if (lag := model["instruments"].get("servo_lag_s")) is not None:
        yield "servo lag, ms", with_half(1e3 * lag["value"], 1e3 * HALF * lag["std"])
    if entered := re.search(LAG, " ".join(model["notes"])):
        yield "lag to enter, s", entered[1]


def digits(gap: float) -> str:
    return f"{gap:.3g}"


def of_an_assistant(reported: Reported) -> Named:
    """What a tool of the Model Context Protocol hands over, part by part where the whole is too long."""
    analysis, doctor = json.loads(written(reported.analysis)), json.loads(written(reported.doctor))
    gap = json.loads(written(reported.gap, without=("traces", "evidence", "decisions")))
    gap["evidence"] = json.loads(written(reported.gap, "evidence"))
    return of_the_documents(analysis, gap, doctor)


def of_the_terminal(reported: Reported) -> Named:
    text, gap, doctor = (reported.printed[name] for name in ("analyze", "gap", "doctor"))
    for quantity in QUANTITIES.values():
        if found := re.search(rf"^{quantity.symbol} +(\S+ ± \S+) ", text, re.MULTILINE):
            yield quantity.symbol, found[1]
        expected = re.search(rf"^  {quantity.symbol} +± (\S+)", doctor, re.MULTILINE)
        assert expected is not None
        yield f"expected error of {quantity.symbol}", expected[1]
    yield from (("air speed of the derivatives", one) for one in re.findall(SPEED, text))
    for name, rate in re.findall(r"^(\w+) +\S+ +\w+ +([\d.]+) +[\d.]+$", text, re.MULTILINE):
        yield f"rate of {name}", rate
    yield "decision", text.splitlines()[0][2:]
    yield from of_decisions(text.splitlines())
    rule = reported.analysis["flight_test"]["rule"]
    newest = r"(?:\n +by the newest estimates .*?([\d.]+) %: .*)?$"
    for heard, now in re.findall(rf"^rule {rule} .*criterion %: .*?([\d.]+){newest}", text, re.MULTILINE):
        yield "criterion", now or heard
    yield from (("lag to enter, s", one) for one in re.findall(LAG, text))
    yield from of_the_box(gap)


LAG = r"elevator: \{lag_s: ([\d.]+)\}"
SPEED = r"(?:Joint estimate.*|Flying qualities) at ([\d.]+) m/s"


def of_the_box(text: str) -> Named:
    lines = [line.strip("│ ") for line in text.splitlines()]
    title = lines[0].strip("╭╮─ ")
    ends = next(k for k, line in enumerate(lines) if re.match(r"Probability|peak error|!|╰", line))
    yield "verdict", f"{title}: {' '.join(lines[1:ends])}"
    yield from of_a_probability(lines)
    yield from of_a_size(text)
    yield from (("shrink", one) for one in re.findall(r"^([\d.−-]+) % less \(95", text, re.MULTILINE))


def of_a_probability(lines: Iterable[str]) -> Named:
    for line in lines:
        if said := re.match(r"Probability: \D+(\d+) %", line):
            yield "probability", said[1]


def of_decisions(lines: Sequence[str]) -> Named:
    """The advice after the plan of both axes, or else after stop or continue."""
    leads = [k for k, line in enumerate(lines) if line.startswith("Both axes: ")]
    leads += [k for k, line in enumerate(lines) if line[:1] in ("■", "▶")]
    yield from of_advice(lines[leads[0] + 1])


def of_advice(line: str) -> Named:
    yield "advice", line.strip().removeprefix("next: ").partition("; ")[0]


def of_a_size(text: str) -> Named:
    for before, after in re.findall(r"\bgap (\S+) → (\S+)(?: ▲)? times", text):
        yield "gap before", before.replace(",", "")
        yield "gap after", after


def of_the_page(reported: Reported) -> Named:
    page = reported.page
    for row in page.tables.get("joint", [])[1:]:
        yield row[0], row[1]
    yield from (("air speed of the derivatives", one) for one in re.findall(SPEED, page.text))
    yield from (("decision", said[2:]) for said in page.paragraphs if said[0] in "■▶")
    yield from of_decisions(page.paragraphs)
    for name, cell, *_ in page.tables.get("instruments", ()):
        if name.startswith("servo lag"):
            yield "servo lag, ms", cell
    for name, _, _, rate, _ in page.tables["channels-0"][1:]:
        yield f"rate of {name}", rate
    yield from (("criterion", one) for one in re.findall(r"its criterion is ([\d.]+) %", page.text))
    yield from (("verdict", one) for one in page.paragraphs if one.startswith(f"{reported.gap['title']}: "))
    yield from of_a_probability(page.paragraphs)
    yield from of_a_size(page.text)
    yield from (("shrink", one) for one in re.findall(r" ([\d.−-]+) % less \(95 %: ", page.text))


async def of_the_screen(reported: Reported) -> list[tuple[str, str]]:
    """Table of the parameters, channels, criterion, and answer of a gap; the pilot's word and voice."""
    found: list[tuple[str, str]] = []
    state = reported.content.state
    async with stage(state, settings=Settings(screen="engineer"), size=(140, 45)) as here:
        await here.press("3")
        table = here.app.screen.query_one("ParametersPane DataTable", DataTable)
        await here.until(lambda: table.row_count == len(PARAMETERS))
        for n in range(table.row_count):
            name, estimate = (str(cell).strip() for cell in table.get_row_at(n)[:2])
            if estimate != "–":
                found.append((name.split()[0], estimate))
        advised = advise(here.app.view)
        found.append(("decision", advised.sentence))
    for line in (" ".join(row) for row in criterion_rows(state.flight_test)):
        if now := re.search(r"► .* ([\d.]+) % of its limit", line):
            percent = float(now[1]) * state.flight_test.limit_percent / 100.0
            found.append(("criterion", f"{percent:.{len(now[1].partition('.')[2])}f}"))
    rows = [text for _, text in answer_rows(reported.gap)]
    found += [("verdict", rows[0]), *of_a_probability(rows)]
    found += [("shrink", one) for row in rows for one in re.findall(r"^([\d.−-]+) % less", row)]
    found += [one for row in rows for one in of_a_size(row)]
    return found


def of_the_link(reported: Reported) -> Named:
    """What a ground station hears after the last manoeuvre."""
    state, announcer = reported.content.state, Announcer()
    _announce(announcer, ManeuverJudged(state.maneuvers[-1], state.flight_test, state.plan))
    heard = []
    while messages := announcer.speak((1, 1), 0.0):
        heard.append("".join(message.text for message in messages))
    if state.flight_test.decision == "stop":
        yield "decision", heard[0].removeprefix("@").partition(" (")[0]


def told(faces: Mapping[str, Iterable[tuple[str, str]]]) -> dict[str, dict[str, set[str]]]:
    """Return each name with its values, and the faces that say each. A value of fewer digits is the same."""
    values: dict[str, dict[str, set[str]]] = defaultdict(lambda: defaultdict(set))
    for face, named in faces.items():
        for name, value in named:
            one = " ".join(value.split())
            same = next((known for known in values[name] if is_rounded(known, one)), one)
            values[name][same].add(face)
    return {name: dict(said) for name, said in values.items()}


def is_rounded(one: str, other: str) -> bool:
    """Return whether two texts are one number, of which one may have fewer decimals."""
    if one == other or not (is_number(one) and is_number(other)):
        return one == other
    decimals = min(len(text.partition(".")[2]) for text in (one, other))
    return abs(float(one) - float(other)) <= 0.5000001 * 10.0**-decimals


def is_number(text: str) -> bool:
    return re.fullmatch(r"\d+(\.\d+)?", text) is not None


async def of_all_faces(reported: Reported) -> dict[str, dict[str, set[str]]]:
    return told(
        {
            "document": of_the_documents(reported.analysis, reported.gap, reported.doctor),
            "assistant": of_an_assistant(reported),
            "terminal": of_the_terminal(reported),
            "page": of_the_page(reported),
            "screen": await of_the_screen(reported),
            "link": of_the_link(reported),
        }
    )


async def test_every_number_and_sentence_of_a_flight_has_one_value_on_every_face(reported: Reported) -> None:
    values = await of_all_faces(reported)
    assert {name: said for name, said in values.items() if len(said) > 1} == {}
    faces = {name: set.union(*said.values()) for name, said in values.items()}
    everywhere = {"document", "assistant", "terminal", "page", "screen"}
    assert all(faces[QUANTITIES[name].symbol] == everywhere for name in PARAMETERS)
    for name in ("decision", "criterion", "verdict", "probability"):
        assert faces[name] >= everywhere, name
    assert faces["gap before"] == faces["gap after"] == everywhere
    for name in ("air speed of the derivatives", "advice", "rate of q"):
        assert faces[name] == everywhere - {"screen"}, name
    assert faces["expected error of M_α"] == {"document", "assistant", "terminal"}


@pytest.mark.study
@pytest.mark.timeout(600)
@pytest.mark.parametrize("log", ["bundled-demo", "arduplane-calm", "arduplane-turbulent"])
async def test_a_sample_log_has_one_value_for_each_number_on_every_face(log: str, tmp_path: Path) -> None:
    content = (LOGS / "arduplane-calm.yaml").read_bytes() if "arduplane" in log else BUNDLED
    await assert_one_value(LOGS / f"{log}.tlog", content, tmp_path)


@pytest.mark.study
@pytest.mark.timeout(900)
@pytest.mark.parametrize("flight", ["jet-vane", "turboprop", "autopilot-16", "autopilot-42"])
async def test_a_flight_of_others_has_one_value_for_each_number_on_every_face(flight, tmp_path):
    log = FLIGHTS / f"{flight}.tlog"
    if not log.exists():
        pytest.skip("the records of others are not here")
    await assert_one_value(log, log.with_suffix(".yaml").read_bytes(), tmp_path)


async def assert_one_value(log: Path, aircraft: bytes, folder: Path) -> None:
    path = folder / "mine.yaml"
    path.write_bytes(aircraft)
    values = await of_all_faces(said_of(log, path))
    assert {name: said for name, said in values.items() if len(said) > 1} == {}
    assert len(values) > 30


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


def test_an_unknown_cause_in_two_blocks_has_one_probability_on_every_face() -> None:
    blocks = (("moment_equation", 0.5), ("force_equation", 0.42))
    unknown = tuple(AlternativeEvidence(Alternative("unknown", "unknown", b), (), p) for b, p in blocks)
    found = diagnosis(verdict="unknown", evidence=(*unknown, replace(EVIDENCE[1], probability=0.08)))
    document, out = gap_document(found), StringIO()
    Console(file=out, width=120, color_system=None, highlight=False).print(GapScreen(found))
    said = (
        "Probability: something without a name in the pitching moment 92 % (by this flight alone 92 %), "
        "actuator lag 8 %."
    )
    assert said in out.getvalue()
    assert said in [block.text for block in answer(document) if isinstance(block, Paragraph)]
    assert said in [text for _, text in answer_rows(document | {"next": []})]


def test_the_plan_of_both_axes_names_one_input_on_every_face() -> None:
    state = changed(flights.state(7), lateral=side_state(side_judged(1, "aileron")))
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
