"""What a pilot reads in one glance."""

from dataclasses import replace

import pytest

from advisor.campaign.state import CampaignState
from advisor.decision.arriving import Arriving
from advisor.decision.inputs import StepInput
from advisor.flight.signals.trust import InstrumentFinding
from advisor.report.facts.answers import decisions
from advisor.session.conducting import LinkHealth, View
from advisor.tui.advice import advise
from advisor.tui.panes.courses import share_of_limit
from advisor.tui.panes.last_verdict import for_the_pilot
from advisor.tui.panes.pilot import BigWord, flying_in_words, how_far
from advisor.tui.screens.pilot import limits_now
from advisor.tui.stick_drawing import stick_drawing, stick_line
from advisor.words.problems import Problem
from tests.campaign.side_builders import judged
from tests.campaign.side_builders import state as lateral_state
from tests.campaign.states import changed
from tests.tui import flights
from tests.tui.stage import stage
from tests.tui.stand_ins import HandFedSource

GOOD = LinkHealth("good", "412 messages/s.")
LOST = LinkHealth("lost", "Nothing heard for 4 s.")


def after_the_input(flown: int, free_s: float = 3.5) -> CampaignState:
    """Return a state with the free response of a manoeuvre in the air."""
    state = flights.state(flown, in_the_air=True)
    assert state.flying is not None
    span = replace(state.flying.span, last_step_s=state.flying.span.end_s - free_s)
    return replace(state, flying=replace(state.flying, span=span))


def view(state=None, health: LinkHealth = GOOD) -> View:
    return View(state or flights.state(3), health, None, flights.AIRCRAFT, "a link")


@pytest.mark.parametrize(
    ("state", "word"),
    [
        (flights.state(0), "CONTINUE"),
        (flights.state(3), "CONTINUE"),
        (flights.state(3, bad=(3,)), "REPEAT"),
        (flights.state(7), "TEST COMPLETE"),
        (after_the_input(3), "RECOVER"),
        (after_the_input(3, free_s=2.0), "CONTINUE"),
        (after_the_input(7), "TEST COMPLETE"),
        (replace(flights.state(2), arriving=Arriving(60.0, {"M_alpha": 98.0})), "ENOUGH"),
        (replace(flights.state(0), vehicle=None), "WAIT"),
    ],
)
def test_the_word_follows_the_verdicts(state, word: str):
    assert advise(view(state)).word == word


@pytest.mark.parametrize(
    ("state", "words"),
    [
        (flights.state(3, in_the_air=True), "flown 4 s of 8"),
        (after_the_input(3, free_s=2.0), "flown 4 s of 8; hold the stick still"),
        (after_the_input(3), "flown 4 s of 8; recover"),
    ],
)
def test_after_the_input_the_pilot_holds_still_until_the_response_is_recorded(state, words: str):
    assert flying_in_words(view(state)) == words


def test_a_lost_link_is_the_word_where_no_manoeuvre_was_judged():
    advice = advise(view(flights.state(0), LOST))
    assert (advice.word, advice.sentence) == ("NO LINK", "Nothing heard for 4 s.")


@pytest.mark.parametrize(
    ("state", "word"),
    [
        (flights.state(7), "TEST COMPLETE"),
        (after_the_input(3), "RECOVER"),
        (flights.state(3, bad=(3,)), "REPEAT"),
        (replace(flights.state(3), no_data=(Problem("rate", "Nothing arrives.", "Wait."),)), "CONTINUE"),
    ],
)
def test_the_last_word_stays_on_a_lost_link_and_says_since_when_it_is_old(state, word):
    advice = advise(view(state, LOST))
    assert (advice.word, advice.age) == (word, "no link: Nothing heard for 4 s.")


def movement(judged, kind="other", accepted=False):
    span = replace(judged.maneuver.span, kind=kind)
    verdict = replace(judged.verdict, accepted=accepted, sentence="NO TEST INPUT: too gentle; more stick")
    return replace(judged, maneuver=replace(judged.maneuver, span=span), verdict=verdict)


def test_trimming_of_the_elevator_takes_no_part_in_a_test_of_roll_and_yaw():
    trimming = tuple(map(movement, flights.state(2, bad=(1, 2)).maneuvers))
    side = lateral_state(judged(1, "aileron"))
    state = changed(flights.state(0), maneuvers=trimming, lateral=side)
    assert state.plan is None
    assert state.tested_sideways is side
    assert advise(view(state)).word == "CONTINUE"
    assert advise(view(state)).sentence == side.flight_test.sentence
    assert for_the_pilot(trimming[-1], False) == ("✗", "NO TEST INPUT", "too gentle")
    assert next(decisions(state)) == f"Roll and yaw: {side.flight_test.sentence}"


