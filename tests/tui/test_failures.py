"""What cannot be used ends the screens with its sentence; what is slow does not hold them up."""

import asyncio
import time
from dataclasses import replace
from threading import Event

import pytest

from advisor.problems import Problem, UnusableInputError
from advisor.tui.app import AdvisorApp
from advisor.tui.panes.big_word import BigWord
from advisor.tui.screens.engineer import EngineerScreen
from advisor.tui.source import LinkHealth
from tests.tui import flights
from tests.tui.stage import stage
from tests.tui.stand_ins import HandFedSource, StagedCampaign


@pytest.mark.parametrize(
    "error", [UnusableInputError("rate", "AOA_SSA arrives at 4.0 Hz."), ZeroDivisionError("a fault")]
)
async def test_a_source_that_cannot_be_used_ends_the_application_and_tells_why(error: Exception):
    source = HandFedSource()
    async with stage(source=source) as here:
        source.batches.put(error)
        await here.until(lambda: here.app._exit)
        assert here.app.failure is error
        assert source.closed


async def test_keys_are_answered_while_an_estimate_runs():
    answered = Event()

    def estimate() -> None:
        end = time.monotonic() + 20.0
        while not answered.is_set() and time.monotonic() < end:
            sum(k * k for k in range(1000))

    source = HandFedSource()
    campaign = StagedCampaign([flights.state(3)], on_feed=estimate)
    app = AdvisorApp(source, lambda: campaign, flights.AIRCRAFT)
    async with app.run_test(size=(80, 24)) as pilot:
        source.deliver()
        while not campaign.feeding:
            await pilot.pause(0.01)
        await pilot.press("e")
        assert campaign.feeding
        assert isinstance(app.screen, EngineerScreen)
        answered.set()


async def test_leaving_ends_the_working_thread_and_closes_the_source():
    source = HandFedSource()
    async with stage(source=source):
        assert not source.closed
    for _ in range(100):
        if source.closed:
            return
        await asyncio.sleep(0.02)
    raise AssertionError("The source stayed open.")


async def test_a_log_without_what_is_needed_says_so_and_is_answered_for_in_the_end():
    problem = Problem("rate", "AOA_SSA arrives at 4.0 Hz.", "Set SR0_EXTRA1 to 50.")
    source = HandFedSource()
    async with stage(flights.state(0), source=source) as here:
        here.campaign.problems.append(problem)
        source.condition = LinkHealth("ended", "The log has been played to its end.")
        await here.until(lambda: here.app.screen.query_one(BigWord).word == "NO DATA")
        assert "AOA_SSA arrives at 4.0 Hz. Set SR0_EXTRA1 to 50." in here.words("Why")
        assert isinstance(here.app.failure, UnusableInputError)
        await here.press("e", "7")
        assert "! AOA_SSA arrives at 4.0 Hz." in here.words("Channels Lines")


async def test_a_vehicle_is_given_time_to_send_what_is_needed():
    young = replace(flights.state(0), duration_s=3.0)
    async with stage(young) as here:
        here.campaign.problems.append(Problem("no_elevator", "No elevator is heard.", ""))
        await here.until(lambda: bool(here.app.view.problems))
        assert here.app.screen.query_one(BigWord).word == "CONTINUE"


async def test_a_report_that_arrives_while_the_screen_is_taken_down_does_no_harm():
    async with stage(flights.state(3)) as here:
        await here.app.screen.query_one("#verdict-block").remove()
        here.app.screen.show(here.app.view)
