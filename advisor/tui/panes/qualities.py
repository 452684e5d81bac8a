"""Joint estimates as lines: flying qualities of the short period; derivatives and modes of roll and yaw."""

from collections.abc import Iterable

from advisor.report.lateral import lateral_results
from advisor.report.qualities import coefficients_of, qualities_of, quality_lines
from advisor.session.view import View
from advisor.tui.panes.lines import Labelled
from advisor.tui.panes.pane import TextPane


class _Joint(TextPane):
    """Lines on the joint estimate of an axis."""

    def write_lines(self, lines: Iterable[str], numbers: Iterable[int]) -> None:
        """Write indented lines, and the numbers of the manoeuvres that they are from; without lines, why."""
        rows: list[Labelled] = [(" " * (len(line) - len(line.lstrip())), line.strip()) for line in lines]
        self.write(rows or [("", self.EMPTY)])
        listed = ", ".join(map(str, numbers))
        self.subtitle(f"from manoeuvres {listed}" if listed else "")


class Qualities(_Joint):
    """Natural frequency, damping, n/α, CAP, T_θ2 and level, each with its 95 % interval."""

    OF_ELEVATOR = True
    TITLE = "u Flying qualities"
    SHORT = "uFQ"
    EMPTY = "No manoeuvre is accepted yet; flying qualities come from the joint estimate."
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
        reference = view.aircraft.reference
        found = qualities_of(view.state, reference)
        lines = quality_lines(found, coefficients_of(view.state, reference)) if found is not None else ()
        self.write_lines(lines, view.state.estimate_from)


class LateralPane(_Joint):
    """Joint estimate of roll and yaw with modes and levels, on either axis."""

    TITLE = "y Roll and yaw"
    SHORT = "yR&Y"
    EMPTY = "No manoeuvre of aileron or rudder is accepted yet."
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
        self.write_lines(lateral_results(lateral, view.aircraft), lateral.estimate_from)