def test_a_named_input_of_each_axis_puts_both_into_the_plan():
    state = changed(flights.state(2), lateral=lateral_state(judged(1, "aileron")))
    assert state.plan is not None
    assert state.tested_sideways is None


SLOW = Problem("rate", "ATTITUDE arrives at 4.0 Hz, too slow.", "Ask for 50 Hz.")


@pytest.mark.parametrize("flown", [0, 3])
def test_data_that_cannot_serve_are_told_at_any_time_with_their_mend(flown: int):
    advice = advise(view(replace(after_the_input(flown), no_data=(SLOW,))))
    assert (advice.word, advice.sentence) == ("NO DATA", str(SLOW))


def test_after_the_stop_no_data_are_wanted():
    assert advise(view(replace(flights.state(7), no_data=(SLOW,)))).word == "TEST COMPLETE"


def test_before_the_data_are_judged_the_screen_waits_and_gives_no_advice():
    advice = advise(view(replace(flights.state(0), serves=False)))
    assert advice.word == "WAIT"
    assert "next" not in advice.sentence
    assert advise(view(flights.state(0))).word == "CONTINUE"


def test_while_the_first_manoeuvre_is_judged_the_screen_waits():
    assert advise(view(replace(flights.state(0), judging=True))).word == "WAIT"
    assert advise(view(replace(flights.state(3), judging=True))).word == "CONTINUE"


REVERSED = InstrumentFinding(
    "alpha", "sign", "nose up", "nose down", 0.02, True, "alpha has the wrong sign", "turn the vane"
)
IN_COUNTS = InstrumentFinding(
    "a_z", "unit", "mg", "2048 counts a g", 0.02, True, "a_z is in counts", "send a_z in mg", used=True
)


def test_a_contradicted_instrument_asks_for_its_mend_and_not_for_another_manoeuvre():
    here = view(replace(flights.state(3, bad=(3,)), instruments=(IN_COUNTS, REVERSED)))
    assert [problem.code for problem in here.obstacles] == ["alpha_sign"]
    advice = advise(here)
    assert (advice.word, advice.sentence) == ("NO DATA", "Alpha has the wrong sign. Fix: turn the vane.")


async def test_the_pilot_sees_what_stops_the_test_and_the_engineer_every_instrument():
    async with stage(replace(flights.state(3), instruments=(IN_COUNTS, REVERSED))) as here:
        await here.until(lambda: here.app.screen.query_one(BigWord).word == "NO DATA")
        assert "Alpha has the wrong sign." in here.page()
        assert "! 2 warnings for the engineer" in here.page()
        await here.press("e", "7")
        await here.until(lambda: "! Alpha has the wrong sign." in here.words("Channels Lines"))
        assert "! A_z is in counts." in here.words("Channels Lines")


async def test_no_data_stands_on_the_screen_after_a_manoeuvre_and_goes_when_they_serve_again():
    async with stage(replace(flights.state(3), no_data=(SLOW,)), flights.state(3)) as here:
        await here.until(lambda: here.app.screen.query_one(BigWord).word == "NO DATA")
        assert "ATTITUDE arrives at 4.0 Hz" in here.page()
        here.source.deliver()
        await here.until(lambda: here.app.screen.query_one(BigWord).word == "CONTINUE")


def test_a_bad_manoeuvre_taken_out_by_hand_need_not_be_repeated():
    state = flights.state(3, bad=(3,))
    taken_out = replace(state.maneuvers[-1], excluded_because="radio call")
    assert advise(view(changed(state, maneuvers=(*state.maneuvers[:-1], taken_out)))).word == "CONTINUE"


async def test_the_last_verdict_is_symbol_and_word_and_sentence():
    async with stage(flights.state(3, bad=(3,))) as here:
        await here.until(lambda: "REPEAT" in here.words("#verdict-word"))
        assert "✗ REPEAT" in here.words("#verdict-word")
        assert "manoeuvre 3: reverse 3-2-1-1" in here.words("#verdict-word")
        assert "use about 1.5 times the stick" in here.words("#verdict-sentence")


async def test_the_screen_tells_all_a_pilot_needs():
    async with stage(flights.state(5)) as here:
        await here.until(lambda: "accepted of 5" in here.words())
        for said in (
            "✓ ✗ ✓ ✓ ✓   4 accepted of 5",
            "about 2 more, 9 times in 10 at most 4",
            "reverse 3-2-1-1, 0.4 s steps, 60 % stick, ±15.0 deg of elevator",
            "✓ bank 4 deg (≤ 30)    ✓ V 26 m/s (22 to 30)    α 3 deg",
            "✓ link good",
            "! 1 warning for the engineer",
        ):
            assert said in here.words()


