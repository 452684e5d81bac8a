"""Stop and advice of roll and yaw, on hand-made estimates of a jet."""

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.decision.axes.lateral_stop import FlownInput, lateral_flight_test
from advisor.decision.history import Heard
from tests.campaign.side_builders import estimate

AIRCRAFT = Aircraft()


def test_aileron_and_rudder_within_their_tolerance_and_checked_stop_the_test():
    both = estimate("aileron", "rudder")
    verdict = lateral_flight_test([estimate("aileron"), estimate("rudder")] * 2, both, AIRCRAFT)
    assert verdict.decision == "stop"
    assert verdict.stopped_at == 4
    assert verdict.next.advice == "no further manoeuvre needed"


def test_a_control_that_one_manoeuvre_moved_is_flown_once_more_to_check_the_estimate():
    both = estimate("aileron", "rudder")
    verdict = lateral_flight_test(
        [estimate("aileron"), estimate("rudder"), estimate("aileron")], both, AIRCRAFT
    )
    assert verdict.decision == "continue"
    assert verdict.sentence == "CONTINUE: one input of the rudder cannot show its own error; one more will."
    assert verdict.next.advice.startswith("next: rudder doublet")


def test_the_joint_estimate_that_is_shown_decides_and_not_the_single_ones():
    poor = [estimate("aileron", percent=40.0), estimate("rudder", percent=40.0)] * 2
    good = estimate("aileron", "rudder", percent=2.0)
    assert lateral_flight_test(poor, good, AIRCRAFT).decision == "stop"
    verdict = lateral_flight_test([estimate("aileron"), estimate("rudder")] * 2, poor[0], AIRCRAFT)
    assert verdict.decision == "continue"


def test_the_share_that_is_said_is_that_of_the_joint_interval():
    joint = estimate("aileron", "rudder", percent=9.0)
    verdict = lateral_flight_test([estimate("aileron"), estimate("rudder")] * 2, joint, AIRCRAFT)
    share = 100.0 * 1.96 * 0.09 / 0.10  # two times the tolerance of 5 %
    assert np.isclose(verdict.by_rule["information"].parameter_percent["L_p"], share, rtol=1e-3)
    assert "is 1.8 times its tolerance" in verdict.sentence


def test_a_stop_that_the_crew_has_heard_stays():
    history = [estimate("aileron"), estimate("rudder")] * 2
    first = lateral_flight_test(history, estimate("aileron", "rudder"), AIRCRAFT)
    worse = estimate("aileron", "rudder", percent=30.0)
    heard = [Heard({"information": None}, frozenset())] * 3 + [Heard.of(first)]
    verdict = lateral_flight_test([*history, estimate("rudder")], worse, AIRCRAFT, (), heard)
    assert verdict.decision == "stop"
    assert verdict.stopped_at == 4
    assert verdict.sentence.startswith(
        "TEST COMPLETE since manoeuvre 4; later data open it again: the error of"
    )
    assert verdict.by_rule["information"].history_percent[3] == first.criterion_percent


def test_the_aileron_alone_does_not_stop_the_test_and_the_rudder_is_advised():
    verdict = lateral_flight_test([estimate("aileron")] * 5, estimate("aileron"), AIRCRAFT)
    assert verdict.decision == "continue"
    assert verdict.criterion_percent is None
    assert verdict.sentence == "CONTINUE: no accepted manoeuvre has moved the rudder."
    assert verdict.next.advice.startswith(
        "next: rudder doublet, 1.8 s steps, 10 % pedal, to begin gently, then hands"
    )


def test_without_any_manoeuvre_the_aileron_comes_first():
    verdict = lateral_flight_test([], None, AIRCRAFT)
    assert verdict.sentence == "No test input of the aileron or the rudder has been flown."
    assert verdict.next.advice.startswith("next: aileron doublet")


def test_without_a_joint_estimate_nothing_is_known():
    verdict = lateral_flight_test([estimate("aileron"), estimate("rudder")] * 2, None, AIRCRAFT)
    assert verdict.decision == "continue"
    assert verdict.sentence == "CONTINUE: the error of L_p is unknown."


