"""The stop criterion after each manoeuvre, for every stopping rule."""

import numpy as np
from textual.app import ComposeResult

from advisor.decision.verdict import FlightTestVerdict
from advisor.session.view import View
from advisor.tui.panes.lines import Labelled
from advisor.tui.panes.pane import TextPane
from advisor.tui.plot.chart import Chart, Ink, Level, Series
from advisor.tui.plot.widget import Plot
from advisor.words.digits import distinct_texts

RULE_INKS: dict[str, Ink] = {"continuous": "measured", "separate": "residual", "information": "input"}

_Y, _X = "[% of limit]", "manoeuvre"


_MULTIPLE_PERCENT = 1000.0
"""Least criterion, % of its limit, that is written as a multiple of the limit: ten times."""


class Criterion(TextPane):
    """Criterion of each stopping rule against its limit, and each rule's decision."""

    TITLE = "6 Criterion"
    SHORT = "6Cri"
    EITHER_AXIS = True
    HELP = """\
# Criterion

The stop criterion after each manoeuvre for the three rules, as it was told at that time. Each rule is in per
cent of its own limit, as a line and as a curve on a logarithmic axis: the test may stop below the dashed
line, at 100 %. The rule that decides is marked **►**; the other rules are always shown as well.

Where later estimates give another criterion, a line below the rule says so.

The rule information stops when the 95 % band of the predicted response, each named derivative and the
prediction of the newest manoeuvre are within their tolerances; the lines above the curves tell how far.
"""

    def compose(self) -> ComposeResult:
        """Lay out one line for each rule above the curves."""
        yield from super().compose()
        yield Plot(_chart(None))

    def show(self, view: View) -> None:
        """Draw the histories of the criteria after the verdict has changed."""
        verdict = view.state.flight_test
        if not self.changed(verdict):
            return
        self.query_one(Plot).chart = _chart(verdict)
        self.write(_rows(verdict))


def share_of_limit(percent: float) -> str:
    """Return a criterion relative to its limit, in per cent. A criterion of at least ten times its limit is a
    multiple.
    """
    if percent >= _MULTIPLE_PERCENT:
        return f"{0.01 * percent:.0f} times its limit"
    return f"{distinct_texts(percent, 100.0)[0]} % of its limit"


def _rows(verdict: FlightTestVerdict) -> list[Labelled]:
    rows: list[Labelled] = []
    for rule, progress in verdict.by_rule.items():
        now = progress.now_percent_of_limit
        so_far = f"{'too few manoeuvres' if now is None else share_of_limit(now):>21}"
        says = f"stop since {progress.stopped_at}" if progress.stopped_at else "continue"
        mark = "►" if rule == verdict.rule else " "
        rows.append((f"{mark} ", f"{rule:<12}{so_far}  {says}"))
        if progress.hindsight:
            rows.append(("  ", f"{'':<12}{progress.hindsight}"))
    rows += [("  ", line) for line in verdict.evidence]
    return rows + [("! ", warning) for warning in verdict.warnings]


def _chart(verdict: FlightTestVerdict | None) -> Chart:
    series = []
    rules = verdict.by_rule.items() if verdict else ()
    for rule, progress in sorted(rules, key=lambda item: verdict is None or item[0] != verdict.rule):
        share = np.array([np.nan if v is None else v for v in progress.percent_of_limit], dtype=np.float64)
        if np.isfinite(share).any():
            numbers = np.arange(1.0, len(share) + 1.0)
            ink = RULE_INKS.get(rule, "prior")
            series.append(Series(rule, numbers, share, ink, "joined"))
    if verdict is None or not series:
        return Chart(_Y, _X, why_empty="too few accepted manoeuvres for any rule yet.")
    return Chart(_Y, _X, series=tuple(series), levels=(Level("limit", 100.0),), whole_x=True, log_y=True)
