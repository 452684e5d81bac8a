"""The text of an analysis: the deciding rule whole, the paper's two in one line, and each note once."""

from dataclasses import replace

import pytest

from advisor.report.text import AnalysisText
from tests.campaign.side_builders import judged
from tests.campaign.side_builders import state as side_state
from tests.campaign.states import changed
from tests.printed import printed_lines
from tests.tui import flights


def rules(rule: str, everything: bool = False) -> list[str]:
    state = flights.state(4)
    state = changed(state, flight_test=replace(state.flight_test, rule=rule))
    lines = printed_lines(AnalysisText(state, ["a.tlog"], flights.AIRCRAFT, everything))
    return [line for line in lines if line.startswith(("rule ", "the paper's rules"))]


def test_where_information_decides_the_papers_rules_are_one_line():
    whole, line = rules("information")
    assert whole.startswith("rule information")
    assert line.startswith("the paper's rules: continuous ")
    assert "; separate " in line


@pytest.mark.parametrize(("rule", "everything"), [("continuous", False), ("information", True)])
def test_a_chosen_rule_of_the_paper_or_all_shows_every_rule_whole(rule, everything):
    assert [line.split()[1] for line in rules(rule, everything)] == ["continuous", "separate", "information"]


@pytest.mark.parametrize("kind", ["other", "pulse"])
@pytest.mark.parametrize("everything", [False, True])
def test_movements_of_the_elevator_beside_a_test_of_roll_and_yaw_are_shown_on_request(everything, kind):
    whole = flights.state(2)
    moved = [
        replace(one, maneuver=replace(one.maneuver, span=replace(one.maneuver.span, kind=kind)))
        for one in whole.maneuvers
    ]
    refused = [replace(one, verdict=replace(one.verdict, accepted=False)) for one in moved]
    side = side_state(judged(1, "aileron"))
    beside = changed(whole, lateral=side, maneuvers=tuple(refused))
    assert beside.tested_sideways is not None
    lines = printed_lines(AnalysisText(beside, ["a.tlog"], flights.AIRCRAFT, everything))
    assert sum(line.startswith("rule information") for line in lines) == 1 + everything
    assert sum(line.startswith("no.  start") for line in lines) == 1 + everything
    assert ("--all lists 2 refused movements of the elevator" in lines) is not everything


def test_a_note_of_a_manoeuvre_is_said_once_and_a_note_of_the_joint_estimate_alone_too():
    state = flights.state(4)
    caution = state.maneuvers[0].verdict.cautions[1]
    noted = changed(state, model=replace(state.model, notes=(caution, "The joint estimate is rough.")))
    lines = printed_lines(AnalysisText(noted, ["a.tlog"], flights.AIRCRAFT))
    assert [line for line in lines if caution in line] == [f"[1 to 4] {caution}"]
    assert "note: The joint estimate is rough." in lines
