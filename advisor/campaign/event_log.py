"""Sentences for an event log: the newest of them."""

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
        """Oldest first; the same object until something is added."""

    def add(self, sentences: Iterable[str]) -> None:
        """Take further sentences."""
        further = list(sentences)
        if further:
            self._lines.extend(further)
            self.lines = tuple(self._lines)
