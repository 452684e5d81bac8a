"""Sentences for an event log: the newest sentences, and the number of dropped ones."""

from collections import deque
from collections.abc import Iterable


class EventLog:
    """Collects sentences and drops the oldest.

    Parameters
    ----------
    kept
        Number of sentences that are kept.
    """

    def __init__(self, kept: int) -> None:
        self._lines: deque[str] = deque(maxlen=kept)
        self.lines: tuple[str, ...] = ()
        """Sentences, oldest first. The object stays identical until a sentence is added."""
        self.before = 0
        """Number of sentences that were dropped."""

    def add(self, sentences: Iterable[str]) -> None:
        """Add sentences."""
        before, further = len(self._lines), list(sentences)
        if further:
            self._lines.extend(further)
            self.before += before + len(further) - len(self._lines)
            self.lines = tuple(self._lines)

    def clear(self) -> None:
        """Drop all sentences."""
        self._lines.clear()
        self.lines, self.before = (), 0
