"""Where a replay stands; not shown on a live link."""

from math import isinf

from advisor.tui.panes.lines import Lines
from advisor.tui.panes.part import Part
from advisor.tui.view import View
from advisor.tui.words import clock

_WIDTH = 24


class ReplayBar(Part, Lines):
    """Playing or paused, speed, and the place in the log."""

    def show(self, view: View) -> None:
        """Write the line when the source is a replay."""
        playback = view.playback
        self.set_class(playback is not None, "-playing")
        if playback is None:
            return
        speed = "max" if isinf(playback.speed) else f"{playback.speed:g} ×"
        share = playback.position_s / playback.duration_s if playback.duration_s else 0.0
        place = "━" * round(share * _WIDTH) + "─" * (_WIDTH - round(share * _WIDTH))
        state = "❚❚ paused" if playback.paused else "► replay"
        times = f"{clock(playback.position_s)} of {clock(playback.duration_s)}"
        self.write(f"{state}  {speed}  {place}  {times}")
