"""Pictures of both screens, taken from the running application.

    python -m advisor.tui.picture logs/arduplane-calm.tlog --after 5 --out docs

plays the log until so many manoeuvres are judged and the next is in the air, and writes
``pilot.svg`` and ``engineer.svg``.
"""

import argparse
import asyncio
import re
from collections.abc import Sequence
from html import escape, unescape
from math import inf
from pathlib import Path

from advisor.campaign.campaign import Campaign
from advisor.config import load_aircraft
from advisor.flight.messages import Columns
from advisor.mavlink.logs import open_log
from advisor.tui.app import AdvisorApp
from advisor.tui.conductor import Conductor
from advisor.tui.plot.canvas import BITS, BLANK
from advisor.tui.replay import LogPlayer
from advisor.tui.settings import Face, Settings
from advisor.tui.source import Tempo

SIZES: dict[Face, tuple[int, int]] = {"pilot": (100, 30), "engineer": (180, 50)}
_CELL_WIDTH, _CELL_HEIGHT, _BASELINE = 12.2, 24.4, 18.5
_TEXT = re.compile(
    r'<text class="(?P<ink>[^"]*)" x="(?P<x>[^"]*)" y="(?P<y>[^"]*)" textLength="[^"]*"(?P<rest>[^>]*)>'
    r"(?P<text>[^<]*)</text>"
)
_FONTS = re.compile(r"@font-face \{.*?\}", re.DOTALL)
_RUNS = re.compile(
    r"(?P<blocks>█+)|(?P<dots>[\u2801-\u28ff]+)|[^█\u2801-\u28ff\xa0]+(?:\xa0[^█\u2801-\u28ff\xa0]+)*"
)


def drawn(svg: str) -> str:
    """The picture with dots and blocks drawn and no font fetched: it looks the same wherever it is seen."""
    return _TEXT.sub(_shapes, _FONTS.sub("", svg))


def _shapes(line: re.Match[str]) -> str:
    """A piece of a line of the terminal: words where they begin, blocks and dots as shapes."""
    drawn_runs = []
    for run in _RUNS.finditer(unescape(line["text"])):
        x, width = float(line["x"]) + run.start() * _CELL_WIDTH, len(run[0]) * _CELL_WIDTH
        top = float(line["y"]) - _BASELINE
        if run["blocks"]:
            # A little higher than a cell, lest the background shine through between rows.
            size = f'width="{width:.1f}" height="{_CELL_HEIGHT + 0.6:.1f}"'
            drawn_runs.append(f'<rect x="{x:.1f}" y="{top:.1f}" {size}/>')
        elif run["dots"]:
            drawn_runs += [
                dot for k, cell in enumerate(run[0]) for dot in _dots(x + k * _CELL_WIDTH, top, cell)
            ]
        else:
            place = f'x="{x:.1f}" y="{line["y"]}" textLength="{width:.1f}"'
            drawn_runs.append(f"<text {place}{line['rest']}>{escape(run[0])}</text>")
    return f'<g class="{line["ink"]}">{"".join(drawn_runs)}</g>'


def _dots(x: float, top: float, cell: str) -> list[str]:
    bits = ord(cell) - BLANK
    return [
        f'<circle cx="{x + (0.25 + 0.5 * column) * _CELL_WIDTH:.1f}" '
        f'cy="{top + (0.125 + 0.25 * row) * _CELL_HEIGHT:.1f}" r="1.8"/>'
        for row in range(4)
        for column in range(2)
        if bits & int(BITS[row, column])
    ]


async def picture(log: Path, aircraft_file: Path | None, face: Face, after: int, theme: str) -> str:
    """One screen as SVG, with manoeuvre ``after + 1`` in the air, or at the end of the log."""
    aircraft = load_aircraft(aircraft_file)

    def load() -> Sequence[Columns]:
        return [columns for batch in open_log(log) for columns in batch]

    player = LogPlayer(log.name, load, inf)
    conductor = Conductor(player, lambda by_hand: Campaign(aircraft, settle=True, by_hand=by_hand))
    app = AdvisorApp(conductor, aircraft, log.name, Tempo(speed=inf), Settings(theme, face))
    async with app.run_test(size=SIZES[face]) as pilot:
        app.conductor.jump(after + 1)
        state = app.view.state
        while app.view.health.condition != "ended":
            await pilot.pause(0.02)
            state = app.view.state
            if len(state.maneuvers) >= after and state.flying and state.settling:
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
