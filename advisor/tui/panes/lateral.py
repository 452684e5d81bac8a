"""Derivatives and modes of roll and yaw."""

from advisor.report.lateral import lateral_results
from advisor.session.view import View
from advisor.tui.panes.lines import Labelled
from advisor.tui.panes.pane import TextPane

_NONE_YET = "No manoeuvre of aileron or rudder is accepted yet."


class LateralPane(TextPane):
    """Joint estimate of roll and yaw with modes and levels, on either axis."""

    TITLE = "y Roll and yaw"
    SHORT = "yR&Y"
    EMPTY = _NONE_YET
    HELP = """\
# Roll and yaw

The joint estimate over the accepted manoeuvres of aileron and rudder. Each derivative stands with half its
95 % interval. One that is not identifiable stands with the input that would tell it. Below are the modes:
Dutch roll, roll and spiral, with the levels of MIL-F-8785C. Where the aircraft file states the derivatives,
the tests of 14 CFR Part 60 compare the two.
"""

    def show(self, view: View) -> None:
        """Write the results when another manoeuvre was judged."""
        lateral = view.state.lateral
        if lateral is None or not self.changed(lateral):
            return
        self.write(_rows(view))
        numbers = ", ".join(map(str, lateral.estimate_from))
        self.subtitle(f"from manoeuvres {numbers}" if numbers else "")


def _rows(view: View) -> list[Labelled]:
    lateral = view.state.lateral
    lines = list(lateral_results(lateral, view.aircraft)) if lateral is not None else []
    if not lines:
        return [("", _NONE_YET)]
    return [(" " * (len(line) - len(line.lstrip())), line.strip()) for line in lines]
