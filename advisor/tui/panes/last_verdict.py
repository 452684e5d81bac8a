"""Panes of the verdicts: the newest manoeuvre's word and sentence, and the reasons for the selected
manoeuvre's verdict.
"""

from textual.app import ComposeResult
from textual.containers import Vertical

from advisor.campaign.state import JudgedManeuver
from advisor.decision.verdict import NO_TEST, ManeuverVerdict
from advisor.oem.estimate import Estimate
from advisor.session.conducting import View
from advisor.tui.advice import without_word
from advisor.tui.block_letters import HEIGHT, block_letters
from advisor.tui.panes.pane import Labelled, Lines, Part, TextPane
from advisor.words.quantities import channel, distinct_texts, signed, stretch


def symbol_and_word(judged: JudgedManeuver) -> tuple[str, str]:
    """Return the symbol and the word of a verdict. Both are readable without colour."""
    if judged.excluded_because is not None:
        return "∅", "EXCLUDED"
    return ("✓", "ACCEPTED") if judged.verdict.accepted else ("✗", "REJECTED")


def for_the_pilot(judged: JudgedManeuver, test_is_complete: bool) -> tuple[str, str, str]:
    """Return symbol, word and sentence of the newest verdict.

    A rejected manoeuvre says REPEAT while the test goes on, and NOT USED after the end of the test.
    """
    symbol, word = symbol_and_word(judged)
    sentence = without_word(judged.verdict.sentence)
    if judged.excluded_because is not None:
        return symbol, word, judged.excluded_because
    if judged.verdict.accepted:
        return symbol, "GOOD", sentence
    if judged.verdict.sentence.startswith(NO_TEST):
        return symbol, NO_TEST, sentence.partition("; ")[0]
    if test_is_complete:
        return symbol, "NOT USED", sentence.partition("; ")[0]
    return symbol, "REPEAT", sentence


_NONE_YET = "no manoeuvre yet", "The verdict appears here a few seconds after a manoeuvre ends."


class LastVerdict(Part, Vertical):
    """The newest manoeuvre's verdict."""

    EITHER_AXIS = True

    def compose(self) -> ComposeResult:
        """Yield the word, a line that names the manoeuvre, and the sentence. The word is large if there is
        room.
        """
        yield Lines(id="verdict-block")
        yield Lines(_NONE_YET[0], id="verdict-word")
        yield Lines(_NONE_YET[1], id="verdict-sentence")

    def show(self, view: View) -> None:
        """Write the newest verdict of the axis that is shown."""
        judged = view.state.maneuvers[-1] if view.state.maneuvers else None
        block, (title, sentence) = "", _NONE_YET
        if judged is not None:
            symbol, name, sentence = for_the_pilot(judged, view.state.flight_test.decision == "stop")
            title = f"{symbol} {name}   manoeuvre {judged.maneuver.number}: {judged.maneuver.span.kind}"
            block = block_letters(name, self.size.width, HEIGHT)
        self.query_one("#verdict-block", Lines).write(block)
        self.query_one("#verdict-word", Lines).write(title)
        self.query_one("#verdict-sentence", Lines).write(sentence)
        self.set_class(judged is not None and judged.verdict.accepted, "-good")
        self.set_class(judged is not None and not judged.verdict.accepted, "-warn")


class VerdictPane(TextPane):
    """Sentence of the verdict, its reasons with numbers and limits, quality of the fit, and cautions."""

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
                (f" of {log.name}" for log in view.state.flights if log.flight == flight and log.name), ""
            )
            self.write(_rows(view.judged, of))


def _rows(judged: JudgedManeuver, of: str) -> list[Labelled]:
    verdict, estimate, span = judged.verdict, judged.estimate, judged.maneuver.span
    symbol, word = symbol_and_word(judged)
    rows = [
        (f"{symbol} ", f"{word}  manoeuvre {judged.maneuver.number}{of}: {without_word(verdict.sentence)}"),
        (
            "  ",
            f"flown {stretch(span.start_s, span.end_s)} since power-on, mode {judged.maneuver.mode or '-'}",
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
    """Return each stopping rule's limit of the fit's cost J."""
    limits = [f"{rule} {rules.limit:.3g}" for rule, rules in verdict.rules.items() if rules.limit is not None]
    return f" (limit {', '.join(limits)})" if limits else ""