async def test_a_new_verdict_changes_the_word():
    source = HandFedSource()
    async with stage(flights.state(6), flights.state(7), source=source) as here:
        await here.until(lambda: here.app.screen.query_one(BigWord).word == "CONTINUE")
        source.deliver()
        await here.until(lambda: here.app.screen.query_one(BigWord).word == "TEST COMPLETE")


async def test_nothing_is_repainted_while_nothing_matters():
    source = HandFedSource()
    async with stage(flights.state(5), source=source) as here:
        await here.until(lambda: "accepted of 5" in here.words())
        painted: list[str] = []
        for widget in here.app.screen.query("*"):
            widget.refresh = lambda *a, w=widget, **k: painted.append(type(w).__name__) or w  # type: ignore[method-assign]
        source.deliver(3)
        await here.until(lambda: len(here.campaign.fed) == 3)
        await here.pilot.pause(0.25)
        assert painted == []


async def test_before_the_first_heartbeat_the_screen_says_what_it_waits_for():
    nothing = replace(flights.state(0), vehicle=None, channels={})
    source = HandFedSource()
    source.condition = LinkHealth("waiting", "No vehicle heard yet; check that it sends to this address.")
    async with stage(nothing, source=source) as here:
        await here.until(lambda: "check that it sends to this address" in here.words("Why"))
        assert here.app.screen.query_one(BigWord).word == "WAIT"
        assert "bank, air speed and angle of attack are not received" in here.words()


async def test_the_pilot_sees_how_long_the_manoeuvre_lasts_and_no_number_of_the_engineer():
    async with stage(flights.state(3, in_the_air=True)) as here:
        await here.until(lambda: "flown 4 s of 8" in here.words("CrewNotes"))
        for engineers in ("M_α", "criterion", "AOA_SSA", "Z_q"):
            assert engineers not in here.words()


def test_after_the_end_a_rejected_manoeuvre_is_not_used_and_needs_no_mend():
    rejected = flights.judged(8, accepted=False)
    assert for_the_pilot(rejected, test_is_complete=False)[:2] == ("✗", "REPEAT")
    assert for_the_pilot(rejected, test_is_complete=True) == (
        "✗",
        "NOT USED",
        "too gentle, pitch rate 3 deg/s",
    )


def test_the_way_to_the_end_is_the_share_of_the_manoeuvres_flown():
    assert how_far(view(flights.state(6))) == f"{'█' * 15}{'·' * 5}  about 2 more, 9 times in 10 at most 4"
    assert how_far(view(flights.state(7))) == f"{'█' * 20}  complete"


def test_a_value_outside_its_limit_has_a_cross_before_the_step():
    state = flights.state(3)
    banked = replace(state.channels["bank"], newest=0.6)
    slow = replace(state.channels["airspeed"], newest=20.0)
    here = view(replace(state, channels={**state.channels, "bank": banked, "airspeed": slow}))
    assert "✗ bank 34 deg (≤ 30)    ✗ V 20 m/s" in limits_now(here)


def test_a_criterion_far_above_its_limit_is_a_multiple():
    assert share_of_limit(27725.0) == "277 times its limit"
    assert share_of_limit(152.0) == "152 % of its limit"


async def test_a_complete_test_holds_no_bank_against_a_limit():
    async with stage(flights.state(7)) as here:
        assert here.words("LimitsNow") == "before it   nothing is left to fly"


def test_the_stick_is_drawn_step_by_step_with_seconds():
    flown = StepInput("3-2-1-1", 0.4, 0.1, nose_up_first=False)
    assert stick_drawing(flown.steps, 70).split("\n") == [
        "pull                       ┌───────────┐     ┌─────┐",
        "      ───┐                 │           │     │     └──",
        "push     └─────────────────┘           └─────┘",
        "               1.2 s          0.8 s    0.4 s 0.4 s",
    ]
    assert stick_drawing(flown.steps, 40) == ""
    assert stick_line(flown.steps) == "▁▁▁▁▁▁▔▔▔▔▁▁▔▔"


STALE = LinkHealth("stale", "ESTIMATOR NOT ANSWERING for 5 s: the values below are old")


def test_an_estimator_that_does_not_answer_leaves_a_complete_test_complete() -> None:
    complete = advise(view(flights.state(7), STALE))
    assert (complete.word, complete.age) == ("TEST COMPLETE", STALE.sentence)
    assert advise(view(flights.state(3), STALE)).word == "WAIT"
