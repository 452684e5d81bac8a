"""Reasons for the verdict on the selected manoeuvre."""

from advisor.campaign.state import JudgedManeuver
from advisor.decision.verdict import ManeuverVerdict
from advisor.oem.estimate import Estimate
from advisor.session.view import View
from advisor.tui.panes.hanging import Labelled
from advisor.tui.panes.last_verdict import symbol_and_word
from advisor.tui.panes.pane import TextPane
from advisor.tui.words import without_word
from advisor.words.digits import distinct_texts, signed
from advisor.words.quantities import channel
from advisor.words.vehicle_time import between


class VerdictPane(TextPane):
    """Sentence, reasons with numbers and limits, quality of the fit, cautions."""

    TITLE = "2 Verdict"
    SHORT = "2Ver"
    EITHER_AXIS = True
    OF_SELECTED = True
    HELP = """\
# Verdict

The selected manoeuvre: the sentence the pilot saw, when it was flown, and each reason with its number and
limit. Then the cost J (det R of Eq. 7) with the limits of the paper's rules, and how well the model
explains each output (R², Theil's coefficient TIC, lag-1 correlation of the residual: 0 is white). A line
with **!** does not reject the manoeuvre but belongs on its verdict.
"""

    def show(self, view: View) -> None:
        """Write the selected manoeuvre's verdict."""
        if view.judged is not None:
            flight = view.judged.maneuver.flight
            of = next(
                (f" of {one.name}" for one in view.state.flights if one.flight == flight and one.name), ""
            )
            self.write(_rows(view.judged, of))


def _rows(judged: JudgedManeuver, of: str) -> list[Labelled]:
    verdict, estimate, span = judged.verdict, judged.estimate, judged.maneuver.span
    symbol, word = symbol_and_word(judged)
    rows = [
        (f"{symbol} ", f"{word}  manoeuvre {judged.maneuver.number}{of}: {without_word(verdict.sentence)}"),
        (
            "  ",
            f"flown {between(span.start_s, span.end_s)} since power-on, mode {judged.maneuver.mode or '-'}",
        ),
    ]
    if judged.excluded_because:
        rows.append(("  ", f"excluded by hand: {judged.excluded_because}"))
    for r in verdict.reasons:
        value, limit = distinct_texts(r.value, r.limit, 3, "g")
        rows.append(("  ", f"{r.code.replace('_', ' ')}: {value} (limit {limit})  {r.text}"))
    if isinstance(estimate, Estimate):
        rows.append(("  ", f"cost J {estimate.cost:.3g}{_limits(verdict)}"))
        for name, fit in estimate.fits[0].items():
            q = channel(name)
            rms = f"{fit.rms * q.factor:.2g} {q.unit}"
            explained = f"R² {fit.r2:.3f}, TIC {fit.tic:.3f}, rms {rms}, lag-1 {signed(fit.lag1, 2)}"
            rows.append(("  ", f"{q.symbol}: {explained}"))
    else:
        rows.append(("", f"no estimate: {estimate.text}"))
    notes = estimate.notes if isinstance(estimate, Estimate) else ()
    rows += [("! ", caution) for caution in dict.fromkeys((*notes, *verdict.cautions))]
    return rows + [("note: ", note) for note in judged.notes]


def _limits(verdict: ManeuverVerdict) -> str:
    """Return the limits of the cost, rule by rule."""
    limits = [f"{rule} {one.limit:.3g}" for rule, one in verdict.rules.items() if one.limit is not None]
    return f" (limit {', '.join(limits)})" if limits else ""
