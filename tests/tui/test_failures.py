"""What cannot be used ends the screens with its sentence; what is slow does not hold them up."""

import asyncio
import time
from threading import Event

import pytest

from advisor.problems import UnusableInputError
from advisor.tui.app import AdvisorApp
from advisor.tui.screens.engineer import EngineerScreen
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
