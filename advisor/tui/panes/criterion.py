"""The stop criterion after each manoeuvre, under every rule."""

import numpy as np
from textual.app import ComposeResult

from advisor.decision.verdict import FlightTestVerdict
from advisor.session.view import View
from advisor.tui.panes.hanging import Labelled
from advisor.tui.panes.pane import TextPane
from advisor.tui.plot.chart import Chart, Ink, Level, Series
from advisor.tui.plot.widget import Plot
from advisor.words.digits import distinct_texts

RULE_INKS: dict[str, Ink] = {"continuous": "measured", "separate": "residual", "information": "input"}

_Y, _X = "[% of limit]", "manoeuvre"


class Criterion(TextPane):
    """One curve for each rule against the limit, and each rule's decision."""

    TITLE = "6 Criterion"
    SHORT = "6Cri"
    EITHER_AXIS = True
    HELP = """\
# Criterion

The stop criterion after each manoeuvre for the three rules side by side, each as a share of its own limit, on
a logarithmic axis: the test may stop below the dashed line, at 100 %. The rule that decides is marked **►**;
the other rules are always shown as well.

The rule information stops when the 95 % band of the predicted response, each named derivative and the
prediction of the newest manoeuvre are within their tolerances; the lines above the curves tell how far.
"""

    def compose(self) -> ComposeResult:
        """Lay out the rules' lines over the curves."""
        yield from super().compose()
        yield Plot(_chart(None))

    def show(self, view: View) -> None:
        """Draw the histories when the verdict changed."""
        verdict = view.state.flight_test
        if not self.changed(verdict):
            return
        self.query_one(Plot).chart = _chart(verdict)
        self.write(_rows(verdict))


def _rows(verdict: FlightTestVerdict) -> list[Labelled]:
    rows: list[Labelled] = []
    for rule, progress in verdict.by_rule.items():
        known = [value for value in progress.history_percent if value is not None]
        limit = progress.limit_percent
        now, most = distinct_texts(known[-1], limit) if known else ("", f"{limit:.0f}")
        so_far = f"{now} %" if known else "too few"
        says = f"stop since {progress.stopped_at}" if progress.stopped_at else "continue"
        mark = "►" if rule == verdict.rule else " "
        rows.append((f"{mark} ", f"{rule:<12} {so_far:>8}  (limit {most:>3} %)  {says}"))
    rows += [("  ", line) for line in verdict.evidence]
    return rows + [("! ", warning) for warning in verdict.warnings]


def _chart(verdict: FlightTestVerdict | None) -> Chart:
    series = []
    for rule, progress in verdict.by_rule.items() if verdict else ():
        history = np.array([np.nan if v is None else v for v in progress.history_percent], dtype=np.float64)
        if np.isfinite(history).any():
            numbers = np.arange(1.0, len(history) + 1.0)
            share = history / progress.limit_percent * 100.0
            ink = RULE_INKS.get(rule, "prior")
            series.append(Series(rule, numbers, share, ink, "joined"))
    if verdict is None or not series:
        return Chart(_Y, _X, why_empty="too few accepted manoeuvres for any rule yet.")
    return Chart(_Y, _X, series=tuple(series), levels=(Level("limit", 100.0),), whole_x=True, log_y=True)
