"""Where a replay stands; not shown on a live link."""

from math import isinf

from advisor.tui.panes.lines import Lines
from advisor.tui.panes.part import Part
from advisor.tui.source import Playback
from advisor.tui.view import View
from advisor.tui.words import clock

_WIDTH = 24


class ReplayBar(Part, Lines):
    """Playing or paused, speed, and the place in the log."""

    def show(self, view: View) -> None:
        """Write the line when the source is a replay."""
        tempo, playback = view.tempo, view.playback or Playback(0.0, 0.0)
        self.set_class(tempo is not None, "-playing")
        if tempo is None:
            return
        speed = "max" if isinf(tempo.speed) else f"{tempo.speed:g} ×"
        share = playback.position_s / playback.duration_s if playback.duration_s else 0.0
        place = "━" * round(share * _WIDTH) + "─" * (_WIDTH - round(share * _WIDTH))
        over = 0.0 < playback.duration_s <= playback.position_s
        state = "❚❚ paused" if tempo.paused else "■ at the end" if over else "► replay"
        times = f"{clock(playback.position_s)} of {clock(playback.duration_s)}"
        jump = "  ►► jumping" if playback.hurrying else ""
        self.write(f"{state}  {speed}  {place}  {times}{jump}")
