"""Which flights tell nothing of the axis that is asked for."""

import pytest

from advisor.analysis.whole_flights import holds_no_test, left_out_of
from advisor.campaign.state import CampaignState
from advisor.flight.stream.flights import FlightHeard
from advisor.words.problems import Problem
from tests.campaign.side_builders import judged, state
from tests.campaign.states import changed
from tests.tui import flights


def one_flight(code: str) -> CampaignState:
    """A flight with an accepted aileron doublet, and with one problem."""
    heard = FlightHeard(
        0, "flight.tlog", None, 60.0, {}, problems=(Problem(code, "It lacks this.", "Add it."),)
    )
    return changed(flights.state(0), flights=(heard,), lateral=state(judged(1, "aileron")))


@pytest.mark.parametrize("code", ["no_maneuver", "no_elevator", "no_alpha"])
@pytest.mark.parametrize("axis", ["lateral", "both"])
def test_a_flight_that_lacks_what_only_the_elevator_needs_tells_of_roll_and_yaw(axis, code: str):
    assert left_out_of(axis, one_flight(code)) == {}


@pytest.mark.parametrize("axis", ["lateral", "both"])
def test_a_flight_without_a_pitch_rate_tells_of_neither_axis(axis):
    assert list(left_out_of(axis, one_flight("no_pitch_rate"))) == [0]


@pytest.mark.parametrize(("codes", "untested"), [
    (("no_maneuver",), True), (("no_aileron",), True), (("no_maneuver", "rate"), False), ((), False),
])  # fmt: skip
def test_a_flight_holds_no_test_where_nothing_else_keeps_it_from_counting(codes, untested):
    problems = tuple(Problem(code, "It lacks this.", "Add it.") for code in codes)
    assert holds_no_test({0: problems} if codes else {}) is untested
