"""Bar with the position of a replay; hidden on a live link."""

from math import isinf

from textual.events import Click
from textual.message import Message

from advisor.session.source import Playback
from advisor.session.view import View
from advisor.tui.panes.lines import Lines, Part
from advisor.words.vehicle_time import clock

_WIDTH = 24


class ReplayBar(Part, Lines):
    """State of the replay, its speed, its position in the log, and the vehicle's time there. A click on the
    bar moves the replay to that position."""

    class Sought(Message):
        """A position on the bar was clicked."""

        def __init__(self, position_s: float) -> None:
            super().__init__()
            self.position_s = position_s

    _begins = 0
    """Column at which the bar begins."""
    _duration_s = 0.0

    def show(self, view: View) -> None:
        """Write the line if the source is a replay."""
        tempo, playback = view.tempo, view.playback or Playback(0.0, 0.0)
        self.set_class(tempo is not None, "-playing")
        if tempo is None:
            return
        speed = "max" if isinf(tempo.speed) else f"{tempo.speed:g} ×"
        share = playback.position_s / playback.duration_s if playback.duration_s else 0.0
        place = "━" * round(share * _WIDTH) + "─" * (_WIDTH - round(share * _WIDTH))
        over = 0.0 < playback.duration_s <= playback.position_s
        state = "❚❚ paused" if tempo.paused else "■ at the end" if over else "► replay"
        jump = "  ►► jumping" if playback.hurrying else ""
        before = f"{state}  {speed}  "
        self._begins, self._duration_s = len(before), playback.duration_s
        self.write(f"{before}{place}  {100.0 * share:3.0f} %  at {_now(view)}{jump}")

    def on_click(self, event: Click) -> None:
        column = event.x - self.styles.padding.left - self._begins
        if 0 <= column < _WIDTH:
            self.post_message(self.Sought(column / _WIDTH * self._duration_s))


def _now(view: View) -> str:
    """Return the vehicle's time. The flight's and the power-on's numbers follow if there are several."""
    state = view.state
    flight = f"flight {state.flight + 1}, " if state.flight else ""
    power_on = f"power-on {state.boot + 1}, " if state.boot else ""
    return f"{flight}{power_on}{clock(state.now_s)}"
