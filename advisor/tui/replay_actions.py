"""What keys do to a replay."""

from math import inf
from typing import TYPE_CHECKING

from advisor.tui.conductor import Conductor
from advisor.tui.screens.face import Face
from advisor.tui.source import Playable, Source
from advisor.tui.view import View

if TYPE_CHECKING:
    from textual.app import App

    Base = App[None]
else:
    Base = object

SPEEDS = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, inf)
ACTIONS = ("pause", "step", "faster", "slower", "jump", "jump_by")


class ReplayActions(Base):
    """Actions of the application that exist only while a log is played."""

    source: Source
    conductor: Conductor
    view: View

    def action_pause(self) -> None:
        """Hold the replay, or go on."""
        if isinstance(self.source, Playable):
            self.source.pause(not self.source.playback().paused)

    def action_step(self) -> None:
        """Hold the replay and play a tenth of a second."""
        if isinstance(self.source, Playable):
            self.source.pause(True)
            self.source.step()

    def action_faster(self) -> None:
        """Next higher speed."""
        if isinstance(self.source, Playable):
            now = self.source.playback().speed
            self.source.set_speed(next((s for s in SPEEDS if s > now), inf))

    def action_slower(self) -> None:
        """Next lower speed."""
        if isinstance(self.source, Playable):
            now = self.source.playback().speed
            self.source.set_speed(next((s for s in reversed(SPEEDS) if s < now), SPEEDS[0]))

    def action_jump(self) -> None:
        """Ask for a manoeuvre and go to where it begins."""
        if isinstance(self.screen, Face):
            self.screen.ask("Jump to manoeuvre number:", self._jump_to, integer=True)

    def action_jump_by(self, step: int) -> None:
        """Go to the next manoeuvre, or back to where the last one began."""
        flown = len(self.view.state.maneuvers)
        self.conductor.jump(max(1, flown + step if step > 0 else flown))

    def _jump_to(self, answer: str) -> None:
        self.conductor.jump(max(1, int(answer)))
