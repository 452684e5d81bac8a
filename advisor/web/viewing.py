"""The first message of the server to the process of a page."""

from dataclasses import dataclass

from advisor.aircraft import Aircraft
from advisor.tui.settings import Settings
from advisor.tui.source import Tempo

ADDRESS, KEY = "ADVISOR_PAGE_ADDRESS", "ADVISOR_PAGE_KEY"
"""Environment variables that tell the process of a page where the server's door is, and its key.

A process list shows arguments to every user; the environment is readable by its own user alone.
"""


@dataclass(frozen=True, slots=True)
class Viewing:
    """Everything that the application of a page needs before its first report."""

    aircraft: Aircraft
    title: str
    """Name of the log or of the connection."""
    tempo: Tempo | None
    """How a replay starts; None: the source is a live link."""
    settings: Settings
    watch_only: bool = False
    """Whether the page decides nothing by hand and asks nothing of the link."""
