"""Inputs that ``advisor live --uplink`` sends to the autopilot's script."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from advisor.campaign.campaign import ManeuverJudged
from advisor.cli.live import _tell
from advisor.decision.inputs import StepInput
from advisor.decision.verdict import NextInput
from tests.tui import flights


@pytest.mark.parametrize(("decision", "sent"), [("continue", 1), ("stop", 0)])
def test_an_input_is_sent_only_while_the_test_is_open(decision, sent):
    state = flights.state(3)
    advised = NextInput("next: 3-2-1-1", None, "M_q", StepInput("3211", 0.3, 0.05, True))
    test = replace(state.flight_test, decision=decision, next=advised)
    orders = []
    link = SimpleNamespace(advise=lambda *order: orders.append(order))
    _tell(link, False, True, ManeuverJudged(state.maneuvers[-1], test, None, "pitch", ()))
    assert len(orders) == sent
