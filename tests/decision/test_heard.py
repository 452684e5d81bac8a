"""A criterion's history is what the crew heard, and a stop that was heard stays."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import CampaignPlan
from advisor.decision import stopping
from advisor.decision.history import CandidateManeuver, Heard, revision, spoken_after
from advisor.decision.stopping import flight_test
from advisor.decision.verdict import ManeuverVerdict, NextInput, Reason, Remaining
from tests.decision.campaigns import THETA, estimate, with_change

PLAN = CampaignPlan(rule="continuous")
NOTHING = Heard({"continuous": None}, frozenset())
AGREEING = [CandidateManeuver(estimate(k * THETA)) for k in (0.99, 1.0, 1.01)]


def heard_so_far(history):
    """What a crew heard after each of these manoeuvres."""
    heard: list[Heard] = []
    for n in range(1, len(history) + 1):
        verdict = flight_test(history[:n], PLAN, heard=heard)
        heard.append(Heard.of(verdict, range(n)))
    return heard


def test_later_estimates_make_a_line_of_their_own_and_no_other_past() -> None:
    heard = [NOTHING, NOTHING, Heard({"continuous": 40.0}, frozenset())]
    progress = flight_test(AGREEING, PLAN, heard=heard).by_rule["continuous"]
    now = 5.0 * np.sqrt(8.0)
    assert progress.history_percent == (None, None, 40.0)
    assert progress.hindsight_percent == pytest.approx((None, None, now))
    assert progress.hindsight == "by the newest estimates – – 14.1 %: manoeuvre 3 would have been the last"


def test_without_later_estimates_there_is_no_second_line() -> None:
    progress = flight_test(AGREEING, PLAN, heard=heard_so_far(AGREEING)).by_rule["continuous"]
    assert progress.hindsight == ""
    assert progress.stopped_at == 3


def test_a_stop_that_only_later_estimates_show_is_heard_when_they_come() -> None:
    history = [*AGREEING, AGREEING[1]]
    late = [*[NOTHING] * 3, Heard({"continuous": 40.0}, frozenset())]
    verdict = flight_test(history, PLAN, heard=late)
    assert verdict.decision == "stop"
    assert verdict.stopped_at == 4
    assert verdict.by_rule["continuous"].hindsight_stopped_at == 3


def test_a_stop_that_was_heard_stays_where_no_change_of_the_aircraft_is_found() -> None:
    odd = CandidateManeuver(estimate(with_change("Z_q", 3.0), std_percent=100.0))
    heard = heard_so_far(AGREEING)
    verdict = flight_test([*AGREEING, odd], PLAN, heard=heard)
    assert not verdict.by_rule["continuous"].holds
    assert verdict.decision == "stop"
    assert verdict.sentence.startswith(
        "TEST COMPLETE since manoeuvre 3; later data open it again: the last 3"
    )
    assert verdict.next is not None
    assert verdict.next.advice.startswith("next: ")


def test_a_change_of_the_aircraft_ends_a_stop_and_is_the_sentence() -> None:
    changed = CandidateManeuver(estimate(with_change("M_alpha", 1.5)))
    verdict = flight_test([*AGREEING, changed, changed], PLAN, heard=[*heard_so_far(AGREEING), NOTHING])
    assert verdict.decision == "continue"
    assert verdict.sentence.startswith("CONTINUE: Something changed after manoeuvre 3: M_α")


def test_a_stop_does_not_rest_on_a_manoeuvre_that_no_longer_counts() -> None:
    refused = replace(AGREEING[2], reasons=(Reason("clock", "the clock leapt", 1.0, 0.0),))
    verdict = flight_test([*AGREEING[:2], refused], PLAN, heard=heard_so_far(AGREEING))
    assert verdict.decision == "continue"


def spoken(last: Remaining | None, now: Remaining | None, percent: float = 60.0) -> Remaining | None:
    """What is spoken after a criterion of 80 per cent, with these forecasts then and now."""
    before = Heard({"continuous": 80.0}, frozenset(), remaining=last)
    return spoken_after(before, now, "continuous", percent)


@pytest.mark.parametrize("now", [(4, 6), (1, 2), (6, 7), (4, 7)])
def test_a_forecast_that_narrows_the_one_before_is_spoken_as_it_is(now) -> None:
    assert spoken(Remaining(5, 8), Remaining(*now)) == Remaining(*now)


@pytest.mark.parametrize("now", [(5, 8), (8, 12), (None, None), (7, None)])
def test_a_forecast_that_does_not_narrow_says_why(now) -> None:
    taught = spoken(Remaining(5, 8), Remaining(*now))
    assert taught == Remaining(*now, "the newest manoeuvre gave less information than forecast")
    risen = spoken(Remaining(5, 8), Remaining(*now), percent=120.0)
    assert risen == Remaining(*now, "the criterion rose from 80 to 120 %")


def test_a_forecast_that_cannot_be_told_again_goes_on_from_the_one_before() -> None:
    found = spoken(Remaining(5, 8), None)
    assert found == Remaining(4, 7, "the newest manoeuvre does not change the number")
    assert found.spoken == (
        "about 4 more, 9 times in 10 at most 7 (the newest manoeuvre does not change the number)"
    )


def test_the_first_forecast_is_spoken() -> None:
    assert spoken(None, Remaining(14, 20)) == Remaining(14, 20)
    assert spoken(Remaining(None, None), Remaining(7, 9)) == Remaining(7, 9)
    assert spoken_after(None, Remaining(14, 20), "continuous", 60.0) == Remaining(14, 20)


@pytest.mark.parametrize("again", [(), (replace(NOTHING, remaining=Remaining(1, 9)),)])
def test_a_forecast_is_compared_with_that_after_the_manoeuvre_before(monkeypatch, again) -> None:
    """What was heard after the newest manoeuvre is not the one before, where all is decided once more."""
    monkeypatch.setattr(stopping, "next_input", lambda *_: NextInput("next: 3-2-1-1", Remaining(3, 5)))
    spoken = []
    for last in (Remaining(2, 4), Remaining(4, 6)):
        heard = [replace(NOTHING, remaining=last), *again]
        following = flight_test(AGREEING[:2], PLAN, heard=heard).next
        spoken.append(following.remaining if following is not None else None)
    assert [one is not None and bool(one.why) for one in spoken] == [True, False]


ACCEPTED = ManeuverVerdict(True, "ACCEPTED: good manoeuvre", (), {})


def refused(text):
    return ManeuverVerdict(False, f"REPEAT: {text}", (Reason("odd", text, 9.0, 6.0),), {})


ODD = refused("contradicts all the others, 9.0 sigma from them (limit 6.0); fly it again")


def test_a_verdict_that_stays_has_no_sentence():
    assert revision(ACCEPTED, ACCEPTED, 6) == ""
    assert revision(ODD, ODD, 6) == ""


def test_an_acceptance_that_is_taken_back_names_the_objection():
    said = revision(ACCEPTED, ODD, 6)
    assert said.startswith(
        "accepted before, refused since manoeuvre 6: contradicts all the others, 9.0 sigma"
    )


def test_a_refusal_that_is_taken_back_names_what_no_longer_holds():
    assert revision(ODD, ACCEPTED, 6) == (
        "refused before, accepted since manoeuvre 6: it no longer contradicts all the others, 9.0 sigma from "
        "them (limit 6.0)"
    )
    said = revision(refused("bank reached 60 deg (limit 45); less aileron"), ACCEPTED, 7)
    assert said.endswith("it no longer counts against it that bank reached 60 deg (limit 45)")
