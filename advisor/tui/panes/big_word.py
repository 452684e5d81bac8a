"""CONTINUE, REPEAT or STOP TESTING, readable at arm's length."""

from textual.events import Resize

from advisor.tui.advice import Advice
from advisor.tui.letters import block_letters
from advisor.tui.panes.lines import Lines

TONES = ("good", "warn", "bad", "quiet")


class BigWord(Lines):
    """One word in block letters; plain text is kept as its tooltip."""

    def __init__(self, *, id: str | None = None) -> None:
        super().__init__("", id=id)
        self.word = ""

    def show(self, advice: Advice) -> None:
        """Write the advice's word in its tone."""
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
