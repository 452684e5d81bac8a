"""Pictures of both screens, taken from the running application.

    python -m benchmarks.pages.screens logs/arduplane-calm.tlog --after 5 --out docs

The command plays the log until the given number of manoeuvres are judged and the next is in the air. The
command then writes ``pilot.svg`` and ``engineer.svg``.
"""

import argparse
import asyncio
from collections.abc import Sequence
from math import inf
from pathlib import Path

from advisor.aircraft_file.read import load_aircraft
from advisor.campaign.campaign import Campaign
from advisor.flight.signals.messages import Columns
from advisor.mavlink.logs.logs import read_whole_log
from advisor.session.conducting import Tempo
from advisor.session.conductor import Conductor
from advisor.session.replay import LogPlayer
from advisor.tui.app import AdvisorApp
from advisor.tui.settings import Face, Settings
from advisor.tui.taking import drawn

SIZES: dict[Face, tuple[int, int]] = {"pilot": (100, 30), "engineer": (180, 50)}


async def picture(log: Path, aircraft_file: Path | None, face: Face, after: int, theme: str) -> str:
    """Return one screen as SVG, with manoeuvre ``after + 1`` in the air, or at the end of the log."""
    aircraft = load_aircraft(aircraft_file)

    def load() -> Sequence[Columns]:
        return [columns for batch in read_whole_log(log) for columns in batch]

    player = LogPlayer(log.name, load, inf)
    conductor = Conductor(player, lambda by_hand: Campaign(aircraft, informs=True, by_hand=by_hand))
    app = AdvisorApp(conductor, aircraft, log.name, Tempo(speed=inf), Settings(theme, face))
    async with app.run_test(size=SIZES[face]) as pilot:
        app.conductor.jump(after + 1)
        state = app.view.state
        while app.view.health.condition != "ended":
            await pilot.pause(0.02)
            state = app.view.state
            if len(state.maneuvers) >= after and state.flying:
                app.action_pause()
                break
        await pilot.pause(0.3)
        return drawn(app.export_screenshot(title=f"advisor replay {log.name}"))


def main() -> None:
    """Write both pictures."""
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument("log", type=Path)
    options.add_argument("--aircraft", type=Path)
    options.add_argument("--after", type=int, default=5)
    options.add_argument("--theme", default="dark")
    options.add_argument("--out", type=Path, default=Path("docs"))
    chosen = options.parse_args()
    for face in SIZES:
        svg = asyncio.run(picture(chosen.log, chosen.aircraft, face, chosen.after, chosen.theme))
        (chosen.out / f"{face}.svg").write_text(svg, encoding="utf-8")


if __name__ == "__main__":
    main()
