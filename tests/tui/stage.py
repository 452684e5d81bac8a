"""Runs the real application headless over a campaign and a source under the test's control."""

import re
from asyncio import sleep
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass
from html import unescape
from pathlib import Path
from time import monotonic
from typing import Any

from textual.pilot import Pilot
from textual.widget import Widget

from advisor.campaign.state import CampaignState
from advisor.session.conducting import Source, Tempo
from advisor.session.conductor import Conductor
from advisor.session.replay import LogPlayer
from advisor.tui.app import AdvisorApp
from advisor.tui.panes.pane import Lines
from advisor.tui.settings import Settings
from tests.tui import flights
from tests.tui.stand_ins import HandFedSource, StagedCampaign

_TEXT = re.compile(r'<text class="[^"]*-r\d+" x="([\d.]+)" y="([\d.]+)"[^>]*>([^<]*)<')


@dataclass
class Stage:
    """The running application and what it runs on."""

    app: AdvisorApp
    pilot: Pilot[None]
    campaign: Any
    source: Source

    async def until(self, condition: Callable[[], bool], patience_s: float = 20.0) -> None:
        """Let the application work until something is so."""
        end = monotonic() + patience_s
        while not condition():
            if monotonic() > end:
                raise AssertionError("It did not come to that.")
            await sleep(0.02)  # a pause of the pilot would have every widget answer
        await self.pilot.pause()

    async def press(self, *keys: str) -> None:
        """Press keys and let their effects happen."""
        await self.pilot.press(*keys)
        await self.pilot.pause()

    def page(self) -> str:
        """The characters on the screen, row by row."""
        rows: dict[float, str] = {}
        for x, y, text in _TEXT.findall(self.app.export_screenshot()):
            rows[float(y)] = rows.get(float(y), "").ljust(round(float(x) / 12.2)) + unescape(text)
        return "\n".join(rows[y].replace("\xa0", " ").rstrip() for y in sorted(rows))

    async def still_page(self) -> str:
        """The page once nothing on it has moved for a while, even on a busy machine."""
        now, still = self.page(), 0
        while still < 3:
            await self.pilot.pause(0.5)
            before, now = now, self.page()
            still = still + 1 if now == before else 0
        return now

    def words(self, selector: str = "Lines") -> str:
        """Everything that a part of the screen says."""
        return "\n".join(str(w.render()) for w in self.app.screen.query(selector).results(Lines) if shown(w))


def shown(widget: Widget) -> bool:
    """Whether a widget and everything around it is displayed."""
    return all(node.display for node in widget.ancestors_with_self if isinstance(node, Widget))


@asynccontextmanager
async def stage(
    *states: CampaignState,
    size: tuple[int, int] = (120, 40),
    settings: Settings | None = None,
    source: Source | None = None,
    logs: Sequence[Path] = (),
) -> AsyncIterator[Stage]:
    """The application over a campaign that goes through ``states``, shown the first of them."""
    campaign = StagedCampaign(states or (flights.state(),))
    source = source or HandFedSource()
    tempo = Tempo() if isinstance(source, LogPlayer) else None
    app = AdvisorApp(
        Conductor(source, lambda by_hand: campaign),
        flights.AIRCRAFT,
        "udpin:127.0.0.1:0",
        tempo,
        settings,
        logs,
    )
    async with app.run_test(size=size, notifications=True) as pilot:
        here = Stage(app, pilot, campaign, source)
        await here.until(lambda: app.view.state.vehicle == campaign.state.vehicle and app.is_attached)
        yield here
