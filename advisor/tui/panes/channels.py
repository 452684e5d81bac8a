"""What arrives: the link, every channel, and where the angle of attack comes from."""

from textual.app import ComposeResult
from textual.containers import VerticalScroll

from advisor.tui.panes.crew_notes import alpha_in_words
from advisor.tui.panes.lines import Lines
from advisor.tui.panes.pane import Pane
from advisor.tui.panes.status_line import CONDITIONS
from advisor.tui.view import View


class Channels(Pane):
    """Alpha's provenance, the channels with rate and gaps, link statistics."""

    TITLE = "7 Channels and link"
    SHORT = "7 Chan"
    can_focus = False
    HELP = """\
# Channels and link

Where the angle of attack comes from - a *vane*, *derived* by the autopilot from speed and wind (blind to
gusts), or *simulated* - and every channel with its source, the rate at which it arrives and its longest
gap. Below: the link.
"""

    def compose(self) -> ComposeResult:
        """Text that scrolls."""
        with VerticalScroll():
            yield Lines(id="problems")
            yield Lines("Nothing has arrived yet.", id="arriving")

    def show(self, view: View) -> None:
        """Write the lists."""
        health = view.health
        lines = [f"α  {alpha_in_words(view)}", "", f"{'channel':<11}{'rate':>6}  {'gap':>7}  source"]
        for name, status in view.state.channels.items():
            rate, gap = f"{status.rate_hz:.0f} Hz", f"{status.largest_gap_s:.2f} s"
            lines.append(f"{name:<11}{rate:>6}  {gap:>7}  {status.source} ({status.provenance})")
        if not view.state.channels:
            lines.append("no channel yet: the vehicle has not sent what the advisor needs")
        lines += ["", f"{CONDITIONS[health.condition]}: {health.sentence}"]
        lines += [f"{name:<22}{value}" for name, value in health.figures]
        problems = self.query_one("#problems", Lines)
        problems.display = bool(view.obstacles)
        problems.write("\n".join(f"! {problem}" for problem in view.obstacles))
        self.query_one("#arriving", Lines).write("\n".join(lines))
