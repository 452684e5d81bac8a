"""What cannot be used ends the screens with its sentence."""

import asyncio

import pytest

from advisor.session.conducting import LinkHealth
from advisor.tui.panes.pilot import BigWord
from advisor.tui.screens.face import Alarm
from advisor.words.problems import Problem, UnusableInputError
from tests.tui import flights
from tests.tui.stage import stage
from tests.tui.stand_ins import HandFedSource


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
    young = flights.state(0)
    async with stage(young) as here:
        here.campaign.problems.append(Problem("no_elevator", "No elevator is heard.", ""))
        await here.until(lambda: bool(here.app.view.problems))
        assert here.app.screen.query_one(BigWord).word == "CONTINUE"


async def test_a_report_that_arrives_while_the_screen_is_taken_down_does_no_harm():
    async with stage(flights.state(3)) as here:
        await here.app.screen.query_one("#verdict-block").remove()
        here.app.screen.show(here.app.view)


async def test_a_disk_that_takes_nothing_is_told_across_both_screens():
    source = HandFedSource()
    async with stage(flights.state(1), source=source) as here:
        assert not here.app.screen.query_one(Alarm).display
        source.condition = LinkHealth("good", "412 messages/s.", alarm="the disk takes no recording")
        await here.until(lambda: "the disk takes no recording" in here.words("Alarm"))
        assert here.app.screen.query_one(Alarm).display
        await here.press("e")
        assert "the disk takes no recording" in here.words("Alarm")