def test_the_forecast_counts_the_manoeuvres_that_the_worst_derivative_of_each_control_lacks():
    # Two inputs of each control leave 196 % of the tolerance: the variance must fall to a quarter.
    history = [estimate("aileron"), estimate("rudder")] * 2
    poor = estimate("aileron", "rudder", percent=10.0)
    remaining = lateral_flight_test(history, poor, AIRCRAFT).next.remaining
    assert 12 <= remaining.median <= 18
    assert 25 <= remaining.p90 <= 45


def test_more_manoeuvres_narrow_the_forecast():
    def width(pairs):
        history = [estimate("aileron"), estimate("rudder")] * pairs
        remaining = lateral_flight_test(
            history, estimate("aileron", "rudder", percent=6.0), AIRCRAFT
        ).next.remaining
        return (remaining.p90 - remaining.median) / (2 * pairs + remaining.median)

    assert width(6) < width(2)


def test_a_control_to_be_checked_lacks_one_manoeuvre():
    history = [estimate("aileron"), estimate("rudder"), estimate("aileron")]
    remaining = lateral_flight_test(history, estimate("aileron", "rudder"), AIRCRAFT).next.remaining
    assert remaining.median == 1


def test_a_record_that_no_input_makes_whole_asks_for_its_remedy():
    why = "no lateral acceleration was recorded; record a_y"
    joint = estimate(
        "aileron", "rudder", untold=dict.fromkeys(("L_p", "L_delta_a", "N_beta", "N_delta_r"), why)
    )
    verdict = lateral_flight_test([estimate("aileron"), estimate("rudder")] * 2, joint, AIRCRAFT)
    assert verdict.sentence == f"CONTINUE: {why}."
    assert verdict.next.advice == "next: record a_y"


def test_an_input_of_both_controls_counts_for_each():
    at_once = [estimate("aileron", "rudder")]
    remaining = lateral_flight_test(at_once, at_once[0], AIRCRAFT).next.remaining
    assert (remaining.median, remaining.p90) == (1, 1)


def test_refused_manoeuvres_lengthen_the_forecast():
    history = [estimate("aileron"), estimate("rudder")] * 2
    poor = estimate("aileron", "rudder", percent=10.0)
    clean = lateral_flight_test(history, poor, AIRCRAFT).next.remaining
    spoilt = lateral_flight_test([*history, *[None] * 8], poor, AIRCRAFT).next.remaining
    assert spoilt.median > clean.median


def test_nothing_is_foretold_before_both_controls_have_moved():
    assert lateral_flight_test([estimate("aileron")], estimate("aileron"), AIRCRAFT).next.remaining is None


def test_after_a_refusal_the_advice_names_the_input_that_was_refused():
    history = [estimate("aileron"), estimate("aileron"), estimate("rudder"), None]
    flown = [
        FlownInput("aileron", 0.1, 0.2),
        FlownInput("aileron", 0.1, 0.2),
        FlownInput("rudder", 0.1, 0.2),
        FlownInput("aileron", 0.1, 0.2, "fly it again"),
    ]
    open_aileron = estimate("aileron", "rudder", percent=9.0)
    advice = lateral_flight_test(history, open_aileron, AIRCRAFT, flown).next.advice
    assert advice.startswith("next: aileron doublet")
    assert advice.endswith("; fly it again")


def test_a_remedy_for_a_complete_control_does_not_stand_beside_the_advice_on_the_other():
    history = [estimate("aileron"), estimate("aileron"), estimate("rudder"), None]
    flown = [
        FlownInput("rudder", 0.1, 0.2),
        FlownInput("aileron", 0.1, 0.2, "fly it again"),
    ]
    advice = lateral_flight_test(history, estimate("aileron", "rudder"), AIRCRAFT, flown).next.advice
    assert advice.startswith("next: rudder doublet")
    assert "again" not in advice


def test_an_aircraft_without_a_rudder_is_asked_for_no_rudder_input():
    verdict = lateral_flight_test([estimate("aileron")], estimate("aileron"), AIRCRAFT, controls=("aileron",))
    assert "this aircraft has no rudder" in verdict.sentence
    assert verdict.next.advice.startswith("next: aileron doublet")
    assert set(verdict.by_rule["information"].parameter_percent) == {"L_p", "L_delta_a", "N_beta"}


def test_two_aileron_inputs_stop_the_test_of_an_aircraft_without_a_rudder():
    verdict = lateral_flight_test(
        [estimate("aileron")] * 2, estimate("aileron"), AIRCRAFT, controls=("aileron",)
    )
    assert verdict.decision == "stop"
