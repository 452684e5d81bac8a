"""What happened, in the order in which it was heard of: the campaign's notices and the link's."""

from collections import deque
from collections.abc import Iterable, Sequence

KEPT = 500


class Chronicle:
    """Collects sentences for the event log and forgets the oldest."""

    def __init__(self) -> None:
        self._lines: deque[str] = deque(maxlen=KEPT)
        self._followed = 0
        self._noted = ""
        self.lines: tuple[str, ...] = ()
        """Oldest first; the same object until something is added."""

    def follow(self, notices: Sequence[str]) -> None:
        """Take what a campaign's notices, which only grow, have gained since the last call."""
        self._add(notices[self._followed :])
        self._followed = len(notices)

    def hear(self, sentences: Iterable[str]) -> None:
        """Take what the link reports."""
        self._add([f"link: {sentence}" for sentence in sentences])

    def note(self, sentence: str) -> None:
        """Take a sentence, unless it was the last one to be noted."""
        if sentence != self._noted:
            self._noted = sentence
            self._add([sentence])

    def start_again(self) -> None:
        """A new campaign begins: its notices start at the first."""
        self._lines.clear()
        self._followed = 0

    def _add(self, sentences: Sequence[str]) -> None:
        if sentences:
            self._lines.extend(sentences)
            self.lines = tuple(self._lines)
