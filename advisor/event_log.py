"""Sentences for an event log: the newest of them, and how many came before."""

from collections import deque
from collections.abc import Iterable


class EventLog:
    """Collects sentences and forgets the oldest.

    Parameters
    ----------
    kept
        How many sentences are kept.
    """

    def __init__(self, kept: int) -> None:
        self._lines: deque[str] = deque(maxlen=kept)
        self.lines: tuple[str, ...] = ()
        """Oldest first; the same object until something is added."""
        self.before = 0
        """How many sentences have been forgotten."""

    def add(self, sentences: Iterable[str]) -> None:
        """Take further sentences."""
        before, further = len(self._lines), list(sentences)
        if further:
            self._lines.extend(further)
            self.before += before + len(further) - len(self._lines)
            self.lines = tuple(self._lines)

    def clear(self) -> None:
        """Begin anew."""
        self._lines.clear()
        self.lines, self.before = (), 0
