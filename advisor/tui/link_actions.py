"""Keys for a live link."""

from abc import abstractmethod
from typing import TYPE_CHECKING

from advisor.session.conducting import Conducting
from advisor.session.source import LinkRequest
from advisor.session.view import View

if TYPE_CHECKING:
    from textual.app import App

    Base = App[None]
else:
    Base = object

ACTIONS = ("follow_another", "ask_for_outputs", "take_guess")


class LinkActions(Base):
    """Actions of the application that exist only on a live link."""

    conductor: Conducting
    view: View

    def action_follow_another(self) -> None:
        """Follow the next of the other vehicles, unless a manoeuvre of this one has been judged."""
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

    @abstractmethod
    def say(self, text: str, seconds: float = 3.0) -> None:
        """Show a text on the last line of the screen, for a while."""
