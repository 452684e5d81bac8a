"""Panes of the arriving data and of the event log."""

from textual.app import ComposeResult
from textual.containers import VerticalScroll

from advisor.session.conducting import View
from advisor.tui.panes.pane import HangingLines, Labelled, Lines, Pane, TextPane
from advisor.tui.screens.face import CONDITIONS
from advisor.words.quantities import clock


def alpha_in_words(view: View) -> str:
    """Return the source of the angle of attack in one line."""
    alpha = view.state.channels.get("alpha")
    if alpha is None:
        return "no angle of attack received yet"
    return f"{alpha.provenance}, from {alpha.source}, {alpha.rate_hz:.0f} Hz"


class Channels(Pane):
    """Source of the angle of attack, rates and gaps of the channels, and link statistics."""

    TITLE = "7 Channels and link"
    SHORT = "7Cha"
    can_focus = False
    HELP = """\
# Channels and link

The source of the angle of attack: a *vane*, *derived* by the autopilot from speed and wind (blind to
gusts), or *simulated*. Then every channel with its source, its rate and its longest gap. Below: the link.
"""

    def compose(self) -> ComposeResult:
        """Yield the text in a scrolling container."""
        with VerticalScroll():
            yield Lines(id="problems")
            yield HangingLines("Nothing has arrived yet.", id="arriving")

    def show(self, view: View) -> None:
        """Write the lists of channels and link statistics."""
        health = view.health
        rows: list[Labelled] = [
            ("α  ", alpha_in_words(view)),
            ("", f"vehicle time {clock(view.state.now_s)}"),
        ]
        rows += [("", ""), (f"{'channel':<11}{'Hz':>4} {'gap s':>6}  ", "source")]
        for name, status in view.state.channels.items():
            label = f"{name:<11}{status.rate_hz:>4.0f} {status.largest_gap_s:>6.2f}  "
            rows.append((label, f"{status.source} ({status.provenance})"))
        if not view.state.channels:
            rows.append(("", "no channel yet: the vehicle has not sent what the advisor needs"))
        rows += [("", ""), ("", f"{CONDITIONS[health.condition]}: {health.sentence}")]
        rows += [(f"{name:<22}", value) for name, value in health.figures]
        problems = self.query_one("#problems", Lines)
        corrected = [f"{f.sentence}. {f.fix}." for f in view.state.instruments if f.contradicts and f.used]
        said = [f"! {sentence}" for sentence in (*view.obstacles, *corrected)]
        problems.display = bool(said)
        problems.write("\n".join(said))
        self.query_one("#arriving", HangingLines).write_rows(rows)


_SHOWN = 200
_TIME = 9
"""Number of characters before a sentence, for the sentence's time and two blanks."""


class EventLogPane(TextPane):
    """Pane with the newest sentences of the event log, the last sentence at the bottom."""

    TITLE = "8 Log"
    SHORT = "8Log"
    EMPTY = "Nothing has happened yet."
    HELP = """\
# Log

Verdicts, marks, notes, changes by hand, what the vehicle said in words (STATUSTEXT, with its severity, and
its sender where that is not the vehicle) and what the link reported, newest at the bottom. **m** adds a mark
at this moment.

Times are minutes:seconds since power-on, as in the table of manoeuvres and in the replay bar. They
begin anew where a line says that another power-on, flight or vehicle begins.
"""

    def on_mount(self) -> None:
        """Keep the newest sentence visible."""
        self.query_one(VerticalScroll).anchor()

    def show(self, view: View) -> None:
        if view.log and self.changed(view.log):
            self.write((line[:_TIME], line[_TIME:]) for line in view.log[-_SHOWN:])
