"""The whole flight: elevator, angle of attack, pitch rate, air speed, height, manoeuvres and modes."""

import numpy as np
from textual.app import ComposeResult
from textual.events import Resize
from textual.message import Message

from advisor.flight.signals.messages import FloatArray
from advisor.flight.signals.power_on import Course
from advisor.flight.signals.track import SHOWN_WHOLE
from advisor.session.view import View
from advisor.tui.panes.last_verdict import symbol_and_word
from advisor.tui.panes.lines import Lines
from advisor.tui.panes.pane import Pane
from advisor.tui.plot.chart import Chart, Ink, Series
from advisor.tui.plot.widget import Plot
from advisor.words.quantities import channel
from advisor.words.vehicle_time import clock

_INKS: dict[str, Ink] = {"elevator": "input", "height": "prior", "airspeed": "residual"}
_ROWS_FOR_ONE = 4
_GUTTER = 7
"""Columns left of the plots, for the labels of their axes."""
_LEAST_S = 10.0
"""Shortest time axis, s."""


class WholeFlightPane(Pane):
    """Every channel over the present power-on; a click jumps to the manoeuvre there."""

    TITLE = "i Flight"
    SHORT = "iFlt"
    HELP = """\
# Flight

The whole power-on: elevator, angle of attack, pitch rate, air speed and height over the vehicle's time. The
line above the plots has the number of each manoeuvre with ✓, ✗ or ∅ at its time; the line below has the
modes. A bar stands from the lowest to the highest value of each stretch, so that no step is lost.

In a replay, a click jumps to the manoeuvre there. The upright line is the present moment.
"""

    class Sought(Message):
        """A time of the flight was pointed at, s since power-on."""

        def __init__(self, at_s: float) -> None:
            super().__init__()
            self.at_s = at_s

    _view: View | None = None

    def compose(self) -> ComposeResult:
        """Lay out the manoeuvres, one plot for each channel, and the modes."""
        yield Lines("no manoeuvre yet", id="whole-maneuvers")
        for name in SHOWN_WHOLE:
            empty = Chart(channel(name).label, "t [s]", why_empty="not received so far.")
            yield Plot(empty, id=f"whole-{name}")
        yield Lines(id="whole-modes")

    def show(self, view: View) -> None:
        """Draw the power-on anew when its picture is renewed, or a manoeuvre is judged."""
        self._view = view
        if self.changed(view.state.whole_flight, view.state.maneuvers):
            self._draw(view)

    def _draw(self, view: View) -> None:
        whole = view.state.whole_flight
        ends = [(course.t[0], course.t[-1]) for course in whole.courses.values() if len(course.t)]
        if not ends:
            return
        low = min(first for first, _ in ends)
        high = max(low + _LEAST_S, *(last for _, last in ends))
        shown = [name for name in SHOWN_WHOLE if len(self._course(view, name).t)]
        for name in shown:
            last = name == shown[-1]
            chart = _chart(name, self._course(view, name), (low, high), view.state.now_s, foot=last)
            self.query_one(f"#whole-{name}", Plot).chart = chart
        width = max(self.size.width - 2, 1)
        self.query_one("#whole-maneuvers", Lines).write(_maneuvers(view, low, high, width))
        modes = "   ".join(f"{clock(at_s)} {mode}" for at_s, mode in whole.modes)
        self.query_one("#whole-modes", Lines).write(modes and f"modes  {modes}")

    def _course(self, view: View, name: str) -> Course:
        return view.state.whole_flight.courses.get(name, _NOTHING)

    def on_plot_pointed(self, event: Plot.Pointed) -> None:
        """Tell the time that is pointed at."""
        event.stop()
        self.post_message(self.Sought(event.x))

    def on_resize(self, event: Resize) -> None:
        """Show as many channels as have room."""
        count = max(1, (event.size.height - 3) // _ROWS_FOR_ONE)
        for k, name in enumerate(SHOWN_WHOLE):
            self.query_one(f"#whole-{name}").display = k < count
        if self._view is not None:
            self._draw(self._view)


_NOTHING = Course(np.empty(0), np.empty(0), np.empty(0))


def _chart(name: str, course: Course, ends: tuple[float, float], now_s: float, *, foot: bool) -> Chart:
    quantity = channel(name)
    t, y = _zigzag(course)
    series = Series("", t, y * quantity.factor, _INKS.get(name, "measured"))
    return Chart(
        quantity.label, "t [s]", series=(series,), x_range=ends, cursor=now_s, foot=foot, gutter=_GUTTER
    )


def _zigzag(course: Course) -> tuple[FloatArray, FloatArray]:
    """Return a line through the lowest and the highest value of each stretch; shape (2n,) each."""
    return np.repeat(course.t, 2), np.column_stack([course.low, course.high]).ravel()


def _maneuvers(view: View, low: float, high: float, width: int) -> str:
    """Return the numbers of the manoeuvres of this power-on, each at its place on the time axis."""
    line = [" "] * width
    here = (view.state.flight, view.state.boot)
    for judged in view.state.maneuvers:
        if judged.maneuver.power_on != here:
            continue
        text = f"{judged.maneuver.number}{symbol_and_word(judged)[0]}"
        share = (judged.maneuver.span.start_s - low) / (high - low)
        at = _GUTTER + int(share * (width - _GUTTER - len(text)))
        if at >= _GUTTER and all(sign == " " for sign in line[at - 1 : at + len(text)]):
            line[at : at + len(text)] = text
    return "".join(line).rstrip()
