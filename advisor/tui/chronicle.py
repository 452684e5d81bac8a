"""What happened, in the order in which it was heard of: the campaign's notices and the link's."""

from collections.abc import Iterable, Sequence

from advisor.event_log import EventLog

KEPT = 500


class Chronicle:
    """Collects sentences for the event log and forgets the oldest."""

    def __init__(self) -> None:
        self._log = EventLog(KEPT)
        self._followed = 0
        self._noted = ""

    @property
    def lines(self) -> tuple[str, ...]:
        """Oldest first; the same object until something is added."""
        return self._log.lines

    def follow(self, notices: Sequence[str], before: int) -> None:
        """Take what a campaign's notices, of which ``before`` are kept no longer, have gained."""
        self._log.add(notices[max(self._followed - before, 0) :])
        self._followed = before + len(notices)

    def hear(self, sentences: Iterable[str]) -> None:
        """Take what the link reports."""
        self._log.add(f"link: {sentence}" for sentence in sentences)

    def note(self, sentence: str) -> None:
        """Take a sentence, unless it was the last one to be noted."""
        if sentence != self._noted:
            self._noted = sentence
            self._log.add([sentence])

    def start_again(self) -> None:
        """A new campaign begins: its notices start at the first."""
        self._log.clear()
        self._followed = 0
