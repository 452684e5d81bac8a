"""Actions of the application's keys: marks by hand, actions on a live link, and actions on a replay."""

from abc import abstractmethod
from dataclasses import replace
from math import inf, isfinite

from textual.app import App

from advisor.campaign.state import HandDecision
from advisor.flight.maneuvers.marks import LONGEST_S
from advisor.session.conducting import Conducting, LinkRequest, Tempo, View
from advisor.tui.screens.face import Face
from advisor.words.quantities import clock

LINK_ACTIONS = ("follow_another", "ask_for_outputs", "take_guess")
REPLAY_ACTIONS = ("pause", "step", "faster", "slower", "jump", "jump_by", "seek_by")
SPEEDS = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, inf)


class _Actions(App[None]):
    """Conductor, present moment and last line of the screen, which all actions use."""

    conductor: Conducting
    view: View

    @abstractmethod
    def say(self, text: str, seconds: float = 3.0) -> None:
        """Show a text on the last line of the screen, for a while."""


class HandActions(_Actions):
    """Actions that mark a moment, or mark a manoeuvre from one moment to another."""

    def action_mark(self) -> None:
        """Mark this moment in the event log."""
        if isinstance(self.screen, Face):
            self.screen.ask("Mark this moment as:", self._mark)

    def action_begin_maneuver(self) -> None:
        """Begin the mark of a manoeuvre at the present moment."""
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

    def _mark(self, text: str) -> None:
        self.conductor.decide(HandDecision("mark", text))


class LinkActions(_Actions):
    """Actions of the application that exist only on a live link."""

    def action_follow_another(self) -> None:
        """Read the next of the other vehicles, unless a manoeuvre of the present one has been judged."""
        state = self.view.state
        others = state.other_vehicles
        if not others:
            self.say("no other vehicle is heard")
            return
        here = state.vehicle.system if state.vehicle is not None else 0
        system = next((n for n in others if n > here), others[0])
        if state.maneuvers:
            self.say(f"manoeuvres of vehicle {here} are judged: start again with --target-system {system}")
            return
        self.conductor.order(LinkRequest("follow", system))
        self.say(f"vehicle {system} is followed now")

    def action_ask_for_outputs(self) -> None:
        """Ask the vehicle which output is its elevator."""
        self.conductor.order(LinkRequest("outputs"))
        self.say("the vehicle is asked for SERVOn_* (the role of each output); nothing else is sent", 5.0)

    def action_take_guess(self) -> None:
        """Use the guessed output as the elevator."""
        guess = self.view.state.elevator_guess
        if guess is None:
            self.say("there is no guess of the elevator's output to take")
            return
        self.conductor.order(LinkRequest("take", guess.output))
        self.say(f"output {guess.output} is taken for the elevator, by a guess")


class ReplayActions(_Actions):
    """Actions of the application that exist only while a log is played."""

    def action_pause(self) -> None:
        self._play(replace(self._tempo, paused=not self._tempo.paused))

    def action_step(self) -> None:
        """Pause the replay and play a tenth of a second."""
        self._play(replace(self._tempo, paused=True))
        self.conductor.step()

    def action_faster(self) -> None:
        """Choose the next higher speed of the replay."""
        speed = next((s for s in SPEEDS if s > self._tempo.speed), inf)
        self._play(replace(self._tempo, speed=speed))

    def action_slower(self) -> None:
        """Choose the next lower speed of the replay."""
        speed = next((s for s in reversed(SPEEDS) if s < self._tempo.speed), SPEEDS[0])
        self._play(replace(self._tempo, speed=speed))

    def action_jump(self) -> None:
        """Ask for a manoeuvre's number and go to the manoeuvre's begin."""
        if isinstance(self.screen, Face):
            self.screen.ask("Jump to manoeuvre number:", lambda answer: self._jump(int(answer)), integer=True)

    def action_jump_by(self, step: int) -> None:
        """Go to the next manoeuvre, or back to the begin of the last one."""
        flown = len(self.view.state.maneuvers)
        self._jump(flown + step if step > 0 else flown)

    def action_seek_by(self, seconds: int) -> None:
        """Go forward or back by some seconds."""
        playback = self.view.playback
        if playback is not None:
            self.seek(playback.position_s + seconds)

    def go_to(self, at_s: float) -> None:
        """Go to the begin of the manoeuvre that covers a time of this power-on, s. Without a manoeuvre there,
        go to the time itself.
        """
        state, playback = self.view.state, self.view.playback
        if playback is None:
            return
        flown = [j.maneuver for axis in state.axes.values() for j in axis.maneuvers]
        spans = [maneuver.span for maneuver in flown if maneuver.power_on == (state.flight, state.boot)]
        to_s = next((span.start_s for span in spans if span.start_s <= at_s <= span.end_s), at_s)
        self.seek(playback.position_s + to_s - state.now_s)
        self.say(f"going to {clock(to_s)}")

    def seek(self, position_s: float) -> None:
        """Go to a position of the replay, s. A position outside the replay becomes the nearest end of the
        replay.
        """
        duration_s = self.view.playback.duration_s if self.view.playback is not None else 0.0
        self.conductor.seek(min(max(position_s, 0.0), duration_s))

    @abstractmethod
    def show(self, view: View) -> None:
        """Show the state of another moment on the screens."""

    @property
    def _tempo(self) -> Tempo:
        return self.view.tempo or Tempo()

    def _play(self, tempo: Tempo) -> None:
        """Give the conductor the new tempo, and show the tempo immediately, even if the conductor is busy."""
        self.conductor.play(tempo)
        self.show(replace(self.view, tempo=tempo))

    def _jump(self, number: int) -> None:
        self.conductor.jump(max(1, number))
        self.say(f"jumping to manoeuvre {max(1, number)}")
