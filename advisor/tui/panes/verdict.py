"""Why the selected manoeuvre was judged as it was."""

from textual.app import ComposeResult
from textual.containers import VerticalScroll

from advisor.campaign.state import JudgedManeuver
from advisor.oem.estimate import Estimate
from advisor.report.digits import signed
from advisor.rounding import distinct_texts
from advisor.tui.panes.last_verdict import symbol_and_word
from advisor.tui.panes.lines import Lines
from advisor.tui.panes.pane import Pane
from advisor.tui.view import View
from advisor.tui.words import channel, without_word


class Verdict(Pane):
    """Sentence, reasons with number beside limit, quality of the fit, cautions."""

    TITLE = "2 Verdict"
    SHORT = "2 Verd"
    OF_SELECTED = True
    can_focus = False
    HELP = """\
# Verdict

The selected manoeuvre: the sentence the pilot saw, each reason with its number beside the limit, and how
well the model explains each output (R², Theil's coefficient TIC, lag-1 correlation of the residual: 0 is
white). A line with **!** does not reject the manoeuvre but belongs on its verdict.
"""

    def compose(self) -> ComposeResult:
        """Text that scrolls when there is much to say."""
        with VerticalScroll():
            yield Lines("No manoeuvre has ended yet.")

    def show(self, view: View) -> None:
        """Write the selected manoeuvre's verdict."""
        if view.judged is not None:
            flight = view.judged.maneuver.flight
            of = next(
                (f" of {one.name}" for one in view.state.flights if one.flight == flight and one.name), ""
            )
            self.query_one(Lines).write("\n".join(_lines(view.judged, of)))


def _lines(judged: JudgedManeuver, of: str) -> list[str]:
    verdict, estimate = judged.verdict, judged.estimate
    symbol, word = symbol_and_word(judged)
    lines = [f"{symbol} {word}  manoeuvre {judged.maneuver.number}{of}: {without_word(verdict.sentence)}"]
    if judged.excluded_because:
        lines.append(f"excluded by hand: {judged.excluded_because}")
    for r in verdict.reasons:
        value, limit = distinct_texts(r.value, r.limit, 3, "g")
        lines.append(f"  {r.code}: {value} (limit {limit})  {r.text}")
    if isinstance(estimate, Estimate):
        for name, fit in estimate.fits[0].items():
            q = channel(name)
            rms = f"{fit.rms * q.factor:.2g} {q.unit}"
            lines.append(
                f"  {q.symbol}: R² {fit.r2:.3f}, TIC {fit.tic:.3f}, rms {rms}, lag-1 {signed(fit.lag1, 2)}"
            )
    else:
        lines.append(f"no estimate: {estimate.text}")
    notes = estimate.notes if isinstance(estimate, Estimate) else ()
    lines += [f"! {caution}" for caution in dict.fromkeys((*notes, *verdict.cautions))]
    return lines + [f"note: {note}" for note in judged.notes]
