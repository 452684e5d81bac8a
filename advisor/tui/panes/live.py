"""Pane of the manoeuvre in flight: its curves and the information that arrives."""

from math import floor

from textual.app import ComposeResult
from textual.events import Resize

from advisor.decision.arriving import WITHIN_PERCENT, Arriving
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.session.conducting import View
from advisor.tui.panes.pane import Lines, Pane
from advisor.tui.panes.pilot import bar, flying_in_words
from advisor.tui.plot.chart import Chart, Ink, Series
from advisor.tui.plot.painting import Plot
from advisor.words.quantities import channel, symbol

TRACES: dict[str, Ink] = {"alpha": "measured", "q": "measured", "elevator": "input"}
_ROWS_FOR_ONE = 5
_BAR = 10


class Live(Pane):
    """Pane with angle of attack, pitch rate and elevator of the manoeuvre in flight."""

    OF_ELEVATOR = True
    TITLE = "5 Live"
    SHORT = "5Liv"
    HELP = """\
# Live

The samples of the manoeuvre in the air, as they come in. After the input the pane says how long to
hold the stick still, and when to recover. A bar for each derivative shows the information of the
input in the air, with that of the manoeuvres before. All bars full: ENOUGH, let go. Between manoeuvres
nothing moves here; the last trace stays.
"""

    def compose(self) -> ComposeResult:
        """Yield a line of numbers above three plots."""
        yield Lines(
            "No manoeuvre is being flown; the curves begin with the first step of the elevator.",
            id="progress",
        )
        yield Lines("", id="arrived")
        for name in TRACES:
            empty = Chart(channel(name).label, "t [s]", why_empty="nothing is being flown.")
            yield Plot(empty, id=f"live-{name}")

    def show(self, view: View) -> None:
        """Draw the manoeuvre in flight. Between manoeuvres the last curves remain."""
        flying = view.state.flying
        if flying is None or view.health.condition == "ended":
            if self.border_subtitle:
                self.query_one("#progress", Lines).write("No manoeuvre is being flown; the last curves stay.")
            self.subtitle("")
            self._write_arrived([])
            return
        self.subtitle(f"in the air: manoeuvre {flying.number}")
        self.query_one("#progress", Lines).write(flying_in_words(view))
        self._write_arrived(arrived_in_words(view.state.arriving))
        for name, ink in TRACES.items():
            self.query_one(f"#live-{name}", Plot).chart = _trace(flying, name, ink)

    def _write_arrived(self, lines: list[str]) -> None:
        """Write the bars of the arriving information, or hide their lines."""
        bars = self.query_one("#arrived", Lines)
        if bars.display != bool(lines):
            bars.display = bool(lines)
        bars.write("\n".join(lines))

    def on_resize(self, event: Resize) -> None:
        """Show as many plots as have room."""
        count = max(1, (event.size.height - 2) // _ROWS_FOR_ONE)
        for k, name in enumerate(TRACES):
            self.query_one(f"#live-{name}").display = k < count


def _trace(flying: Maneuver, name: str, ink: Ink) -> Chart:
    quantity, start_s = channel(name), flying.span.start_s
    samples = flying.channels.get(name)
    if samples is None or len(samples) == 0:
        return Chart(quantity.label, "t [s]", why_empty="no samples in this manoeuvre so far.")
    measured = Series("measured", samples.t - start_s, samples.y * quantity.factor, ink, "points")
    return Chart(quantity.label, "t [s]", series=(measured,))


def arrived_in_words(arrived: Arriving | None) -> list[str]:
    """Return a line that says whether the data are enough, and lines of two bars each. A bar shows one
    parameter's error; without errors the list is empty.
    """
    if arrived is None or not arrived.percent:
        return []
    word = "ENOUGH: let go" if arrived.is_enough else "not yet enough; errors in % of the tolerance"
    cells = [
        f"{symbol(name):>5} {bar(_full(percent), _BAR)} {percent:4.0f}"
        for name, percent in arrived.percent.items()
    ]
    return [word, *("  ".join(cells[k : k + 2]) for k in range(0, len(cells), 2))]


def _full(percent: float) -> float:
    """Return the filled fraction of a bar in whole cells. The bar is full only if the error is within the
    tolerance.
    """
    return floor(_BAR * WITHIN_PERCENT / max(percent, 1.0)) / _BAR
