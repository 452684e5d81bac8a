"""The first message of the server to the process of a page."""

from dataclasses import dataclass

from advisor.aircraft.aircraft import Aircraft
from advisor.session.source import Tempo
from advisor.tui.settings import Settings

ADDRESS, KEY = "ADVISOR_PAGE_ADDRESS", "ADVISOR_PAGE_KEY"
"""Environment variables with the address of the server's entrance and its key, for the process of a page.

A process list shows arguments to every user. The environment is readable by its own user alone.
"""


@dataclass(frozen=True, slots=True)
class Viewing:
    """Data that the application of a page needs before its first report."""

    aircraft: Aircraft
    title: str
    """Name of the log or of the connection."""
    tempo: Tempo | None
    """Tempo of a replay at the start. None: the source is a live link."""
    settings: Settings
    watch_only: bool = False
    """Whether the page may neither decide by hand nor send requests to the link."""
