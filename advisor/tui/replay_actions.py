"""Keys for a replay."""

from abc import abstractmethod
from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING

from advisor.session.conducting import Conducting
from advisor.session.source import Tempo
from advisor.session.view import View
from advisor.tui.screens.face import Face

if TYPE_CHECKING:
    from textual.app import App

    Base = App[None]
else:
    Base = object

SPEEDS = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, inf)
ACTIONS = ("pause", "step", "faster", "slower", "jump", "jump_by", "seek_by")


class ReplayActions(Base):
    """Actions of the application that exist only while a log is played."""

    conductor: Conducting
    view: View

    def action_pause(self) -> None:
        """Pause the replay, or continue it."""
        self._play(replace(self._tempo, paused=not self._tempo.paused))

    def action_step(self) -> None:
        """Pause the replay and play a tenth of a second."""
        self._play(replace(self._tempo, paused=True))
        self.conductor.step()

    def action_faster(self) -> None:
        """Choose the next higher speed."""
        speed = next((s for s in SPEEDS if s > self._tempo.speed), inf)
        self._play(replace(self._tempo, speed=speed))

    def action_slower(self) -> None:
        """Choose the next lower speed."""
        speed = next((s for s in reversed(SPEEDS) if s < self._tempo.speed), SPEEDS[0])
        self._play(replace(self._tempo, speed=speed))

    def action_jump(self) -> None:
        """Ask for a manoeuvre and go to its begin."""
        if isinstance(self.screen, Face):
            self.screen.ask("Jump to manoeuvre number:", lambda answer: self._jump(int(answer)), integer=True)

    def action_jump_by(self, step: int) -> None:
        """Go to the next manoeuvre, or back to the begin of the last one."""
        flown = len(self.view.state.maneuvers)
        self._jump(flown + step if step > 0 else flown)

    def action_seek_by(self, seconds: int) -> None:
        """Go some seconds on or back."""
        playback = self.view.playback
        if playback is not None:
            self.seek(playback.position_s + seconds)

    def seek(self, position_s: float) -> None:
        """Go to a position of the replay, s. A position beyond an end is that end."""
        duration_s = self.view.playback.duration_s if self.view.playback is not None else 0.0
        self.conductor.seek(min(max(position_s, 0.0), duration_s))

    @abstractmethod
    def show(self, view: View) -> None:
        """Show another moment on the screens."""

    @abstractmethod
    def say(self, text: str, seconds: float = 3.0) -> None:
        """Show a text on the last line of the screen, for a while."""

    @property
    def _tempo(self) -> Tempo:
        return self.view.tempo or Tempo()

    def _play(self, tempo: Tempo) -> None:
        """Show the tempo at once, however busy the conductor is."""
        self.conductor.play(tempo)
        self.show(replace(self.view, tempo=tempo))

    def _jump(self, number: int) -> None:
        self.conductor.jump(max(1, number))
        self.say(f"jumping to manoeuvre {max(1, number)}")
