"""The application on a real link: the bundled aircraft flies as a process of its own, over UDP."""

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.bundled.demo import Demonstration
from advisor.campaign.campaign import Campaign
from advisor.campaign.state import ByHand
from advisor.session.conductor import Conductor
from advisor.session.live import LinkSource
from advisor.tui.app import AdvisorApp
from advisor.tui.panes.pilot import BigWord
from advisor.tui.settings import Settings
from tests.tui.stage import Stage


@pytest.mark.study
async def test_a_flight_over_a_real_link_is_followed_to_the_stop():
    flight = Demonstration("linear", speed=10.0, seed=1)
    source = LinkSource(flight, flight.over)
    campaigns: list[Campaign] = []

    def make(by_hand: ByHand) -> Campaign:
        campaigns.append(Campaign(Aircraft(), informs=True, by_hand=by_hand))
        return campaigns[-1]

    app = AdvisorApp(Conductor(source, make), Aircraft(), "demonstration", None, Settings(screen="engineer"))
    async with app.run_test(size=(80, 24)) as pilot:
        here = Stage(app, pilot, campaigns, source)
        await here.until(lambda: len(app.view.state.maneuvers) >= 1, patience_s=60.0)
        assert str(app.view.state.vehicle) == "ardupilot 1/1"
        await here.until(lambda: app.view.health.condition in ("good", "poor"))
        assert app.screen.query_one("Maneuvers DataTable").row_count >= 1
        await here.press("p")
        await here.until(lambda: app.view.state.flight_test.decision == "stop", patience_s=60.0)
        await here.until(lambda: app.screen.query_one(BigWord).word in ("TEST COMPLETE", "RECOVER"))
        assert "✓ GOOD" in here.words("#verdict-word")
        assert campaigns[0].problems == []
