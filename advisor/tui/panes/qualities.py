"""Flying qualities of the joint estimate."""

from advisor.report.qualities import coefficients_of, qualities_of, quality_lines
from advisor.session.view import View
from advisor.tui.panes.lines import Labelled
from advisor.tui.panes.pane import TextPane

_NONE_YET = "No manoeuvre is accepted yet; flying qualities come from the joint estimate."


class Qualities(TextPane):
    """Natural frequency, damping, n/α, CAP, T_θ2 and level, each with its 95 % interval."""

    TITLE = "u Flying qualities"
    SHORT = "uFQ"
    EMPTY = _NONE_YET
    HELP = """\
# Flying qualities

From the joint estimate over the accepted manoeuvres: natural frequency and damping of the short period, T_θ2,
n/α and CAP, each with half its 95 % interval (delta method), and the levels of MIL-F-8785C. Static margin,
neutral point and coefficients need `reference` in the aircraft file. The air density and the speed that they
are given for stand below.
"""

    def show(self, view: View) -> None:
        """Write the flying qualities when the joint estimate is another one."""
        if not self.changed(view.state.model):
            return
        self.write(_rows(view))
        numbers = ", ".join(map(str, view.state.estimate_from))
        self.subtitle(f"from manoeuvres {numbers}" if numbers else "")


def _rows(view: View) -> list[Labelled]:
    reference = view.aircraft.reference
    found = qualities_of(view.state, reference)
    if found is None:
        return [("", _NONE_YET)]
    lines = quality_lines(found, coefficients_of(view.state, reference))
    return [(" " * (len(line) - len(line.lstrip())), line.strip()) for line in lines]
