"""The pilot's screen: one glance, one word."""

from textual.app import ComposeResult
from textual.events import Resize

from advisor.tui.panes.alarm import Alarm
from advisor.tui.panes.ask import Ask
from advisor.tui.panes.big_word import BigWord, Why
from advisor.tui.panes.crew_notes import CrewNotes
from advisor.tui.panes.gauge import Gauge
from advisor.tui.panes.keys_line import KeysLine
from advisor.tui.panes.last_verdict import LastVerdict
from advisor.tui.panes.replay_bar import ReplayBar
from advisor.tui.panes.status_line import StatusLine
from advisor.tui.screens.face import Face

_TALL = 38


class PilotScreen(Face):
    """Word, verdict, progress and next input. Nothing moves without a reason."""

    HELP = """\
# Pilot

The large word is what to do now:

- **CONTINUE**: fly the next manoeuvre.
- **REPEAT**: the last manoeuvre is rejected; the line below gives the reason and the remedy.
- **RECOVER**: further response of the manoeuvre in the air adds nothing.
- **STOP TESTING**: the criterion fell below its limit.
- **WAIT**, **NO LINK**: no vehicle is heard (any more).
- **NO DATA**: the vehicle does not send what is needed; the line below says what to change.

✓ a good manoeuvre, ✗ one to repeat, ∅ one excluded by hand.
"""

    def compose(self) -> ComposeResult:
        """Yield the parts from top to bottom, in the order of urgency."""
        yield StatusLine()
        yield Alarm()
        yield BigWord()
        yield Why()
        yield LastVerdict()
        yield Gauge()
        yield CrewNotes()
        yield ReplayBar()
        yield Ask()
        yield KeysLine()

    def on_resize(self, event: Resize) -> None:
        """Write the verdict large as well on a tall terminal."""
        self.set_class(event.size.height >= _TALL, "-tall")
