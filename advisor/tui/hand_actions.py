"""Keys that decide by hand about the present moment."""

from abc import abstractmethod
from math import isfinite
from typing import TYPE_CHECKING

from advisor.flight.maneuvers.marks import LONGEST_S
from advisor.session.conducting import Conducting
from advisor.session.hand import HandDecision
from advisor.session.view import View
from advisor.tui.screens.face import Face
from advisor.words.vehicle_time import clock

if TYPE_CHECKING:
    from textual.app import App

    Base = App[None]
else:
    Base = object


class HandActions(Base):
    """Actions of the application that name a moment, or mark a manoeuvre from one moment to another."""

    conductor: Conducting
    view: View

    def action_mark(self) -> None:
        """Mark this moment in the event log."""
        if isinstance(self.screen, Face):
            self.screen.ask("Mark this moment as:", self._mark)

    def action_begin_maneuver(self) -> None:
        """Begin a manoeuvre's mark at the present moment."""
        if not isfinite(self.view.state.now_s):
            self.say("nothing can be marked before the vehicle's clock is heard")
            return
        self.conductor.decide(HandDecision("begin"))
        self.say("a manoeuvre is marked from here: finish it where it ends, or begin it anew")

    def action_end_maneuver(self) -> None:
        """End the mark of the open manoeuvre."""
        since_s = self.view.state.marking_since_s
        if since_s is None:
            self.say("no manoeuvre is being marked: begin one first")
            return
        self.conductor.decide(HandDecision("end"))
        if self.view.state.now_s - since_s > LONGEST_S:
            self.say(f"the mark is dropped: it is longer than {LONGEST_S:.0f} s")
        else:
            self.say(f"a manoeuvre is marked from {clock(since_s)} to here; its verdict follows")

    @abstractmethod
    def say(self, text: str, seconds: float = 3.0) -> None:
        """Show a text on the last line of the screen, for a while."""

    def _mark(self, text: str) -> None:
        self.conductor.decide(HandDecision("mark", text))
