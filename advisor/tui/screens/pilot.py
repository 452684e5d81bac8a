"""The pilot's screen, which shows one word to be read at a glance."""

from textual.app import ComposeResult
from textual.events import Resize

from advisor.tui.panes.alarm import Alarm
from advisor.tui.panes.ask import Ask
from advisor.tui.panes.last_verdict import LastVerdict
from advisor.tui.panes.limits_now import LimitsNow
from advisor.tui.panes.pilot import BigWord, CrewNotes, Gauge, NextInput, Why
from advisor.tui.panes.replay_bar import ReplayBar
from advisor.tui.panes.status_line import KeysLine, StatusLine
from advisor.tui.screens.face import Face

_TALL = 44
"""Least height of a terminal for the verdict in block letters, in rows."""
_LARGE = 32
"""Least height of a terminal for the stick drawing of five lines, in rows."""


class PilotScreen(Face):
    """The pilot's screen: word, verdict, progress and next input. Content changes place only for a reason."""

    HELP = """\
# Pilot

The large word is what to do now:

- **CONTINUE**: fly the next manoeuvre.
- **REPEAT**: the last manoeuvre is rejected; the line below gives the reason and the remedy.
- **RECOVER**: the free response of the manoeuvre in the air is recorded.
- **ENOUGH**: with the input in the air each derivative is within its tolerance; let go.
- **TEST COMPLETE**: the criterion fell below its limit. A later rejected manoeuvre is **NOT USED**.
- **WAIT**, **NO LINK**, **BEHIND**: no data are judged, or this computer is late. After a first verdict the
  last word stays, and its age stands below.
- **NO DATA**: the vehicle does not send what is needed; the line below says what to change.

✓ accepted, ✗ rejected, ∅ excluded by hand.

*next*: the stick over time, pull above, push below, with the seconds of each step; per cent of the stick's
travel, and degrees of elevator. *before it*: bank, air speed and angle of attack now, against their limits.
*how far*: manoeuvres flown, of those expected in all. **r** shows roll and yaw instead of the elevator: the
drawing has right above and left below. **k** turns bell and voice off and on.
"""

    def compose(self) -> ComposeResult:
        """Yield the parts from top to bottom, in the order of urgency."""
        yield StatusLine()
        yield Alarm()
        yield BigWord()
        yield Why()
        yield LastVerdict()
        yield NextInput()
        yield LimitsNow()
        yield Gauge()
        yield CrewNotes()
        yield ReplayBar()
        yield Ask()
        yield KeysLine()

    def on_resize(self, event: Resize) -> None:
        """Draw the stick large where there is room, and the verdict as well on a tall terminal."""
        self.set_class(event.size.height >= _LARGE, "-large")
        self.set_class(event.size.height >= _TALL, "-tall")
