"""The pilot's one word of advice, from the campaign's verdicts."""

import re
from dataclasses import dataclass
from typing import Literal

from advisor.session.view import View

Word = Literal["CONTINUE", "REPEAT", "TEST COMPLETE", "RECOVER", "WAIT", "BEHIND", "NO LINK", "NO DATA"]
Tone = Literal["good", "warn", "bad", "quiet"]


@dataclass(frozen=True, slots=True)
class Advice:
    """Word and sentence of advice for the pilot, with their urgency."""

    word: Word
    sentence: str
    tone: Tone


_OLD = "the verdicts below are that old, and the link and its recording go on."


def advise(view: View) -> Advice:
    """Return the most important advice: a lost link, unusable data, the manoeuvre in flight, or the verdicts.

    Once the flight test says stop on each axis that is tested, no further data are needed.
    """
    state, verdict = view.state, view.state.flight_test
    if view.health.condition == "stale":
        return Advice("WAIT", view.health.sentence, "bad")
    if view.health.behind:
        return Advice("BEHIND", f"{view.health.behind.capitalize()}: {_OLD}", "bad")
    if view.health.condition == "lost":
        return Advice("NO LINK", f"{view.health.sentence}{_another(view)}", "bad")
    plan = view.plan
    complete = verdict.decision == "stop" if plan is None else plan.is_complete
    if view.obstacles and not complete:
        return Advice("NO DATA", f"{view.obstacles[0]}{_another(view)}{_elevator(view)}", "bad")
    if state.enough:
        return Advice("RECOVER", state.enough, "good")
    if complete:
        return Advice("TEST COMPLETE", verdict.sentence, "good")
    if state.vehicle is None:
        return Advice("WAIT", view.health.sentence, "quiet")
    sentence = plan.sentence if plan is not None and verdict.decision == "stop" else verdict.sentence
    if view.last and not view.last.verdict.accepted:
        return Advice("REPEAT", sentence, "warn")
    return Advice("CONTINUE", sentence, "quiet")


def _another(view: View) -> str:
    """Return a sentence on other vehicles that a key selects; empty after a flight and in replays."""
    others = view.state.other_vehicles
    if not others or view.state.maneuvers or view.tempo is not None:
        return ""
    return f" Vehicle {', '.join(map(str, others))} is heard: key v follows another."


def _elevator(view: View) -> str:
    """Return a sentence on the keys that choose an unknown elevator output on a live link."""
    if view.obstacles[0].code != "no_elevator" or view.tempo is not None:
        return ""
    guess = view.state.elevator_guess
    return (
        f" {str(guess).capitalize()}; key g takes it."
        if guess
        else " Key a asks the vehicle for its elevator output."
    )


def without_word(sentence: str) -> str:
    """Return a verdict's sentence without its first word, which is already shown in large letters."""
    return re.sub(r"^[A-Z ]+: ", "", sentence)
