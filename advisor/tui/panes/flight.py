"""Pane of the whole flight: channels, manoeuvres of both axes, flight modes, and a channel laid over the
plots.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from textual.app import ComposeResult
from textual.events import Resize
from textual.message import Message

from advisor.flight.signals.track import Course
from advisor.flight.vehicle.modes import stays
from advisor.process.arrays import FloatArray
from advisor.session.conducting import View
from advisor.tui.panes.last_verdict import symbol_and_word
from advisor.tui.panes.pane import Lines, Pane
from advisor.tui.plot.chart import Chart, Ink, Series
from advisor.tui.plot.painting import Plot
from advisor.words.quantities import CHANNELS, channel

SHOWN_WHOLE = ("elevator", "alpha", "q", "airspeed", "height")
"""Channels of pitch that have their own plots, from top to bottom."""
_SIDEWAYS = ("aileron", "rudder", "p", "r", "airspeed")
"""Channels of roll and yaw, which replace the channels of pitch while roll and yaw are shown."""
_INKS: dict[str, Ink] = {
    **dict.fromkeys(("elevator", "aileron", "rudder"), "input"), "height": "prior", "airspeed": "residual"
}  # fmt: skip
_ROWS_FOR_ONE = 4
_GUTTER = 7
"""Number of columns left of the plots, for the labels of their axes."""
_MODE = "modes"
_LEAST_S = 10.0
"""Shortest length of the time axis, s."""


class WholeFlightPane(Pane):
    """Pane with every channel over the present power-on. In a replay a click goes to the manoeuvre at the
    clicked time.
    """

    EITHER_AXIS = True
    TITLE = "i Flight"
    SHORT = "iFlt"
    HELP = """\
# Flight

The whole power-on over the vehicle's time: control, rates and air speed of the axis that is shown. The
line above the plots has the number of each manoeuvre with ✓, ✗ or ∅ at its time (R: roll and yaw). The
line below has the flight modes at their times. A bar stands from the lowest to the highest value of each
stretch, so that no step is lost.

**l** lays the next channel over every plot, and after the last channel none. The lower edge names the
channel, with the values at the foot and at the top of each plot.

In a replay, a click goes to the manoeuvre there, of either axis, or to the time where there is none. The
upright line is the present moment.
"""

    class Sought(Message):
        """A time of the flight was clicked, s since power-on."""

        def __init__(self, at_s: float) -> None:
            super().__init__()
            self.at_s = at_s

    _view: View | None = None
    _over: str | None = None
    """Channel that is laid over the plots."""

    def compose(self) -> ComposeResult:
        """Lay out the manoeuvres, one plot for each channel, and the modes."""
        yield Lines("no manoeuvre yet", id="whole-maneuvers")
        for name in SHOWN_WHOLE:
            empty = Chart(channel(name).label, "t [s]", why_empty="not received so far.")
            yield Plot(empty, id=f"whole-{name}")
        yield Lines(id="whole-modes")

    def show(self, view: View) -> None:
        """Draw the power-on again after new data have arrived or a manoeuvre is judged."""
        self._view = view
        if self.changed(view.state.whole_flight, view.state.maneuvers, view.state.lateral):
            self._draw(view)

    def _draw(self, view: View) -> None:
        whole = view.state.whole_flight
        ends = [(course.t[0], course.t[-1]) for course in whole.courses.values() if len(course.t)]
        if not ends:
            return
        low = min(first for first, _ in ends)
        high = max(low + _LEAST_S, *(last for _, last in ends))
        names = SHOWN_WHOLE if view.elevator is None else _SIDEWAYS
        places = zip(names, SHOWN_WHOLE, strict=True)
        plots = {name: self.query_one(f"#whole-{place}", Plot) for name, place in places}
        shown = [name for name in plots if plots[name].display and len(self._course(view, name).t)]
        layer = self._layer(view)
        for name in shown:
            last = name == shown[-1]
            chart = _chart(name, self._course(view, name), (low, high), view.state.now_s, foot=last)
            plots[name].chart = replace(chart, layer=layer)
        width = max(self.size.width - 2, 1)
        self.query_one("#whole-maneuvers", Lines).write(_maneuvers(view, low, high, width))
        bands = list(stays(whole.modes, low, high))
        self.query_one("#whole-modes", Lines).write(_modes(bands, low, high, width) if bands else "")

    def lay_over_next(self) -> None:
        """Lay the next channel over the plots; after the last channel, none."""
        if self._view is None:
            return
        heard = [name for name in CHANNELS if len(self._course(self._view, name).t)]
        later = heard[heard.index(self._over) + 1 :] if self._over in heard else heard
        self._over = next(iter(later), None)
        self._draw(self._view)

    def _layer(self, view: View) -> Series | None:
        """Return the curve of the channel that is laid over the plots, and name that channel in the lower
        edge.
        """
        if self._over is None or not len((course := self._course(view, self._over)).t):
            self.subtitle("l: lay a channel over")
            return None
        quantity = channel(self._over)
        t, y = _zigzag(course)
        ends = (f"{value * quantity.factor:.3g}" for value in (np.min(y), np.max(y)))
        self.subtitle(f"{' to '.join(ends)} {quantity.unit}: {quantity.symbol} laid over; l: next")
        return Series("", t, y, "fitted")

    def _course(self, view: View, name: str) -> Course:
        return view.state.whole_flight.courses.get(name, _NOTHING)

    def on_plot_pointed(self, event: Plot.Pointed) -> None:
        """Report the time at the position of the mouse."""
        event.stop()
        self.post_message(self.Sought(event.x))

    def on_resize(self, event: Resize) -> None:
        """Show as many channels as have room."""
        count = max(1, (self.size.height - 3) // _ROWS_FOR_ONE)
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
    """Return the times and values of a line through the lowest and highest values of each interval, shape
    (2n,) each.
    """
    return np.repeat(course.t, 2), np.column_stack([course.low, course.high]).ravel()


def _maneuvers(view: View, low: float, high: float, width: int) -> str:
    """Return a line with the numbers of this power-on's manoeuvres, each number at its manoeuvre's place on
    the time axis.
    """
    line = [" "] * width
    here = (view.state.flight, view.state.boot)
    axes = view.state.axes.items()
    flown = [("R" if name == "lateral" else "", j) for name, axis in axes for j in axis.maneuvers]
    for axis, judged in sorted(flown, key=lambda pair: pair[1].maneuver.span.start_s):
        if judged.maneuver.power_on != here:
            continue
        text = f"{axis}{judged.maneuver.number}{symbol_and_word(judged)[0]}"
        share = (judged.maneuver.span.start_s - low) / (high - low)
        at = _GUTTER + int(share * (width - _GUTTER - len(text)))
        if at >= _GUTTER and all(sign == " " for sign in line[at - 1 : at + len(text)]):
            line[at : at + len(text)] = text
    return "".join(line).rstrip()


def _modes(bands: Sequence[tuple[float, float, str]], low: float, high: float, width: int) -> str:
    """Return a line with the flight modes. Each mode begins at its start on the time axis and is cut where
    room ends.
    """
    line = [" "] * width
    line[: len(_MODE)] = _MODE
    for begin_s, end_s, name in bands:
        first, last = (_GUTTER + int((t - low) / (high - low) * (width - _GUTTER)) for t in (begin_s, end_s))
        text = f"│{name}"[: last - first].ljust(last - first)
        line[first:last] = text
    return "".join(line).rstrip()
