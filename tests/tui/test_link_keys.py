"""Keys of a live link: another vehicle, the elevator's output."""

from dataclasses import replace

from advisor.flight.elevator.elevator_guess import Guess
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.session.conducting import LinkHealth, LinkRequest
from advisor.session.replay import LogPlayer
from advisor.tui.explaining import keys_at_hand
from advisor.tui.panes.pilot import BigWord
from advisor.tui.screens.face import KeysLine
from advisor.tui.settings import Settings
from advisor.words.problems import Problem
from tests.tui import flights
from tests.tui.stage import Stage, stage
from tests.tui.stand_ins import HandFedSource, columns


def said(here: Stage) -> str:
    return str(here.app.screen.query_one(KeysLine).render())


async def test_one_key_follows_another_vehicle_from_either_screen():
    for screen in ("pilot", "engineer"):
        source = HandFedSource()
        state = replace(flights.state(0), other_vehicles=(2,))
        async with stage(state, source=source, settings=Settings(screen=screen)) as here:
            await here.press("v")
            await here.until(lambda source=source: source.orders == [LinkRequest("follow", 2)])
            assert "vehicle 2 is followed now" in said(here)


async def test_several_others_are_followed_one_after_the_other():
    source = HandFedSource()
    state = replace(flights.state(0), vehicle=Vehicle(3, 1, "ardupilot", 1), other_vehicles=(2, 5))
    async with stage(state, source=source) as here:
        await here.press("v")
        await here.until(lambda: source.orders == [LinkRequest("follow", 5)])


async def test_once_manoeuvres_are_judged_the_sentence_names_the_option_instead():
    source = HandFedSource()
    async with stage(replace(flights.state(2), other_vehicles=(2,)), source=source) as here:
        await here.press("v")
        assert "--target-system 2" in said(here)
        assert source.orders == []


async def test_a_lost_vehicle_names_the_key_that_follows_another():
    source = HandFedSource()
    source.condition = LinkHealth("lost", "Nothing heard for 9 s.")
    async with stage(replace(flights.state(0), other_vehicles=(2,)), source=source) as here:
        await here.until(lambda: here.app.screen.query_one(BigWord).word == "NO LINK")
        assert "Vehicle 2 is heard: key v follows another." in here.words("Why")


async def test_two_vehicles_under_one_id_stand_on_the_pilots_screen():
    two = Problem("two_senders", "Two vehicles send under system id 1.", "Give one of them another id.")
    async with stage(replace(flights.state(3), no_data=(two,))) as here:
        await here.until(lambda: "Two vehicles send under system id 1." in here.words("Why"))


async def test_the_outputs_are_asked_for_by_a_key_and_the_screen_says_what_is_sent():
    source = HandFedSource()
    async with stage(source=source, settings=Settings(screen="engineer")) as here:
        await here.press("a")
        await here.until(lambda: source.orders == [LinkRequest("outputs")])
        assert "asked for SERVOn_*" in said(here)
        assert "nothing else is sent" in said(here)


async def test_a_guess_stands_on_the_screen_as_one_and_a_key_takes_it():
    source = HandFedSource()
    missing = Problem(
        "no_elevator", "Nothing says which servo output is the elevator.", "Set elevator.output."
    )
    state = replace(flights.state(0), no_data=(missing,), elevator_guess=Guess(2, 0.31, 0.01))
    async with stage(state, source=source) as here:
        await here.until(
            lambda: "Output 2 is a guess: it explains 31 %" in " ".join(here.words("Why").split())
        )
        await here.press("g")
        await here.until(lambda: source.orders == [LinkRequest("take", 2)])


async def test_a_replay_has_no_keys_of_a_link():
    player = LogPlayer("a.tlog", lambda: [columns(range(50), [k / 50.0 for k in range(50)])])
    async with stage(flights.state(2), source=player) as here:
        assert {key.name for key in keys_at_hand(here.app)}.isdisjoint({"follow", "outputs", "guess"})
