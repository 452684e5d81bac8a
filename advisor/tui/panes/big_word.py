"""The pilot's word CONTINUE, REPEAT or TEST COMPLETE, readable at arm's length."""

from textual.events import Resize

from advisor.session.view import View
from advisor.tui.advice import advise, without_word
from advisor.tui.block_letters import block_letters
from advisor.tui.panes.lines import Lines, Part

TONES = ("good", "warn", "bad", "quiet")


class BigWord(Part, Lines):
    """The pilot's word of advice in block letters."""

    EITHER_AXIS = True

    def __init__(self) -> None:
        super().__init__()
        self.word = ""

    def show(self, view: View) -> None:
        """Write the word of advice in the colour of its urgency."""
        advice = advise(view)
        if advice.word == self.word:
            return
        self.word = advice.word
        for tone in TONES:
            self.set_class(tone == advice.tone, f"-{tone}")
        self._write()

    def on_resize(self, event: Resize) -> None:
        """Use the largest letters that fit."""
        self._write()

    def _write(self) -> None:
        if self.word and self.size.width:
            self.write(block_letters(self.word, self.size.width, self.size.height))


class Why(Part, Lines):
    """The sentence of advice under the pilot's word."""

    EITHER_AXIS = True

    def show(self, view: View) -> None:
        """Write the sentence of the advice."""
        self.write(without_word(advise(view).sentence))
