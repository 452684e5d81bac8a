"""The stop rules in the text of an analysis: the deciding one whole, the paper's two in one line."""

from dataclasses import replace

import pytest

from advisor.report.text import AnalysisText
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
