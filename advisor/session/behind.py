"""Backlog of the advisor: the time between the newest record received and the newest record judged."""

from math import inf, isfinite, isnan

from advisor.mavlink.link.health import LinkStatistics

BEHIND_S = 2.0
"""Backlog, s, above which the crew is informed that this computer is late. Estimates of flown manoeuvres do
not delay the next record, but they share the processor with its reading. A manoeuvre takes 10 s."""


def backlog_s(link: LinkStatistics, read_to_s: float) -> float:
    """Return the time between the newest record read and the newest record of the link, s.

    Before any record is read, the backlog starts at the link's first record. Before that record it is 0.
    """
    backlog = link.newest_s - (link.first_s if isnan(read_to_s) else read_to_s)
    return max(0.0, backlog) if isfinite(backlog) else 0.0


def behind_sentence(behind_s: float) -> str:
    """Return the sentence on a backlog above ``BEHIND_S``; empty on a smaller one."""
    return f"this computer is {spoken(behind_s)} behind" if behind_s > BEHIND_S else ""


def spoken(behind_s: float) -> str:
    """Return a backlog in words with its unit: seconds up to ten minutes, then minutes."""
    return f"{behind_s:.0f} s" if behind_s < 600.0 else f"{behind_s / 60.0:.0f} min"


class BehindTeller:
    """Chooses the moments at which lines of text and announcements report the backlog."""

    def __init__(self) -> None:
        self._told_s = 0.0

    def hear(self, behind_s: float) -> str:
        """Return a sentence on the first backlog, on each doubling and on its end; empty otherwise."""
        sentence = behind_sentence(behind_s)
        if sentence and behind_s >= 2.0 * (self._told_s or -inf):
            self._told_s = behind_s
            return sentence
        if self._told_s and behind_s < 0.5 * BEHIND_S:
            self._told_s = 0.0
            return "this computer is up to date again"
        return ""
