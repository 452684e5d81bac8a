"""Both screens, character by character, at fixed sizes.

After an intended change: ``pytest tests/tui/test_snapshots.py --snapshot-update``; look at the difference.
"""

import pytest
from syrupy.assertion import SnapshotAssertion

from advisor.tui.settings import Settings
from tests.tui import flights
from tests.tui.stage import stage


@pytest.mark.parametrize("size", [(80, 24), (120, 40)], ids=str)
async def test_the_pilot_screen_looks_as_it_did(size: tuple[int, int], snapshot: SnapshotAssertion):
    async with stage(flights.state(5, bad=(2, 5)), size=size) as here:
        await here.until(lambda: "REPEAT" in here.words("#verdict-word"))
        assert await here.still_page() == snapshot


@pytest.mark.parametrize(("size", "pane"), [((80, 24), 3), ((120, 40), 4), ((180, 50), 4)], ids=str)
async def test_the_engineer_screen_looks_as_it_did(size, pane, snapshot):
    async with stage(
        flights.state(4, in_the_air=True), size=size, settings=Settings(screen="engineer")
    ) as here:
        await here.until(lambda: here.app.screen.query_one("Maneuvers DataTable").row_count == 4)
        await here.press(str(pane))
        assert await here.still_page() == snapshot
