"""The newest manoeuvre's verdict: symbol, word and sentence."""

from textual.app import ComposeResult
from textual.containers import Vertical

from advisor.campaign.state import JudgedManeuver
from advisor.session.view import View
from advisor.tui.block_letters import HEIGHT, block_letters
from advisor.tui.panes.lines import Lines
from advisor.tui.panes.part import Part
from advisor.tui.words import without_word


def symbol_and_word(judged: JudgedManeuver) -> tuple[str, str]:
    """Return the symbol and the word of a verdict, readable without colour."""
    if judged.excluded_because is not None:
        return "∅", "EXCLUDED"
    return ("✓", "ACCEPTED") if judged.verdict.accepted else ("✗", "REJECTED")


def for_the_pilot(judged: JudgedManeuver, test_is_complete: bool) -> tuple[str, str, str]:
    """Return symbol, word and sentence of the newest verdict: GOOD, or REPEAT while the test goes on.

    After the end of the test nothing is repeated, so a rejected manoeuvre is NOT USED.
    """
    symbol, word = symbol_and_word(judged)
    sentence = without_word(judged.verdict.sentence)
    if judged.excluded_because is not None:
        return symbol, word, judged.excluded_because
    if judged.verdict.accepted:
        return symbol, "GOOD", sentence
    if test_is_complete:
        return symbol, "NOT USED", sentence.partition("; ")[0]
    return symbol, "REPEAT", sentence


class LastVerdict(Part, Vertical):
    """The newest manoeuvre's verdict."""

    EITHER_AXIS = True

    def compose(self) -> ComposeResult:
        """Yield the word, large where there is room; a line that names the manoeuvre; and the sentence."""
        yield Lines(id="verdict-block")
        yield Lines("no manoeuvre yet", id="verdict-word")
        yield Lines("The verdict stands here a few seconds after a manoeuvre ends.", id="verdict-sentence")

    def show(self, view: View) -> None:
        """Write the newest verdict, once there is one."""
        if not view.state.maneuvers:
            return
        judged = view.state.maneuvers[-1]
        symbol, name, sentence = for_the_pilot(judged, view.state.flight_test.decision == "stop")
        title = f"{symbol} {name}   manoeuvre {judged.maneuver.number}: {judged.maneuver.span.kind}"
        self.query_one("#verdict-block", Lines).write(block_letters(name, self.size.width, HEIGHT))
        self.query_one("#verdict-word", Lines).write(title)
        self.query_one("#verdict-sentence", Lines).write(sentence)
        self.set_class(judged.verdict.accepted, "-good")
        self.set_class(not judged.verdict.accepted, "-warn")
