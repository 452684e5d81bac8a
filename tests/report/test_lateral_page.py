"""Roll and yaw on the page of a flight and in the document."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.cli import page_content
from advisor.report.document import lateral_document
from advisor.report.gap_document import axis_document
from advisor.report.page.blocks import Gallery, Listing, Paragraph
from advisor.report.page.flying_qualities import lateral
from advisor.report.page.gap import gap
from advisor.report.page.render import headline
from advisor.report.qualities import side_quality_lines
from advisor.report.text import Table
from tests.campaign.side_builders import AIRCRAFT, estimate, judged, state
from tests.campaign.states import changed
from tests.gap.axis.test_diagnosis import FOUND
from tests.oem.axis.builders import JET
from tests.schemas import breaches
from tests.tui import flights as flights_of_pitch

UNTOLD = {"Y_p": "the record does not depend on it; fly a rudder doublet"}
FLOWN = state(
    judged(1, "aileron"), judged(2, "rudder"), judged(3, "rudder", accepted=False),
    model=estimate(untold=UNTOLD),
)  # fmt: skip
OFF = replace(AIRCRAFT, model=JET | {"L_delta_a": 1.5 * JET["L_delta_a"]})


def section(flown=FLOWN, aircraft=AIRCRAFT):
    content = SimpleNamespace(
        state=SimpleNamespace(lateral=flown), aircraft=aircraft, names=("flight.tlog",),
        analysis={"lateral": lateral_document(flown, aircraft)},
    )  # fmt: skip
    return lateral(content)


def table(name, **changed):
    found = [b for b in section(**changed).blocks if isinstance(b, Table) and b.name == name]
    return found[0].rows if found else None


def test_a_flight_without_aileron_and_rudder_has_no_such_section():
    assert section(flown=state()) is None


def test_the_verdict_leads_and_every_manoeuvre_has_its_row():
    first = section().blocks[0]
    assert isinstance(first, Paragraph)
    assert first.text.startswith("Roll and yaw: CONTINUE: ")
    assert [row[4].split("\N{NO-BREAK SPACE}")[1] for row in table("lateral-maneuvers")] == [
        "accepted", "accepted", "rejected",
    ]  # fmt: skip


def test_a_derivative_stands_with_its_interval_and_the_file_s_number_or_with_its_reason():
    rows = {row[0]: row for row in table("lateral-joint")}
    assert rows["L_p"][1:] == ("−2.100 ± 0.082", "0.082", "−2.100", "1/s")
    assert rows["Y_p"][1] == "–"
    listed = [item for block in section().blocks if isinstance(block, Listing) for item in block.items]
    assert listed == ["Not identifiable: Y_p; the record does not depend on it; fly a rudder doublet."]


def test_modes_and_levels_of_both_groups_of_classes_are_given():
    assert [row[0] for row in table("lateral-modes")] == [
        "Dutch roll ω", "Dutch roll ζ", "roll time constant", "spiral pole",
    ]  # fmt: skip
    assert [row[1] for row in table("lateral-levels")] == ["A", "B", "C", "A", "B", "C"]


def test_a_simulator_whose_aileron_is_half_too_strong_fails_the_roll_response_alone():
    assert [row[-1] for row in table("lateral-qualification", aircraft=OFF)] == ["✗", "✓", "✓"]
    assert [row[-1] for row in table("lateral-qualification")] == ["✓", "✓", "✓"]
    assert table("lateral-qualification", aircraft=Aircraft()) is None


def test_each_accepted_manoeuvre_has_a_picture_of_its_inputs_and_outputs():
    figures = [figure for b in section().blocks if isinstance(b, Gallery) for figure in b.figures]
    assert sorted(figure.caption.partition(", the ")[0] for figure in figures) == [
        "Manoeuvre 1, aileron doublet", "Manoeuvre 2, rudder doublet",
    ]  # fmt: skip
    drawn = figures[0].svg()
    for label in ("δa [deg]", "δr [deg]", "p [deg/s]", "φ [deg]", "a_y"):
        assert label in drawn


def test_the_document_keeps_to_its_schema():
    document = lateral_document(FLOWN, OFF)
    assert [b for b in breaches("analyze", {"lateral": document}) if b.startswith("$.lateral")] == []
    level = document["levels"]["by_class"]["I, II-C, IV"]["B"]
    assert level["level"] == max(one["level"] for one in level["by_mode"].values())
    assert [one["holds"] for one in document["qualification"]] == [False, True, True]


def test_the_lines_name_the_mode_the_level_and_the_test_that_fails():
    text = "\n".join(side_quality_lines(FLOWN, OFF))
    assert "Dutch roll ω" in text
    assert "Category B: Level" in text
    assert "✗ peak roll rate: flown" in text


@pytest.mark.parametrize("missing", ["L_p", "N_beta"])
def test_a_file_without_a_derivative_is_not_compared(missing):
    lacking = replace(AIRCRAFT, model={k: v for k, v in JET.items() if k != missing})
    assert lateral_document(FLOWN, lacking)["qualification"] == []


def test_the_first_page_of_a_lateral_flight_has_the_lateral_verdict_and_table_and_no_order_for_the_elevator():
    pitch = {
        "sentence": "No test input of the elevator has been flown.", "decision": "continue", "warnings": []
    }  # fmt: skip
    content = SimpleNamespace(
        state=changed(flights_of_pitch.state(0), lateral=FLOWN, flights=(), model=None),
        aircraft=AIRCRAFT, begun=(),
        names=("flight.tlog",), analysis={"flight_test": pitch, "maneuvers": []}, gap=None,
    )  # fmt: skip
    blocks = headline(content).blocks
    assert [b.name for b in blocks if isinstance(b, Table)] == ["flown", "lateral-glance"]
    said = [b.text for b in blocks if isinstance(b, Paragraph)]
    assert said[0].endswith(FLOWN.flight_test.sentence)
    assert said[-1] == "No test input of the elevator has been flown."
    assert not any("3-2-1-1" in one for one in said)


SIDE = axis_document(FOUND) | {
    "title": "LIKELY", "sentence": "The aileron is weak.", "how_sure": "Weak 90 %.",
    "parameters_changed": [{"text": "L_p: more"}],
}  # fmt: skip
GAP = {"usable": True, "title": None, "sentence": None, "limits": [], "lateral": SIDE}


def test_beside_refused_tests_of_the_elevator_the_first_page_has_roll_and_yaw_and_their_gap():
    pitch = {
        "sentence": "No input can be used.", "decision": "continue", "rule": "information", "warnings": [],
        "criterion_percent": None, "limit_percent": 100.0,
    }  # fmt: skip
    trimming = SimpleNamespace(span=SimpleNamespace(kind="other", is_marked=False))
    refused = SimpleNamespace(verdict=SimpleNamespace(accepted=False), maneuver=trimming)
    content = SimpleNamespace(
        state=changed(flights_of_pitch.state(1), maneuvers=(refused,), lateral=FLOWN, model=None),
        aircraft=AIRCRAFT, begun=(), names=("flight.tlog",), gap=GAP,
        analysis={"flight_test": pitch, "maneuvers": [{"number": 1, "verdict": "rejected"}]},
    )  # fmt: skip
    blocks = headline(content).blocks
    assert "lateral-glance" in [b.name for b in blocks if isinstance(b, Table)]
    said = [b.text for b in blocks if isinstance(b, Paragraph)]
    assert said[-2:] == ["Roll and yaw. LIKELY: The aileron is weak.", "Weak 90 %."]
    assert not any("None" in one for one in said)


def test_the_gap_of_roll_and_yaw_has_the_blocks_of_the_gap_of_pitch():
    blocks = gap(SimpleNamespace(gap=GAP)).blocks
    tables = {block.name: block for block in blocks if isinstance(block, Table)}
    assert [row[0] for row in tables["gap-channels"].rows] == ["p"]
    assert tables["causes"].rows[0][:3] == ("aileron actuator backlash", "70 %", "0.57 ± 0.11 deg")
    said = [block.text for block in blocks if isinstance(block, Paragraph)]
    assert any("gap 3 → 0.5 times the noise floor's power. 83.3 % less" in one for one in said)
    assert "Where: between the aileron's command and the aileron." in said


@pytest.mark.parametrize(
    ("pitch", "side", "axis"),
    [(False, True, "lateral"), (True, True, "pitch"), (False, False, "pitch")],
)
def test_the_gap_of_a_page_is_of_roll_and_yaw_where_they_alone_are_accepted(monkeypatch, pitch, side, axis):
    def one(accepted):
        return SimpleNamespace(verdict=SimpleNamespace(accepted=accepted))

    sides = replace(state(), maneuvers=(one(side),))
    flown = changed(flights_of_pitch.state(), maneuvers=(one(pitch),), lateral=sides)
    flights = SimpleNamespace(state=flown, logs=[], left_out={})
    asked = SimpleNamespace(aircraft_file=None, reading=[], target_system=None)
    monkeypatch.setattr(
        page_content, "compare_side_flown", lambda *_, **__: SimpleNamespace(diagnosis="lateral")
    )
    monkeypatch.setattr(page_content, "document_of", lambda _, made: {"lateral": {"of": made()}})
    monkeypatch.setattr(page_content, "diagnosed", lambda *_: {"lateral": {"of": "pitch"}})
    assert page_content._gap(flights, Aircraft(), asked, print)["lateral"]["of"] == axis
