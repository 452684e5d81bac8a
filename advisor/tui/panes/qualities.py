"""Pane of the flying qualities of the axis that is shown."""

from collections.abc import Iterable

from advisor.report.axes.lateral_document import side_quality_lines
from advisor.report.qualities import coefficients_of, qualities_of, quality_lines
from advisor.session.view import View
from advisor.tui.panes.pane import TextPane
from advisor.words.digits import maneuvers_said


class Qualities(TextPane):
    """Flying qualities of the joint estimate and their levels, each with its 95 % interval."""

    EITHER_AXIS = True
    TITLE = "u Flying qualities"
    SHORT = "uFQ"
    EMPTY = "No manoeuvre is accepted yet; flying qualities come from the joint estimate."
    HELP = """\
# Flying qualities

From the joint estimate over the accepted manoeuvres of the axis that is shown, each with half its 95 %
interval (delta method), and the levels of MIL-F-8785C.

Pitch: natural frequency and damping of the short period, T_θ2, n/α and CAP. Static margin, neutral point
and coefficients need `reference` in the aircraft file. The air density and the speed that they are given
for stand below.

Roll and yaw: Dutch roll, roll and spiral. Where the aircraft file states the derivatives, the tests of
14 CFR Part 60 compare the two.
"""

    def show(self, view: View) -> None:
        """Write the flying qualities after the joint estimate has changed."""
        if not self.changed(view.state.model, view.elevator and view.state.lateral):
            return
        lines = [(" " * (len(line) - len(line.lstrip())), line.strip()) for line in _lines(view)]
        self.write(lines or [("", self.EMPTY)])
        estimated = view.state.estimate_from
        self.subtitle(f"from {maneuvers_said(estimated)}" if estimated else "")


def _lines(view: View) -> Iterable[str]:
    """Return the lines of the axis that is shown; none without a joint estimate."""
    side, reference = view.state.lateral, view.aircraft.reference
    if view.elevator is not None and side is not None:
        return side_quality_lines(side, view.aircraft)
    qualities = qualities_of(view.state, reference)
    return () if qualities is None else quality_lines(qualities, coefficients_of(view.state, reference))
