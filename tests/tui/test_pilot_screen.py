"""What a pilot reads in one glance."""

from dataclasses import replace

import pytest

from advisor.flight.signals.instrument_finding import InstrumentFinding
from advisor.session.source import LinkHealth
from advisor.session.view import View
from advisor.tui.advice import advise
from advisor.tui.panes.big_word import BigWord
from advisor.words.problems import Problem
from tests.tui import flights
from tests.tui.stage import stage
from tests.tui.stand_ins import HandFedSource

GOOD = LinkHealth("good", "412 messages/s.")
LOST = LinkHealth("lost", "Nothing heard for 4 s.")


def view(state=None, health: LinkHealth = GOOD) -> View:
    return View(state or flights.state(3), health, None, flights.AIRCRAFT, "a link")


@pytest.mark.parametrize(
    ("state", "word"),
    [
        (flights.state(0), "CONTINUE"),
        (flights.state(3), "CONTINUE"),
        (flights.state(3, bad=(3,)), "REPEAT"),
        (flights.state(7), "STOP TESTING"),
        (replace(flights.state(3), enough="Enough: recover."), "RECOVER"),
        (replace(flights.state(0), vehicle=None), "WAIT"),
    ],
)
def test_the_word_follows_the_verdicts(state, word: str):
    assert advise(view(state)).word == word


def test_a_lost_link_comes_before_everything():
    advice = advise(view(flights.state(7), LOST))
    assert (advice.word, advice.sentence) == ("NO LINK", "Nothing heard for 4 s.")


SLOW = Problem("rate", "ATTITUDE arrives at 4.0 Hz, too slow.", "Ask for 50 Hz.")


@pytest.mark.parametrize("flown", [0, 3])
def test_data_that_cannot_serve_are_told_at_any_time_with_their_mend(flown: int):
    advice = advise(view(replace(flights.state(flown), no_data=(SLOW,), enough="Enough: recover.")))
    assert (advice.word, advice.sentence) == ("NO DATA", str(SLOW))


def test_after_the_stop_no_data_are_wanted():
    assert advise(view(replace(flights.state(7), no_data=(SLOW,)))).word == "STOP TESTING"


REVERSED = InstrumentFinding(
    "alpha", "sign", "nose up", "nose down", 0.02, True, "alpha has the wrong sense", "turn the vane"
)
IN_COUNTS = InstrumentFinding(
    "a_z", "unit", "mg", "2048 counts a g", 0.02, True, "a_z is in counts", "send a_z in mg", used=True
)


def test_a_contradicted_instrument_asks_for_its_mend_and_not_for_another_manoeuvre():
    here = view(replace(flights.state(3, bad=(3,)), instruments=(IN_COUNTS, REVERSED)))
    assert [problem.code for problem in here.obstacles] == ["alpha_sign"]
    advice = advise(here)
    assert (advice.word, advice.sentence) == ("NO DATA", "Alpha has the wrong sense. Mend: turn the vane.")


async def test_both_screens_say_the_same_of_the_instruments():
    async with stage(replace(flights.state(3), instruments=(IN_COUNTS, REVERSED))) as here:
        await here.until(lambda: here.app.screen.query_one(BigWord).word == "NO DATA")
        assert "Alpha has the wrong sense." in here.page()
        assert "A_z is in counts" in here.page()
        await here.press("e", "7")
        await here.until(lambda: "! Alpha has the wrong sense." in here.words("Channels Lines"))
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
    assert advise(view(replace(state, maneuvers=(*state.maneuvers[:-1], taken_out)))).word == "CONTINUE"


async def test_the_last_verdict_is_symbol_and_word_and_sentence():
    async with stage(flights.state(3, bad=(3,))) as here:
        await here.until(lambda: "REPEAT" in here.words("#verdict-word"))
        assert "✗ REPEAT" in here.words("#verdict-word")
        assert "manoeuvre 3: reverse 3-2-1-1" in here.words("#verdict-word")
        assert "use about 1.5 times the stick" in here.words("#verdict-sentence")


async def test_the_screen_tells_all_a_pilot_needs():
    async with stage(flights.state(5)) as here:
        await here.until(lambda: "31 %" in here.words())
        for said in (
            "✓ ✗ ✓ ✓ ✓   4 good of 5; about 2 more, 9 times in 10 at most 4",
            "above the limit 25 %",
            "reverse 3-2-1-1, 0.4 s steps, 60 % stick",
            "derived, from AOA_SSA.AOA, 20 Hz",
            "✓ link good",
            "! Z_q is near zero",
        ):
            assert said in here.words()


async def test_a_new_verdict_changes_the_word():
    source = HandFedSource()
    async with stage(flights.state(6), flights.state(7), source=source) as here:
        await here.until(lambda: here.app.screen.query_one(BigWord).word == "CONTINUE")
        source.deliver()
        await here.until(lambda: here.app.screen.query_one(BigWord).word == "STOP TESTING")


async def test_nothing_is_repainted_while_nothing_matters():
    source = HandFedSource()
    async with stage(flights.state(5), source=source) as here:
        await here.until(lambda: "31 %" in here.words())
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
        assert "no angle of attack heard yet" in here.words()


async def test_the_estimate_is_seen_to_settle_while_the_manoeuvre_is_flown():
    async with stage(flights.state(3, in_the_air=True)) as here:
        await here.until(lambda: "M_α" in here.words("CrewNotes"))
        assert "flown 4 s of 8; M_α −" in here.words("CrewNotes")


async def test_a_number_that_is_none_yet_is_not_on_the_pilots_screen():
    async with stage(replace(flights.state(3, in_the_air=True), readable=False)) as here:
        await here.until(lambda: "flown 4 s of 8" in here.words("CrewNotes"))
        assert "M_α" not in here.words("CrewNotes")
